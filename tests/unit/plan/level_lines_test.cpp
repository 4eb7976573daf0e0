#include "plan/level_lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "core/eigensystem.hpp"
#include "spin/level_labels.hpp"
#include "spin/levels.hpp"
#include "spin/rotating_frame.hpp"

namespace rabiline::level_lines_test {
namespace {

/// Two photons by way of one level that is off by d: the Rabi frequencies' product over 2 d (W. Demtroeder,
/// Laser Spectroscopy 2, 5th ed. (Springer, 2015), sect. 2.5).
TEST(TransitionsOfTwoPhotons, AreAsStrongAsBothStepsOverWhatTheLevelBetweenIsOff) {
  const Structure structure = *find_species("K-39 atom")->structure;
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(structure));
  const auto level = [&](int m) { return *find_weak_field_level(labels, 4, 2 * m); };
  LevelZone zone{0, 0.1};
  zone.field = 3e-3;
  zone.drive = RotatingTerm{};
  zone.drive->motion = FieldMotion::swings_in_rotating_wave;
  zone.drive->amplitude = 2e-6;
  zone.drive->first = {1, 0, 0};
  const auto between = [&](const std::vector<Transition>& all, int upper, int lower) {
    for (const Transition& t : all)
      if (t.upper == upper && t.lower == lower) return t;
    ADD_FAILURE() << "there is none";
    return Transition{};
  };
  const Transition first = between(transitions_near(structure, driven_zone(zone)), level(1), level(0)),
                   second = between(transitions_near(structure, driven_zone(zone)), level(2), level(1));
  zone.drive->oscillator.frequency = (first.frequency + second.frequency) / 2;
  const double off = zone.drive->oscillator.frequency - first.frequency;
  const Transition both =
      between(transitions_of_two_photons(structure, driven_zone(zone), 1e3), level(2), level(0));
  EXPECT_NEAR(both.detuning, 0, 1e-3);
  EXPECT_NEAR(both.rabi, std::abs(first.rabi * second.rabi / (2 * off)), 2e-3 * both.rabi);
  EXPECT_GT(std::abs(off), 10e3 + 10 * first.rabi);
  zone.drive->oscillator.frequency = first.frequency;
  for (const Transition& t : transitions_of_two_photons(structure, driven_zone(zone), 1e3))
    EXPECT_FALSE(t.upper == level(2) && t.lower == level(0)) << "one photon after the other";
}

/// [Hz] Where two photons of a swinging field are closest to a line: of Floquet's states, those that are made
/// of its levels are then least apart (J. H. Shirley, Phys. Rev. 138, B979, 1965).
double centre_by_floquet(const LevelZone& zone, const Structure& structure, const Transition& line) {
  constexpr int most = 6;
  const CoupledSpins spins = coupled_spins(structure);
  const DrivenStates states = driven_states(spins, levels_at(spins, zone.field), *zone.drive);
  const int d = spins.levels(), size = d * (2 * most + 1);
  const auto apart = [&](double frequency) {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size, size);
    for (int n = -most; n <= most; ++n) {
      const int at = (n + most) * d;
      h.block(at, at, d, d).diagonal() = states.energy.array() - states.energy(line.lower) + n * frequency;
      if (n < most) h.block(at, at + d, d, d) = h.block(at + d, at, d, d) = states.up;
    }
    const Eigensystem<Eigen::MatrixXd> all = eigensystem_of(h);
    const auto is_of_both = [&](int k) {
      return std::hypot(all.vectors(most * d + line.lower, k), all.vectors((most - 2) * d + line.upper, k));
    };
    std::vector<int> order(static_cast<std::size_t>(size));
    std::iota(order.begin(), order.end(), 0);
    std::ranges::sort(order, std::greater<>{}, is_of_both);
    return std::abs(all.values(order[0]) - all.values(order[1]));
  };
  double low = (line.frequency - 2e3) / 2, high = (line.frequency + 2e3) / 2;
  while (high - low > 0.1) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    (apart(left) < apart(right) ? high : low) = apart(left) < apart(right) ? right : left;
  }
  return low + high;
}

TEST(TransitionsOfTwoPhotons, AreShiftedByTheirFieldAsFloquetsStatesAre) {
  const Structure structure = *find_species("K-39 atom")->structure;
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(structure));
  LevelZone zone{0, 0.1};
  zone.field = 1e-3;
  zone.drive = RotatingTerm{};
  zone.drive->motion = FieldMotion::swings_in_rotating_wave;
  zone.drive->first = {std::sqrt(0.5), 0, std::sqrt(0.5)};
  zone.drive->oscillator.frequency = 3348465.9;
  const int upper = *find_weak_field_level(labels, 4, 4), lower = *find_weak_field_level(labels, 4, 2);
  const auto share = [&](double amplitude) {  // of the second order in the whole
    zone.drive->amplitude = amplitude;
    const std::vector<Transition> all = transitions_of_two_photons(structure, driven_zone(zone), 2e3);
    const auto line =
        std::ranges::find_if(all, [&](const Transition& t) { return t.upper == upper && t.lower == lower; });
    if (line == all.end()) return 0.0;
    return (centre_by_floquet(zone, structure, *line) - line->frequency) / line->shift;
  };
  EXPECT_NEAR((4 * share(20e-6) - share(40e-6)) / 3, 1,
              2e-3);  // without the fourth, which grows by its square
}

}  // namespace
}  // namespace rabiline::level_lines_test
