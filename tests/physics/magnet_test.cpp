// Deflecting magnets: one level, one parabola.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/atoms.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::magnet_test {
namespace {

Species atom(double mass_in_u, int twice_spin, double moment) {
  // mu = gamma hbar I along its spin.
  return {"test", mass_in_u * atomic_mass, 0, {twice_spin}, moment / (hbar * twice_spin / 2.0), ""};
}
/// Atoms from a point along +y through these parts, onto a screen of one bin along x and many along z.
Beamline line(const Species& species, std::vector<PlacedPart> parts, double y, double height, int bins) {
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.species = {{species, 1}};
  b.source.speed = SingleSpeed{1000};
  b.source.opening = Disc{0};
  b.chamber.reset();
  b.parts = std::move(parts);
  b.parts.push_back(place("screen", y, Detector{Rectangle{1, height}, {1, bins}, {}}));
  return b;
}
/// Centres of the bins along z that hold anything.
std::vector<double> places(const Beamline& b) {
  const DetectorResult d = run_points({b}).detectors.at(0);
  std::vector<double> out;
  for (std::size_t i = 0; i < d.counts_z.size(); ++i)
    if (d.counts_z[i] > 0) out.push_back((d.z.edges[i] + d.z.edges[i + 1]) / 2);
  return out;
}

TEST(GradientMagnet, ParsNeutronsIntoTwoPlaces) {
  // B12: 100 T/m over 1 m at 1000 m/s: .2884 mm each.
  const std::vector<double> found =
      places(line(neutron(), {place("M", 0.1, magnet(1, 100))}, 1.1, 1e-3, 100000));
  ASSERT_EQ(found.size(), 2U);
  for (const double z : found)
    expect_agreement(
        std::abs(z), [](double s) { return s * 0.5 * -gamma_n * hbar / 2 * 100 / neutron_mass * 1e-6; },
        1.1e-8, "deflection");
  EXPECT_NEAR(found[1], 0.2884e-3, 1e-7);
}

TEST(GradientMagnet, ParsAnySpinIntoItsLevelsAlike) {
  const std::vector<double> found =
      places(line(atom(7, 3, 1e-26), {place("M", 0.1, magnet(0.5, 1000))}, 1.1, 1e-3, 100000));
  ASSERT_EQ(found.size(), 4U);
  for (std::size_t i = 0; i < 4; ++i)
    EXPECT_NEAR(found[i] / found[3], (2.0 * static_cast<double>(i) - 3) / 3, 1e-3);
}

TEST(GradientMagnet, PushesAlongItsGradientByTheSignOfTheMoment) {
  GradientMagnet part = magnet(0.5, 1000);
  part.along = {1, 0, 0};
  for (const double moment : {1e-26, -1e-26}) {
    Beamline b = line(atom(7, 1, moment), {place("M", 0.1, part)}, 1.1, 1, 1);
    b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
    b.parts.back() = place("screen", 1.1, Detector{Rectangle{1, 1}, {2, 1}, {}});
    const DetectorResult d = run_points({b}).detectors.at(0);
    EXPECT_EQ(d.counts_x[moment > 0 ? 1 : 0], 10000);
  }
}

TEST(GradientMagnet, SpreadsAnOvensBeamByItsSpeeds) {
  // B5: K at 450 K, 1000 T/m, 0.1 + 0.3 m, one Bohr magneton: s_alpha = 26.12 mm; CDF (1 + s_a/s)
  // exp(-s_a/s).
  Beamline b = line(atom(38.96370649, 1, bohr_magneton), {place("M", 0.1, magnet(0.1, 1000))}, 0.5, 0.4, 400);
  b.source.speed = EffusiveSpeed{450};
  b.particles = 4000000;
  const DetectorResult d = run_points({b}).detectors.at(0);
  const auto below = [&](double s) {
    double sum = 0;
    for (std::size_t i = 0; i < 400; ++i)
      if (std::abs((d.z.edges[i] + d.z.edges[i + 1]) / 2) < s) sum += d.counts_z[i];
    return sum / 4e6;
  };
  for (const double s : {10e-3, 20e-3, 50e-3})
    expect_agreement(
        below(s),
        [&](double scale) {
          const double ratio = scale * 26.12e-3 / s;
          return (1 + ratio) * std::exp(-ratio);
        },
        4 * 0.5 / std::sqrt(4e6), "spread");
}

TEST(GradientMagnet, SmearsAClassicalMomentEvenly) {
  Beamline b = line(neutron(), {place("M", 0.1, magnet(1, 100))}, 1.1, 2 * 0.2884e-3, 20);
  b.law = ClassicalLaw{};
  b.particles = 200000;
  const DetectorResult d = run_points({b}).detectors.at(0);
  for (const double count : d.counts_z) EXPECT_NEAR(count, 1e4, 5 * 100);
}

TEST(GradientMagnet, DoesNothingUnderTheHypothesisToSpinsAlongItsField) {
  Beamline b = line(neutron(), {place("M", 0.1, magnet(1, 100))}, 1.1, 1e-3, 101);
  b.law = DoradoLaw{};
  b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
  EXPECT_EQ(places(b).size(), 1U);
}

TEST(GradientMagnet, StopsWhatMeetsTheWallsOfItsGapAnywhere) {
  // Up at first and pulled back down: it turns round above the gap's edge inside the magnet.
  GradientMagnet part = magnet(1, 100);
  part.gap = Rectangle{1, 2 * 0.1e-3};
  Beamline b = line(neutron(), {place("M", 0.1, part)}, 1.3, 1, 1);
  b.source.spin = PolarisedSpin{{0, 0, 1}, 1};  // the moment points down
  b.source.opening = Disc{0};
  b.source.tilt.x = 0.35e-3;
  const double enters = 0.1 * 0.35e-3, top = enters + std::pow(0.35e-3, 2) / (4 * 0.2884e-3);
  ASSERT_GT(top, 0.1e-3);
  EXPECT_EQ(run_points({b}).detectors.at(0).detected.at(0), 0);
  std::get<GradientMagnet>(b.parts[0].part).gap = Rectangle{1, 2 * 1.01 * top};
  EXPECT_EQ(run_points({b}).detectors.at(0).detected.at(0), 1);
  std::get<GradientMagnet>(b.parts[0].part).gap = Rectangle{1, 2 * 0.99 * top};
  EXPECT_EQ(run_points({b}).detectors.at(0).detected.at(0), 0);
}

/// Potassium in a level whose moment changes with the field: the force differs from place to place, also
/// where the magnet is one field among others.
TEST(GradientMagnet, TakesItsFieldAlongWhereItIsMoved) {
  const Offset d{0.4e-3, -0.7e-3};
  const auto behind = [](Offset magnet, Offset source, double gradient, bool overlapped) {
    Beamline b = atoms("K-39 atom", 600, in_level(2, -1));
    b.source.offset = source;
    GradientMagnet part = gradient_magnet(0.3, 0.2, gradient);
    part.along = {0.6, 0, 0.8};
    part.gap = Rectangle{10e-3, 10e-3};
    part.offset = magnet;
    b.parts = {place("M", 0.2, part), wide_screen(0.8)};
    if (overlapped) b.parts.insert(b.parts.begin(), place("F", 0.1, UniformField{0.5, 1e-9, {}}));
    const Track t = trace(b, 0, best_isa());
    return std::array{t.x.back() - source.x, t.z.back() - source.z};
  };
  for (const bool overlapped : {false, true}) {
    const auto moved = behind(d, {}, 100, overlapped), beside = behind({}, {-d.x, -d.z}, 100, overlapped),
               stays = behind({}, {}, 100, overlapped), other = behind({}, {-d.x, -d.z}, 101, overlapped);
    for (const std::size_t i : {0U, 1U}) {
      const double tolerance = 1e-6 * std::abs(beside[i]);
      EXPECT_NEAR(moved[i], beside[i], tolerance) << overlapped;
      EXPECT_GT(std::abs(stays[i] - beside[i]), 100 * tolerance) << overlapped;
      EXPECT_GT(std::abs(other[i] - beside[i]), 100 * tolerance) << overlapped;
    }
  }
}

/// Rabi's apparatus: the second magnet undoes the deflection of the first where the level has not changed.
Beamline rabis(double offset, const Law& law) {
  const double field = 10e-3, gamma = -gamma_n, stay = 0.1 / 1000;
  RotatingField rf;
  rf.length = 0.1;
  rf.amplitude = pi / stay / gamma;
  rf.frequency = gamma * field / two_pi + offset;
  rf.sense = Sense::co;
  rf.phase = {Phase::Kind::random, 0};
  // Deflected by d in the first, z' = 2d/L; the second at equal length and -3 times the gradient brings it
  // back to the axis at its end: d + 2d (gap/L) + 2d - 3d - ... is left to the screen, which is where all
  // unflipped meet.
  Beamline b = line(neutron(),
                    {place("A", 0.1, magnet(0.4, 100)), place("C", 0.6, UniformField{0.1, field, {}}),
                     place("RF", 0.6, rf), place("B", 0.8, magnet(0.4, -100))},
                    1.2, 2e-5, 1);
  b.law = law;
  // At the end: sum of both parabolas and the flight between, z = a L^2/2 + a L (gap + L) - a L^2/2.
  const double a = gamma * hbar / 2 * 100 / neutron_mass, t = 0.4 / 1000, between = 0.3 / 1000;
  const double z = a * t * (between + t);
  std::get<Detector>(b.parts.back().part).offset.z = z;
  b.particles = 4000;
  return b;
}

TEST(TwoMagnets, AndAFieldBetweenGiveRabisFlopOutWithALevelDrawnOnce) {
  const auto detected = [](double offset) {
    return run_points({rabis(offset, QuantumLaw{})}).detectors.at(0).detected.at(0);
  };
  // Half of the beam is in the level that the screen stands for; Rabi's formula takes it away.
  for (const double offset : {0.0, 4000.0, 8000.0, 60000.0}) {
    const double w1 = pi / 1e-4, rate = std::hypot(w1, two_pi * offset);
    const double flip = std::pow(w1 / rate * std::sin(rate * 1e-4 / 2), 2);
    EXPECT_NEAR(detected(offset), 0.5 * (1 - flip), 4 * 0.5 / std::sqrt(4000.0)) << offset;
  }
}

TEST(TwoMagnets, BetweenRamseysZonesEraseTheirFringes) {
  const double field = 10e-3, gamma = -gamma_n, length = 0.02;
  const auto flip = [&](double offset, double gradient) {
    RotatingField first;
    first.length = length;
    first.amplitude = pi / 2 / (length / 1000) / gamma;
    first.frequency = gamma * field / two_pi + offset;
    first.sense = Sense::co;
    RotatingField second = first;
    second.frequency.reset();
    second.sense.reset();
    second.oscillator = "first";
    Beamline b = line(neutron(),
                      {place("B", 0.1, UniformField{0.5, field, {}}), place("first", 0.1, first),
                       place("second", 0.58, second)},
                      1, 1, 1);
    if (gradient != 0) {  // nothing overlaps it: it projects, however weak it is
      GradientMagnet part = magnet(0.1, gradient);
      part.field = field;
      b.parts[0] = place("B", 0.1, UniformField{0.2, field, {}});
      b.parts.insert(b.parts.begin() + 2, place("M", 0.3, part));
      b.parts.insert(b.parts.begin() + 3, place("behind", 0.4, UniformField{0.2, field, {}}));
    }
    b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
    b.particles = 20000;
    return run_points({b}).detectors.at(0).levels.at(1);
  };
  EXPECT_GT(flip(0, 0), 0.999);
  EXPECT_LT(flip(1000 / 0.46 / 2 * 0.95, 0), 0.05);
  for (const double offset : {0.0, 1000 / 0.46 / 2})
    EXPECT_NEAR(flip(offset, 1), 0.5, 4 * 0.5 / std::sqrt(20000.0));
}

}  // namespace
}  // namespace rabiline::test::magnet_test
