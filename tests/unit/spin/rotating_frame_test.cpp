// What stands still in the frame of an oscillating field, against the whole field.
#include "spin/rotating_frame.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "drives.hpp"
#include "laboratory.hpp"
#include "spin/atoms.hpp"
#include "spin/driven_levels.hpp"
#include "spin/level_labels.hpp"
#include "unit/transport/readers.hpp"

namespace rabiline::rotating_frame_test {
namespace {

struct Frame {
  DrivenStates states;
  RotatingFrame frame;
  StandingCoupling standing;
  Frame(const CoupledSpins& spins, double field, const RotatingTerm& drive)
      : states(driven_states(spins, levels_at(spins, field), drive)) {
    const DrivenStates* const alone[] = {&states};
    frame = rotating_frame(level_labels(spins), sense_of(drive), drive.oscillator.frequency, alone);
    standing = standing_coupling(frame, states);
  }
  double shift(int upper, int lower) const {
    return standing.second(upper, upper) - standing.second(lower, lower);
  }
};

// A field 2 H1 cos(w t) holds H1 that turns with the spin and H1 that turns against it: dw = (gamma H1)^2/(4
// w0) (F. Bloch, A. Siegert, Phys. Rev. 57, 522 (1940)), here gamma H1 = 2 pi C and w0 = 2 pi f.
TEST(StandingCoupling, ShiftsTwoLevelsAsBlochAndSiegertFound) {
  const double field = 1e-3, h1 = 2e-6, f = half().zeeman_j * field, c = half().zeeman_j * h1;
  const double found = Frame(half(), field, drive(oscillating, 2 * h1, f)).shift(0, 1);
  EXPECT_NEAR(found, c * c / (4 * f), 1e-5 * found);
  EXPECT_NEAR(Frame(half(), field, drive(oscillating, 2 * h1, 2 * f)).shift(0, 1), found * 2 / 3,
              1e-5 * found);
}

TEST(RotatingFrame, KeepsFarCouplingsAllOrNone) {
  const CoupledSpins spins = coupled_spins(*find_atom("K-39"));
  const auto joined = [&](double field, double f) {
    const Frame frame(spins, field, drive(oscillating, 60e-6, f));
    int standing = 0, coupled = 0;
    for (int upper = 0; upper < 5; ++upper)
      for (int lower = 5; lower < 8; ++lower) {
        coupled += frame.states.up(upper, lower) != 0 ? 1 : 0;
        standing += frame.standing.first(upper, lower) != 0 ? 1 : 0;
      }
    EXPECT_EQ(coupled, 6);
    return standing;
  };
  EXPECT_EQ(joined(30e-4, 18.4e6), 0) << "440 MHz from resonance";
  EXPECT_EQ(joined(0.5e-4, 461.37e6), 6) << "all lines of the hyperfine structure are near";
}

/// The whole field of an oscillator that starts at any phase, over so many periods: one of them by small
/// steps of Runge and Kutta, from eight phases.
Eigen::MatrixXd under_the_whole_field(const CoupledSpins& spins, double field, const RotatingTerm& drive,
                                      int periods) {
  constexpr int phases = 8, steps_of_phase = 1000;
  const int n = spins.levels();
  Eigen::MatrixXcd h0 = Eigen::MatrixXcd::Zero(n, n), h1 = h0;
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXcd i = in_product_basis(spins, false, axis), j = in_product_basis(spins, true, axis);
    h0 += spins.coupling * i * j;
    const double along[] = {drive.first.x, drive.first.y, drive.first.z};
    const Eigen::MatrixXcd moment = spins.zeeman_i * i + spins.zeeman_j * j;
    h1 += drive.amplitude * along[axis] * moment;
    if (axis == 2) h0 += field * moment;
  }
  const double period = 1 / drive.oscillator.frequency, step = period / (phases * steps_of_phase);
  std::vector<Eigen::MatrixXcd> part(phases, Eigen::MatrixXcd::Identity(n, n));
  for (int k = 0; k < phases * steps_of_phase; ++k) {
    Eigen::MatrixXcd& psi = part[static_cast<std::size_t>(k / steps_of_phase)];
    const auto slope = [&](double t, const Eigen::MatrixXcd& x) -> Eigen::MatrixXcd {
      return Complex(0, -two_pi) * ((h0 + std::cos(two_pi * t / period) * h1) * x);
    };
    const double t = k * step;
    const Eigen::MatrixXcd a = slope(t, psi), b = slope(t + step / 2, psi + step / 2 * a),
                           c = slope(t + step / 2, psi + step / 2 * b), d = slope(t + step, psi + step * c);
    psi += step / 6 * (a + 2 * b + 2 * c + d);
  }
  const Eigen::MatrixXcd states = levels_at(spins, field).states.cast<Complex>();
  Eigen::MatrixXd mean = Eigen::MatrixXd::Zero(n, n);
  for (int phase = 0; phase < phases; ++phase) {
    Eigen::MatrixXcd one = Eigen::MatrixXcd::Identity(n, n), all = one;
    for (int k = 0; k < phases; ++k)
      one = (part[static_cast<std::size_t>((phase + k) % phases)] * one).eval();
    for (int rest = periods; rest > 0; rest /= 2, one = (one * one).eval())
      if (rest % 2 == 1) all = (one * all).eval();
    mean += (states.adjoint() * all * states).cwiseAbs2().transpose() / phases;
  }
  return mean;
}

TEST(StandingCoupling, OfPotassiumAgreesWithTheWholeField) {
  const CoupledSpins spins = coupled_spins(*find_atom("K-39"));
  const double time = 2e-4;
  struct Setting {
    double field, frequency, tilt;
  };
  for (const Setting& set : {Setting{30e-4, 18.4e6, 0},
                             {30e-4, 18.4e6, 0.6},
                             {30e-4, 21.2e6, 0},
                             {0.5e-4, 461.37e6, 0},
                             {0.5e-4, 461.72e6, 1}})
    for (const auto& [amplitude, most] : {std::pair{10e-6, 1e-4}, {60e-6, 1e-3}, {300e-6, 2e-2}}) {
      RotatingTerm whole = drive(oscillating, amplitude, set.frequency);
      whole.first = {std::sqrt(1 - set.tilt * set.tilt), 0, set.tilt};
      const int periods = static_cast<int>(time * set.frequency);
      const double length = periods / set.frequency;  // at 1 m/s
      const Eigen::MatrixXd expected = under_the_whole_field(spins, set.field, whole, periods);
      const auto found = [&](double size) {
        whole.amplitude = size;
        return test::probabilities(DrivenLevels(spins, {{0, length, set.field, whole}}, 1), 1);
      };
      EXPECT_LT(difference(found(amplitude), expected), most)
          << set.field << " T, " << set.frequency << " Hz";
      if (amplitude > 20e-6) {
        EXPECT_GT(difference(found(1.01 * amplitude), expected), most);
      }
    }
}

/// Between the hyperfine levels of potassium, by half of their distance: one photon across the field, one
/// along.
TEST(StandingCoupling, OfTwoPhotonsOnTheirLineAgreesWithTheWholeField) {
  const CoupledSpins spins = coupled_spins(*find_atom("K-39"));
  const double field = 3e-3, time = 40e-6;
  for (const double frequency : {233.7502e6, 244.5939e6}) {
    RotatingTerm whole = drive(oscillating, 0.3e-3, frequency);
    whole.first = {std::sqrt(0.5), 0, std::sqrt(0.5)};
    const int periods = static_cast<int>(time * frequency);
    const Eigen::MatrixXd expected = under_the_whole_field(spins, field, whole, periods);
    const auto found = [&](double size) {
      whole.amplitude = size;
      return test::probabilities(DrivenLevels(spins, {{0, periods / frequency, field, whole}}, 1), 1);
    };
    EXPECT_LT(difference(found(0.3e-3), expected), 5e-3) << frequency << " Hz";
    EXPECT_GT(difference(found(1.01 * 0.3e-3), expected), 5e-3);
    EXPECT_GT(1 - expected.diagonal().minCoeff(), 0.3) << "that levels change";
  }
}

TEST(RotatingFrame, TellsWhatItLeavesOutWhereTwoPhotonsMeetALineThatItDoesNotKeep) {
  const CoupledSpins spins = coupled_spins(*find_atom("K-39"));
  RotatingTerm term = drive(oscillating, 0.3e-3, 233.7502e6);
  term.first = {std::sqrt(0.5), 0, std::sqrt(0.5)};
  Frame frame(spins, 3e-3, term);
  EXPECT_LT(neglected_amplitude(frame.frame, frame.states), 0.02);
  std::iota(frame.frame.set.begin(), frame.frame.set.end(), 0);  // each level alone
  EXPECT_GT(neglected_amplitude(frame.frame, frame.states), 0.2);
}

}  // namespace
}  // namespace rabiline::rotating_frame_test
