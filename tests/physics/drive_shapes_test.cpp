// Fields with a clock that change in time, along the beam or across it, against closed forms and an
// independent integration.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/atoms.hpp"
#include "physics/independent_spin.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::drive_shapes_test {
namespace {

constexpr double deg = pi / 180, speed = 1000, begin = 0.3, length = 0.2, stay = length / speed;
constexpr double entered = begin / speed, left = entered + stay;
constexpr double field = 1e-3;
const double w0 = -gamma_n * field;  // of the precession about +z

/// Neutrons of one speed, S = -z, through a static field along z and these parts.
Beamline line(std::vector<PlacedPart> parts, const Law& law = ClassicalLaw{}) {
  Beamline b = suggested(0);
  b.law = law;
  b.source.speed = SingleSpeed{speed};
  b.source.opening = Disc{0};
  b.chamber.reset();
  b.particles = 8;
  b.parts = {place("P", 0.1, Polarizer{0.05, 1e-3, 1, {}}), place("B", begin, UniformField{0.6, field, {}})};
  for (PlacedPart& part : parts) b.parts.push_back(std::move(part));
  b.parts.push_back(place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  return b;
}
double final_sz(const Beamline& b) { return 2 * run_points({b}).detectors.at(0).levels.at(0) - 1; }

/// As long as the rotation by half a turn takes, about.
RotatingField turning_field(double frequency, double turn = pi) {
  RotatingField part;
  part.length = length;
  part.amplitude = turn / stay / -gamma_n;
  part.frequency = frequency;
  part.sense = Sense::co;
  part.phase = {Phase::Kind::angle, 0.7};
  return part;
}
OscillatingField swinging_field(double frequency, double amplitude) {
  OscillatingField part;
  part.length = length;
  part.amplitude = amplitude;
  part.frequency = frequency;
  part.approximation = Approximation::none;
  part.phase = {Phase::Kind::angle, 0.7};
  return part;
}
double integrated(const FieldInTime& at) { return spin_after(gamma_n, at, entered, left, {0, 0, -1})[2]; }

// ---- sweeps ----

/// [rad] Of a clock at the time t, frequencies in hertz.
double swept_angle(double from, double to, double t0, double t1, double t) {
  const double within = std::clamp(t, t0, t1) - t0, behind = std::max(0.0, t - t1);
  return two_pi * (from * t + (to - from) / (t1 - t0) * within * within / 2 + (to - from) * behind);
}

// P = 1 - exp(-pi w1^2/(2 |dw/dt|)): L. Landau, C. Zener 1932. The sweep ends 40 w1 from resonance on both
// sides.
TEST(Sweep, ThroughTheResonanceFlipsAsLandauAndZenerSay) {
  for (const double probability : {0.3, 0.9}) {
    const double w1 = 20 * pi / stay;
    const double rate = pi * w1 * w1 / (-2 * std::log(1 - probability)), reach = rate * stay / 2;
    RotatingField part = turning_field((w0 - reach) / two_pi, w1 * stay);
    part.sweep = FrequencySweep{(w0 + reach) / two_pi, entered, left};
    // Ends that are not infinitely far leave amplitudes of w1/(2 reach) each.
    const double unfinished = 2 * std::sqrt(probability * (1 - probability)) * w1 / reach + 1e-3;
    EXPECT_NEAR((1 + final_sz(line({place("H0", begin, part)}))) / 2, probability, unfinished);
  }
}

TEST(Sweep, BeginsAndEndsAsTheClockSaysInARotatingField) {
  const double from = w0 / two_pi - 9e3, to = w0 / two_pi + 6e3, t0 = entered + 0.2 * stay,
               t1 = entered + 0.7 * stay;
  RotatingField part = turning_field(from, 7);
  part.sweep = FrequencySweep{to, t0, t1};
  const auto reference = [&](double scale) {
    return integrated([&](double t) {
      const double a = scale * part.amplitude, angle = swept_angle(from, to, t0, t1, t) + 0.7;
      return Vec{a * std::cos(angle), a * std::sin(angle), field};
    });
  };
  expect_agreement(final_sz(line({place("H0", begin, part)})), reference, 2e-6, "sweep");
  part.sweep->to = to + 100;
  EXPECT_GT(std::abs(final_sz(line({place("H0", begin, part)})) - reference(1)), 1e-4);
}

TEST(Sweep, OfAWholeSwingingFieldFollowsTheIntegrationUnderEveryLaw) {
  const double from = w0 / two_pi - 5e3, to = w0 / two_pi + 5e3, t0 = entered, t1 = left;
  OscillatingField part = swinging_field(from, 3 * pi / stay / -gamma_n);
  part.sweep = FrequencySweep{to, t0, t1};
  const auto reference = [&](double scale) {
    return integrated([&](double t) {
      return Vec{scale * part.amplitude * std::cos(swept_angle(from, to, t0, t1, t) + 0.7), 0, field};
    });
  };
  const std::vector<PlacedPart> parts{place("H0", begin, part)};
  expect_agreement(final_sz(line(parts)), reference, 2e-6, "classical");
  DoradoLaw still;
  still.kappa = 1e-12;  // flown in steps, on a path that is straight
  expect_agreement(final_sz(line(parts, still)), reference, 2e-6, "dorado");
  Beamline quantum = line(parts, QuantumLaw{});
  expect_agreement(2 * run_points({quantum}).detectors.at(0).levels.at(0) - 1, reference, 2e-6, "quantum");
}

// ---- pulses ----

// Ramsey's two pulses in time on a beam of one speed (N. Ramsey, Phys. Rev. 78, 695 (1950)): sin th = w1/a.
TEST(PulseTrain, OfTwoHalfPiPulsesHasRamseysFringes) {
  const double tau = 20e-6, period = 80e-6, between = period - tau;
  for (const double detuning : {0.0, 2.1e3, -5e3}) {
    RotatingField part = turning_field(w0 / two_pi + detuning, pi / 2 / tau * stay);
    part.pulses = PulseTrain{entered + 30e-6, entered + 30e-6 + tau, period, 2};
    expect_agreement((1 + final_sz(line({place("H0", begin, part)}))) / 2,
                     [&](double scale) {
                       const double w1 = scale * pi / 2 / tau, delta = two_pi * detuning,
                                    a = std::hypot(w1, delta);
                       const double s = w1 / a, c = delta / a;
                       return 4 * s * s * std::pow(std::sin(a * tau / 2), 2) *
                              std::pow(std::cos(delta * between / 2) * std::cos(a * tau / 2) -
                                           c * std::sin(delta * between / 2) * std::sin(a * tau / 2),
                                       2);
                     },
                     1e-6, "two pulses");
  }
}

TEST(PulseTrain, GoesOnWithoutEndAndActsUnderEveryLaw) {
  RotatingField part = turning_field(w0 / two_pi + 1e3, 3);
  part.pulses = PulseTrain{0, 7e-6, 17e-6, {}};
  const auto reference = [&](double scale) {
    Vec s{0, 0, -1};
    for (int edge = 0; edge < 200; ++edge) {  // from edge to edge
      const double period = edge / 2 * 17e-6, width = 7e-6;
      const bool on = edge % 2 == 0;
      const double from = std::max(entered, on ? period : period + width),
                   to = std::min(left, on ? period + width : period + 17e-6);
      const double a = on ? scale * part.amplitude : 0;
      if (from < to)
        s = spin_after(
            gamma_n,
            [&](double time) {
              const double angle = two_pi * *part.frequency * time + 0.7;
              return Vec{a * std::cos(angle), a * std::sin(angle), field};
            },
            from, to, s);
    }
    return s[2];
  };
  const std::vector<PlacedPart> parts{place("H0", begin, part)};
  expect_agreement(final_sz(line(parts)), reference, 2e-6, "classical");
  DoradoLaw still;
  still.kappa = 1e-12;
  expect_agreement(final_sz(line(parts, still)), reference, 1e-5, "dorado");
}

// ---- across the beam ----

Beamline beside(std::vector<PlacedPart> parts, double x, double angle = 0) {
  Beamline b = line(std::move(parts));
  b.source.offset = {x, 0};
  b.source.tilt.z = angle;
  return b;
}

// A phase phi in the second zone turns Ramsey's fringe: P = cos^2(phi/2) on resonance between two pulses of
// pi/2.
TEST(PhaseGradient, InTheSecondZoneIsThePhaseOfWhereTheParticleIs) {
  RotatingField first = turning_field(w0 / two_pi, pi / 2), second = first;
  second.frequency.reset();
  second.sense.reset();
  second.oscillator = "first";
  second.phase = {Phase::Kind::locked, 0};
  second.phase_gradient = {0.5 / 1e-3, 0};
  second.offset = {0.2e-3, 0};
  for (const double x : {-1e-3, 0.0, 2e-3})
    expect_agreement(
        (1 + final_sz(beside({place("first", begin, first), place("second", begin + 0.4, second)}, x))) / 2,
        [&](double scale) { return std::pow(std::cos(scale * 500 * (x - 0.2e-3) / 2), 2); }, 1e-9, "phase");
}

// A phase that differs over a cavity shifts the fringe of each path by phi/(2 pi (T + 4 tau/pi)) (N. Ramsey
// 1950).
TEST(PhaseGradient, OfACavityShiftsTheFringeOfEachPath) {
  const double between = 0.55 / speed, effective = between - stay / 10 + 4 / pi * stay / 10, x = 1.5e-3;
  RotatingField first = turning_field(0, pi / 2);
  first.length = length / 10;
  first.amplitude *= 10;
  RotatingField second = first;
  second.frequency.reset();
  second.sense.reset();
  second.oscillator = "first";
  second.phase = {Phase::Kind::locked, 0};
  second.phase_gradient = {200, 0};
  const auto flipped = [&](double shift) {
    first.frequency = w0 / two_pi + shift;
    return (1 + final_sz(beside({place("first", begin, first), place("second", begin + 0.55, second)}, x))) /
           2;
  };
  const double centre = -200 * x / (two_pi * effective);
  const auto odd_part = [&](double at) { return flipped(at + 200) - flipped(at - 200); };
  EXPECT_NEAR(odd_part(centre), 0, 2e-4);
  EXPECT_GT(std::abs(odd_part(1.01 * centre)), 4e-4);
}

// What leaks out of a zone, in phase with it, turns spins on: P = sin^2(angle/2) of all angles.
TEST(LeakingZone, TurnsSpinsOnBetweenTheZones) {
  RotatingField zone = turning_field(w0 / two_pi, 0.9), leak = turning_field(0, 0.2);
  leak.frequency.reset();
  leak.sense.reset();
  leak.oscillator = "zone";
  leak.phase = {Phase::Kind::locked, 0};
  expect_agreement(
      final_sz(line({place("zone", begin, zone), place("leak", begin + length, leak)})),
      [&](double scale) { return -std::cos(0.9 + scale * 0.2); }, 1e-9, "leak");
}

// What crosses it sees another frequency: gradient times the speed across.
TEST(PhaseGradient, ThatAParticleCrossesShiftsItsResonance) {
  const double tilt = 2e-3, gradient = 3e3;
  RotatingField part = turning_field(0);
  part.phase_gradient = {gradient, 0};
  const double vx = -speed * std::sin(tilt), time = stay / std::cos(tilt);
  const auto found = [&](double shift) {
    part.frequency = (w0 - gradient * vx) / two_pi + shift;
    return (1 + final_sz(beside({place("H0", begin, part)}, 0, tilt))) / 2;
  };
  EXPECT_NEAR(found(0), 1, 1e-9);
  expect_agreement(
      found(3e3), [&](double scale) { return rabi(pi / stay, scale * two_pi * 3e3, time); }, 1e-7, "shift");
}

TEST(AmplitudeGradient, TurnsSpinsByTheAmplitudeWhereTheyAre) {
  RotatingField part = turning_field(w0 / two_pi, 1.2);
  part.amplitude_gradient = {0.1 / 1e-3, 0};
  for (const double x : {-2e-3, 1e-3})
    expect_agreement(
        final_sz(beside({place("H0", begin, part)}, x)),
        [&](double scale) { return -std::cos(1.2 * (1 + scale * 100 * x)); }, 1e-9, "amplitude");
}

// ---- along the beam ----

TEST(PhaseAdvance, IsAWaveThatTravels) {
  OscillatingField part = swinging_field(w0 / two_pi + 3e3, 3 * pi / stay / -gamma_n);
  part.phase_advance = 200 * deg;
  expect_agreement(
      final_sz(line({place("H0", begin, part)})),
      [&](double scale) {
        return integrated([&](double t) {
          const double angle = two_pi * *part.frequency * t + 0.7 + scale * 200 * deg * (t - entered) / stay;
          return Vec{part.amplitude * std::cos(angle), 0, field};
        });
      },
      2e-6, "advance");
  // In the rotating wave each speed has its own resonance, as with a field that turns along the beam.
  part.approximation = Approximation::rotating_wave;
  part.amplitude = 2 * pi / stay / -gamma_n;
  part.frequency = (w0 - 200 * deg / stay) / two_pi;
  EXPECT_NEAR(final_sz(line({place("H0", begin, part)})), 1, 1e-9);
}

// W(t) = W0 cos(pi t/T): nothing flips on resonance; all does at W0 T = 1.85731 pi, detuned by 0.64174/T; the
// peak at W0 T = pi is 0.56892 (scipy).
TEST(StandingWave, OfAStripLineHasTwoPeaksAndNothingBetweenThem) {
  const auto flipped = [&](double turn, double detuning) {
    RotatingField part = turning_field(w0 / two_pi + detuning / stay, turn);
    part.profile = StandingWaveProfile{1, WaveEnds::antinodes};
    return (1 + final_sz(line({place("H0", begin, part)}))) / 2;
  };
  EXPECT_NEAR(flipped(1.85731 * pi, 0), 0, 1e-9);
  EXPECT_NEAR(flipped(1.85731 * pi, 0.64174), 1, 1e-6);
  EXPECT_NEAR(flipped(1.85731 * pi, -0.64174), 1, 1e-6);
  EXPECT_NEAR(flipped(pi, 0.67230), 0.56892, 1e-5);
  EXPECT_LT(flipped(1.02 * 1.85731 * pi, 0.64174), 1 - 1e-4);
  // TE102: two half waves of opposite signs undo each other on resonance, one alone turns by 2/pi of its
  // peak.
  RotatingField part = turning_field(w0 / two_pi, 2);
  part.profile = StandingWaveProfile{2, WaveEnds::nodes};
  EXPECT_NEAR(final_sz(line({place("H0", begin, part)})), -1, 1e-9);
  part.profile = StandingWaveProfile{3, WaveEnds::nodes};
  EXPECT_NEAR(final_sz(line({place("H0", begin, part)})), -std::cos(2 * 2 / (3 * pi)), 1e-9);
}

TEST(StandingWave, DrivesTheLinesOfAtomsAlike) {
  const Species& atom = *find_species("H atom");
  const double moment = (atom.structure->g_j - atom.structure->g_i) / 2 * bohr_magneton;
  const double line_frequency = 1420405751.768, low = 1e-7;
  const double shift = std::pow(2 * moment * low / planck, 2) / (2 * line_frequency);
  const auto flipped = [&](double detuning) {
    OscillatingField part = swinging(0.1, 1.85731 * pi / (0.1 / speed) * hbar / moment,
                                     line_frequency + shift + detuning / (0.1 / speed));
    part.direction = {0, 0, 1};
    part.profile = StandingWaveProfile{1, WaveEnds::antinodes};
    Beamline b = atoms("H atom", speed, in_level(0, 0));
    b.parts = {place("C", 0.1, UniformField{0.1, low, {}}), place("R", 0.1, part), wide_screen(1)};
    return levels_of(b)[1];  // F=1 m=0
  };
  EXPECT_NEAR(flipped(0), 0, 1e-6);
  EXPECT_NEAR(flipped(0.64174), 1, 1e-5);
  EXPECT_NEAR(flipped(-0.64174), 1, 1e-5);
}

}  // namespace
}  // namespace rabiline::test::drive_shapes_test
