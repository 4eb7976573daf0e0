// Whole apparatus with deflecting magnets A and B and fields between them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/apparatus.hpp"
#include "spin/atoms.hpp"

namespace rabiline::test::apparatus_test {
namespace {

// ---- Ramsey ----

double ramsey(double w1, double delta, double tau, double time) {
  const double a = std::hypot(w1, delta);
  const double bracket = std::cos(delta * time / 2) * std::cos(a * tau / 2) -
                         delta / a * std::sin(delta * time / 2) * std::sin(a * tau / 2);
  return 4 * std::pow(w1 / a * std::sin(a * tau / 2) * bracket, 2);
}

TEST(Ramsey, BetweenTwoMagnetsIsSeenInFlopOutAndInFlopIn) {
  const double tau = 2e-5, time = 2e-4, w1 = pi / 2 / tau;
  for (const double offset : {0.0, 700.0, 1250.0, 2500.0, 9000.0}) {
    Apparatus s;
    RotatingField first = turning(0.02, w1 / std::abs(gamma_n), larmor + offset, Sense::co), second = first;
    second.frequency.reset();
    second.sense.reset();
    second.oscillator = "first";
    second.phase = {};
    s.between = {place("C", 0.5, UniformField{0.3, field, {}}), place("first", 0.53, first),
                 place("second", 0.75, second)};
    const auto detected = [&](double b) {
      s.detector.offset.z = b;
      return run_points({beamline_of(s)}).detectors.at(0).detected.at(0);
    };
    const double out = detected(height(s, 1, 1)), in = detected(height(s, 1, -1));
    const auto flip = [&](double scale) { return ramsey(scale * w1, scale * two_pi * offset, tau, time); };
    EXPECT_NEAR(in, flip(1), 1e-6) << offset;
    EXPECT_NEAR(out, 1 - flip(1), 1e-6) << offset;
    if (offset == 700) expect_agreement(in, flip, 1e-6, "flop-in");
    EXPECT_EQ(detected(height(s, -1, 1)), 0);
  }
}

// ---- Majorana ----

/// P(1/2 -> m) of spin 3/2 by the flip p of spin 1/2.
std::array<double, 4> from_half(double p) {
  return {3 * p * (1 - p) * (1 - p), (1 - p) * (1 - 3 * p) * (1 - 3 * p), p * (2 - 3 * p) * (2 - 3 * p),
          3 * p * p * (1 - p)};
}

TEST(SpinThreeHalves, PartsBehindTheSecondMagnetByMajoranasFormula) {
  Apparatus s;
  s.species = moment_of(7, 3, 1e-26);
  s.spin = PopulatedSpin{{0, 0, 1}, {0, 1, 0, 0}};
  s.a = 100;
  s.b = 700;
  const double w0 = s.species.gyromagnetic_ratio * field, w1 = 2.2 / 2e-4, detuning = 3000;
  s.between = {
      place("C", 0.5, UniformField{0.3, field, {}}),
      place("R", 0.55, turning(0.2, w1 / s.species.gyromagnetic_ratio, (w0 + detuning) / two_pi, Sense::co))};
  const auto flip = [&](double scale) { return rabi(scale * w1, detuning, 2e-4); };
  for (const Outcomes outcomes : {Outcomes::split, Outcomes::sample}) {
    s.outcomes = outcomes;
    s.particles = outcomes == Outcomes::split ? 8 : 400000;
    const double tolerance = outcomes == Outcomes::split ? 1e-6 : 4 * 0.5 / std::sqrt(4e5);
    for (std::size_t m = 0; m < 4; ++m) {
      s.detector.offset.z = height(s, 1 / 3.0, 1 - 2 * static_cast<double>(m) / 3);
      const double found = run_points({beamline_of(s)}).detectors.at(0).detected.at(0);
      EXPECT_NEAR(found, from_half(flip(1))[m], tolerance) << m;
      if (outcomes == Outcomes::split)
        expect_agreement(
            found, [&](double scale) { return from_half(flip(scale))[m]; }, tolerance, "m");
    }
  }
}

// ---- an oven ----

/// A refocuses exactly at every speed: B of -3 times the gradient, the screen half the gap behind it.
TEST(EffusiveBeam, HasItsStrongestFlopAtTheKnownFieldAndTheKnownWidth) {
  Apparatus s;
  s.species = moment_of(7, 1, 1e-25);
  s.speed = EffusiveSpeed{600};
  s.a = 1000;
  s.b = -3000;
  s.screen = 1.2 + 0.15;
  s.detector.face = Rectangle{1, 1e-7};
  s.particles = 400000;
  const double alpha = std::sqrt(2 * boltzmann * 600 / (7 * atomic_mass)), l = 0.2;
  const double w0 = s.species.gyromagnetic_ratio * field;
  const auto stays = [&](double w1, double offset) {
    s.between = {place("C", 0.5, UniformField{0.3, field, {}}),
                 place("R", 0.55,
                       turning(l, w1 * alpha / l / s.species.gyromagnetic_ratio,
                               w0 / two_pi + offset * alpha / l, Sense::co))};
    return run_points({beamline_of(s)}).detectors.at(0).detected.at(0);
  };
  const double best = 1.2001 * pi, peak = 0.76576, width = 1.0730, error = 4 * 0.35 / std::sqrt(4e5);
  const double top = 1 - stays(best, 0);
  EXPECT_NEAR(top, peak, error);
  EXPECT_LT(1 - stays(1.1 * best, 0), top);
  EXPECT_LT(1 - stays(0.9 * best, 0), top);
  for (const double side : {-0.5, 0.5}) {
    EXPECT_NEAR(1 - stays(best, side * width), peak / 2, error);
    EXPECT_GT(std::abs(1 - stays(best, 1.01 * side * width) - peak / 2), error);
  }
}

TEST(Resonance, OfAFixedFrequencyIsAtItsField) {
  const double frequency = 300e3, centre = two_pi * frequency / std::abs(gamma_n), w1 = pi / 2e-4;
  std::vector<Beamline> points;
  for (int i = -20; i <= 20; ++i) {
    Apparatus s;
    s.between = {place("C", 0.5, UniformField{0.3, centre * (1 + 2e-3 * i), {}}),
                 place("R", 0.55, turning(0.2, w1 / std::abs(gamma_n), frequency, Sense::co))};
    s.detector.offset.z = height(s, 1, -1);
    points.push_back(beamline_of(s));
  }
  const std::vector<double> line = run_points(points).detectors.at(0).detected;
  double sum = 0, moment = 0;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const double b = centre * (1 + 2e-3 * (static_cast<double>(i) - 20));
    EXPECT_NEAR(line[i], rabi(w1, gamma_n * (b - centre), 2e-4), 1e-6);
    sum += line[i];
    moment += line[i] * b;
  }
  expect_agreement(
      moment / sum, [&](double scale) { return scale * centre; }, 1e-6 * centre, "centre");
}

// ---- potassium through two wires, a field that drives it, and two wires ----

/// mu(B) of K-39 (2, m) from its energy by its own formula, E = g_I' m x_B + D/2 sqrt(1 + m x + x^2) (+ at m
/// = -2 a straight line), by differences.
double energy_of_potassium(int m, double b) {
  const double gj = 2.00229421, gi = -1.4193489e-4, split = planck * 461.719720e6;
  const double x = (gj - gi) * bohr_magneton * b / split;
  const double root = m == -2 ? 1 - x : std::sqrt(1 + m * x + x * x);
  return gi * bohr_magneton * m * b + split / 2 * root;
}
double moment_of_potassium(int m, double b, double scale) {
  const double db = 1e-6 * (b + 1e-3);
  return -scale * (energy_of_potassium(m, b + db) - energy_of_potassium(m, b - db)) / (2 * db);
}

struct Wires {
  double a = 4e-3, h = 4.8e-3, b = 0.02;  // half distance, height, field there
  double length = 0.4;
};

/// Straight line above the wires: z'' = mu(B) B'/m, B = b (a^2 + h^2)/(a^2 + z^2); kick and drift.
void through(const Wires& w, int m, double speed, double scale, double& z, double& v) {
  constexpr int steps = 60;
  const double dt = w.length / speed / steps, mass = 38.96370648482 * atomic_mass;
  z += w.h;
  for (int i = 0; i < steps; ++i) {
    z += v * dt / 2;
    const double d = w.a * w.a + z * z, b = w.b * (w.a * w.a + w.h * w.h) / d;
    v += dt * moment_of_potassium(m, b, scale) * -2 * z * b / d / mass;
    z += v * dt / 2;
  }
  z -= w.h;
}

TEST(PotassiumBeam, ThroughTwoWireMagnetsAndADriveIsWhatABruteForceGives) {
  const Wires wires;
  const double temperature = 450, low_field = 1e-6, length = 0.2, angle = 1.3;
  const double alpha = std::sqrt(2 * boltzmann * temperature / (38.96370648482 * atomic_mass));
  const double per_tesla = (2.00229421 + 3 * -1.4193489e-4) / 4 * bohr_magneton / planck,
               line = per_tesla * low_field;
  Beamline b = atoms("K-39 atom", 0, in_level(2, 2));
  b.source.speed = EffusiveSpeed{temperature};
  TwoWireMagnet magnet;
  magnet.length = wires.length;
  magnet.half_distance = wires.a;
  magnet.wire_radius = 1e-3;
  magnet.strength = FieldAtBeam{wires.b};
  b.parts = {
      place("A", 0.1, magnet), place("C", 0.5, UniformField{0.3, low_field, {}}),
      place("R", 0.55, turning(length, angle * alpha / length / two_pi / per_tesla, line, Sense::positive)),
      place("B", 0.8, magnet), place("screen", 1.5, Detector{Rectangle{1, 40e-3}, {1, 40}, {}})};
  b.particles = 1000000;
  const DetectorResult d = run_points({b}).detectors.at(0);

  const auto share_of = [&](double low, double high, double scale) {
    constexpr int speeds = 3000;
    double sum = 0;
    for (int i = 0; i < speeds; ++i) {
      const double y = 4.5 * (i + 0.5) / speeds, v = y * alpha,
                   weight = 2 * y * y * y * std::exp(-y * y) * 4.5 / speeds;
      double z = 0, vz = 0;
      through(wires, 2, v, scale, z, vz);
      z += vz * 0.3 / v;
      const double p = std::pow(std::sin(angle * alpha / v / 2), 2);
      for (int k = 0; k <= 4; ++k) {
        double zk = z, vk = vz;
        through(wires, 2 - k, v, scale, zk, vk);
        zk += vk * 0.3 / v;
        const double binomial = std::array{1, 4, 6, 4, 1}[static_cast<std::size_t>(k)];
        if (zk >= low && zk < high) sum += weight * binomial * std::pow(p, k) * std::pow(1 - p, 4 - k);
      }
    }
    return sum;
  };
  const auto found = [&](double low, double high) {
    double sum = 0;
    for (std::size_t i = 0; i < d.counts_z.size(); ++i) {
      const double z = (d.z.edges[i] + d.z.edges[i + 1]) / 2;
      if (z >= low && z < high) sum += d.counts_z[i];
    }
    return sum / 1e6;
  };
  // Between edges where much of the beam is; what the quadrature leaves is below 5e-4.
  const std::array edges{0.0, 1e-3, 2e-3, 4e-3, 20e-3};
  double largest_change = 0;
  const double tolerance = 4 * 0.5 / 1e3 + 5e-4;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    const double expected = share_of(edges[i], edges[i + 1], 1);
    EXPECT_NEAR(found(edges[i], edges[i + 1]), expected, tolerance) << edges[i];
    largest_change = std::max(largest_change, std::abs(share_of(edges[i], edges[i + 1], 1.01) - expected));
  }
  EXPECT_GT(largest_change, tolerance);
}

}  // namespace
}  // namespace rabiline::test::apparatus_test
