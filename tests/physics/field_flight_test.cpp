// Flights through fields that differ from place to place, and free fall, against closed forms and an
// independent integration.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "constants.hpp"
#include "physics/atoms.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::field_flight_test {
namespace {

constexpr double five_angstrom = planck / (neutron_mass * 5e-10);  // [m/s]

UniformField field_with(double length, double size, FieldGradient gradient) {
  UniformField field;
  field.length = length;
  field.field = size;
  field.gradient = gradient;
  return field;
}
/// Neutrons along the beam from a hole of that height, spins along x.
Beamline neutrons(Law law, std::vector<PlacedPart> parts, double height = 0) {
  Beamline b;
  b.title = "neutrons";
  b.species = {{neutron(), 1}};
  b.law = law;
  b.source = {SingleSpeed{five_angstrom}, Rectangle{0, height}, ParallelDirection{}};
  b.source.spin = PolarisedSpin{{1, 0, 0}, 1};
  b.parts = std::move(parts);
  b.parts.push_back(place("screen", 4.0, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  b.particles = 20000;
  b.seed = 1938;
  return b;
}

/// gamma G L/v = 70.04 turns per metre of height for 1e-3 T/m over 1.9 m.
TEST(FieldFlight, TurnsASpinByTheFieldAtItsHeight) {
  const double b0 = 1e-3, slope = 1e-3, stay = 1.9 / five_angstrom;
  EXPECT_NEAR(std::abs(gamma_n) * slope * stay / two_pi, 70.04, 0.005);
  const Beamline b =
      neutrons(ClassicalLaw{}, {place("B", 0.1, field_with(1.9, b0, {.quadrupole = slope}))}, 0.04);
  for (std::uint64_t particle = 0; particle < 20; ++particle) {
    const Track t = trace(b, particle, best_isa());
    const double z = t.z.front(), x_part = -slope * t.x.front();
    ASSERT_EQ(x_part, 0);
    const double azimuth = -gamma_n * (b0 + slope * z) * stay;  // S turns with -gamma B
    EXPECT_NEAR(t.sx.back(), std::cos(azimuth), 2e-6) << z;
    EXPECT_NEAR(t.sy.back(), std::sin(azimuth), 2e-6) << z;
    EXPECT_GT(std::abs(std::cos(azimuth) - std::cos(1.01 * azimuth)), 1e-5);
  }
}

/// Over a height h the mean of cos(phi + k z) is cos(phi) sin(x)/x, x = k h/2.
TEST(FieldFlight, WashesFringesOutAsSincOfTheSpreadOfPhases) {
  const double b0 = 1e-4, stay = 1.9 / five_angstrom, height = 0.04;
  for (const double slope : {0.0, 1e-4, 2e-4, 5e-4}) {
    const double x = gamma_n * slope * stay * height / 2, phase = -gamma_n * b0 * stay;
    const double contrast = x == 0 ? 1 : std::sin(x) / x, up = 0.5 * (1 + contrast * std::cos(phase));
    for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}}) {
      SpinFilter filter;
      filter.axis = {1, 0, 0};
      filter.up = 1;
      filter.down = 0;
      const Result r = run_points({neutrons(
          law, {place("B", 0.1, field_with(1.9, b0, {.quadrupole = slope})), place("A", 2.5, filter)},
          height)});
      const DetectorResult& screen = r.detectors.at(0);
      EXPECT_NEAR(screen.detected[0], up, 3 * screen.detected_errors[0] + 1e-9) << slope << describe(law);
    }
  }
}

TEST(FieldFlight, OfAGradientThatGoesToZeroIsThatOfThePlainField) {
  const auto spin_behind = [](double slope) {
    const Beamline b =
        neutrons(ClassicalLaw{}, {place("B", 0.1, field_with(1.9, 1e-3, {.longitudinal = slope}))});
    const Track t = trace(b, 0, best_isa());
    return std::array{t.sx.back(), t.sy.back(), t.sz.back()};
  };
  const auto plain = spin_behind(0), with = spin_behind(1e-18);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(with[i], plain[i], 1e-11);
}

/// P(stays) = exp(-pi gamma B_t^2/(2 dB_l/dt)) (L. Landau, C. Zener 1932): .20788 where gamma B_t = 1/s and
/// gamma dB_l/dt = 1/s^2.
TEST(FieldFlight, CrossesAZeroAsLandauAndZenerHaveIt) {
  const double rate = 1e4;  // [1/s] the unit
  const double length = 100 / rate * five_angstrom, across = rate / std::abs(gamma_n),
               slope = rate * rate / std::abs(gamma_n) / five_angstrom;
  UniformField transverse;
  transverse.length = length;
  transverse.field = across;
  transverse.direction = {1, 0, 0};
  Beamline b = neutrons(ClassicalLaw{}, {place("L", 0.1, field_with(length, 1e-30, {.longitudinal = slope})),
                                         place("T", 0.1, transverse)});
  b.parts.back().placement.at = 0.2 + length;
  const double far = 50 / std::hypot(1, 50), near = 1 / std::hypot(1, 50);
  b.source.spin = PolarisedSpin{{near, 0, -far}, 1};
  const Track t = trace(b, 0, best_isa());
  const double along = t.sx.back() * near + t.sz.back() * far;  // the field, now up
  const double stays = 0.5 * (1 - along);
  EXPECT_NEAR(stays, 0.20788, 5e-4);
  EXPECT_GT(std::abs(std::exp(-pi / 2 * 1.01) - 0.20788), 2e-3);
}

/// Each species of parts, laws and species at random: 1e-6 of place, direction and spin.
TEST(FieldFlight, AgreesWithAnIndependentIntegrationInRandomFields) {
  std::mt19937 random(14);
  const auto uniform = [&](double a, double b) {
    return std::uniform_real_distribution<double>(a, b)(random);
  };
  std::uint64_t particles = 0;
  for (int setting = 0; setting < 60; ++setting) {
    const double size = std::pow(10, uniform(-5.5, -4));
    UniformField fringed = field_with(uniform(0.1, 0.3), size, {});
    fringed.fringe = TanhFringe{uniform(0.01, 0.04)};
    fringed.direction = {1, 0, 0};
    const double slope = 10 * size;
    MultipoleField quadrupole;
    quadrupole.length = 0.2;
    quadrupole.field = size;
    quadrupole.radius = 0.02;
    RotatingField rf = std::get<RotatingField>(suggested(1).parts.at(2).part);
    rf.amplitude = 0.1 * size;
    rf.frequency = std::abs(gamma_n) / two_pi * size * uniform(0.5, 1.5);
    const Law laws[] = {QuantumLaw{}, ClassicalLaw{}, DoradoLaw{Closure::torque, uniform(-1.5, 1.5)},
                        DoradoLaw{Closure::larmor, uniform(-1.5, 1.5)}};
    std::vector<PlacedPart> parts{
        place("G", uniform(0.25, 0.4),
              field_with(uniform(0.1, 0.3), size,
                         {uniform(-slope, slope), uniform(-slope, slope), uniform(-slope, slope)})),
        place("F", uniform(0.3, 0.4), fringed), place("H0", 0.35, rf)};
    if (setting % 2 == 0) parts.push_back(place("Q", uniform(0.3, 0.4), quadrupole));
    Beamline b = neutrons(laws[setting % 4], parts, 4e-3);
    b.source.speed = GaussianSpeed{uniform(300, 1500), 20};
    b.source.direction = ConeDirection{5e-3};
    b.chamber = Chamber{0.02};
    if (setting % 3 == 0) b.gravity = Gravity{9.81};
    std::ranges::stable_sort(b.parts, {}, [](const PlacedPart& p) { return p.placement.at; });
    const auto found = check_of(b);
    ASSERT_TRUE(found) << setting;
    particles += found->particles;
    EXPECT_LT(found->largest(), 1e-6) << setting << ' ' << describe(b.law) << ' ' << found->place << ' '
                                      << found->direction << ' ' << found->spin;
  }
  EXPECT_GT(particles, 400U);
}

/// Off the axis the field of a fringe jumps where the fringe begins and ends as half a sine: 1000 rad/m
/// squared times r^2/4 of it, 3 % at half a millimetre.
TEST(FieldFlight, SeesTheKinksOfASineFringe) {
  UniformField field = field_with(0.02, 1e-3, {});
  field.direction = {1, 0, 0};
  field.fringe = SineFringe{3e-3};
  Beamline b = neutrons(QuantumLaw{}, {place("B", 0.3, field)}, 1e-3);
  b.source.opening = Rectangle{1e-3, 1e-3};
  b.source.speed = GaussianSpeed{800, 80};
  b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
  EXPECT_LT(check_of(b).value().spin, 1e-6);
}

TEST(FieldFlight, IsCheckedSoThatStepsTooLongAreSeen) {
  Beamline b = neutrons(ClassicalLaw{1e-2}, {place("G", 0.1, field_with(1, 1e-5, {.longitudinal = 1e-3}))});
  UniformField across;
  across.length = 1;
  across.field = 2e-5;
  across.direction = {1, 0, 0};
  b.parts.insert(b.parts.begin(), place("T", 0.1, across));
  EXPECT_GT(check_of(b).value().spin, 1e-6);
}

/// mu G/m x L^2/2: .2884 mm for 100 T/m over 1 m at 1000 m/s.
TEST(FieldFlight, SortsTheLevelsOfANeutronInAFieldThatGrows) {
  Beamline b = neutrons(QuantumLaw{}, {place("B", 0.1, field_with(1, 1, {.quadrupole = 100}))});
  b.source.speed = SingleSpeed{1000};
  b.source.spin = UnpolarisedSpin{};
  b.parts.back() = place("screen", 1.1, Detector{Rectangle{1e-3, 1e-3}, {1, 1000}, {}});
  b.particles = 1000;
  const Result r = run_points({b});
  const DetectorResult& screen = r.detectors.at(0);
  double up = 0, down = 0;
  for (std::size_t i = 0; i < screen.counts_z.size(); ++i) {
    const double z = 0.5 * (screen.z.edges[i] + screen.z.edges[i + 1]);
    if (std::abs(z - 0.2884e-3) < 1.5e-6) up += screen.counts_z[i];
    if (std::abs(z + 0.2884e-3) < 1.5e-6) down += screen.counts_z[i];
  }
  EXPECT_NEAR(up + down, 1000, 1e-3);
  EXPECT_NEAR(up, 500, 4 * std::sqrt(250));
}

/// On the axis of a sextupole nothing grows: levels come apart where the beam is.
TEST(FieldFlight, SortsTheLevelsOfABeamAboutTheAxisOfASextupole) {
  MultipoleField sextupole;
  sextupole.length = 1;
  sextupole.poles = 6;
  sextupole.field = 1;
  sextupole.radius = 0.01;
  MultipoleMagnet magnet;
  magnet.length = 1;
  magnet.poles = 6;
  magnet.pole_field = 1;
  magnet.radius = 0.01;
  const auto detected_by = [](Part part) {
    Beamline b = neutrons(QuantumLaw{}, {place("Q", 0.2, std::move(part))}, 5e-3);
    b.source.speed = SingleSpeed{200};
    b.source.spin = UnpolarisedSpin{};
    b.parts.back() = place("screen", 1.5, Detector{Rectangle{1e-3, 1e-3}, {1, 1}, {}});
    b.particles = 4000;
    return run_points({b}).detectors.at(0).detected.at(0);
  };
  const double by_magnet = detected_by(magnet);
  EXPECT_NEAR(detected_by(sextupole), by_magnet, 1e-3);
  EXPECT_GT(by_magnet, 0.1);
  EXPECT_LT(by_magnet, 0.19);  // a fifth without a field
}

/// -g (L/v)^2/2.
TEST(FreeFall, FollowsAParabola) {
  Beamline b = neutrons(QuantumLaw{}, {});
  b.gravity = Gravity{9.81};
  EXPECT_NEAR(trace(b, 0, best_isa()).z.back(), -125.4e-6, 0.05e-6);
  b.source.speed = SingleSpeed{200};
  b.parts = {place("screen", 0.9, Detector{Rectangle{1, 1}, {1, 1}, {}})};
  const Track t = trace(b, 0, best_isa());
  EXPECT_NEAR(t.z.back(), -99.3e-6, 0.05e-6);
  EXPECT_NEAR(t.z.back(), -0.5 * 9.81 * 0.0045 * 0.0045, 1e-18);
  EXPECT_NEAR(t.vz.back(), -9.81 * 0.0045, 1e-15);
}

TEST(FreeFall, GoesOnThroughFieldsAndMagnetsAndTurnedPaths) {
  const double fallen = -0.5 * 9.81 * 0.004 * 0.004;
  const auto z_behind = [&](Law law, Part part) {
    Beamline b = neutrons(law, {place("M", 0.2, std::move(part))});
    b.source.speed = SingleSpeed{250};
    b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
    b.parts.back() = place("screen", 1.0, Detector{Rectangle{1, 1}, {1, 1}, {}});
    const double straight = trace(b, 0, best_isa()).z.back();
    b.gravity = Gravity{9.81};
    return trace(b, 0, best_isa()).z.back() - straight;
  };
  UniformField uniform;
  uniform.length = 0.4;
  uniform.field = 1e-3;
  EXPECT_NEAR(z_behind(QuantumLaw{}, uniform), fallen, 1e-15);
  EXPECT_NEAR(z_behind(QuantumLaw{}, gradient_magnet(0.4, 1, 10)), fallen, 1e-15);
  EXPECT_NEAR(z_behind(ClassicalLaw{}, field_with(0.4, 1e-6, {.longitudinal = 1e-6})), fallen, 1e-12);
  uniform.field = 1e-8;  // spins along z: closure torque leaves them alone
  EXPECT_NEAR(z_behind(DoradoLaw{}, uniform), fallen, 1e-12);
  MultipoleMagnet sextupole;
  sextupole.length = 0.4;
  sextupole.poles = 6;
  sextupole.pole_field = 1e-9;
  sextupole.radius = 5e-3;
  EXPECT_NEAR(z_behind(QuantumLaw{}, sextupole), fallen, 1e-9);
}

/// A flight upwards ends where it began, whichever planes it passes shortly below its top: v0^2 = 2 g times
/// its height.
TEST(FreeFall, ComesBackThroughAPlaneThatItHasJustPassed) {
  const double g = 9.81, first = 0.1, edge = 1.1;
  const auto both = [&](double size, FieldGradient gradient) {
    return std::vector<PlacedPart>{place("below", first, field_with(edge - first, size, gradient)),
                                   place("above", edge, field_with(1, size / 2, gradient))};
  };
  const std::pair<Law, std::vector<PlacedPart>> cases[]{{ClassicalLaw{}, both(1e-7, {})},
                                                        {ClassicalLaw{}, both(1e-9, {.quadrupole = 1e-9})},
                                                        {DoradoLaw{.kappa = 1e-6}, both(1e-7, {})}};
  for (const auto& [law, parts] : cases)
    for (const double above : {1e-9, 1e-6, 1e-4, 2e-3, 8e-3, 0.05}) {
      Beamline b = neutrons(law, parts);
      const double speed = std::sqrt(2 * g * (edge + above));
      b.source.speed = SingleSpeed{speed};
      b.gravity = Gravity{g, {0, -1, 0}};
      const Track t = trace(b, 0, best_isa());
      EXPECT_EQ(t.fate, "left_backwards") << t.law << above;
      EXPECT_NEAR(t.vy.back(), -speed, 1e-6) << t.law << above;
      EXPECT_NEAR(t.t.back(), 2 * speed / g, 1e-6) << t.law << above;
    }
}

/// A charge between plates comes back with the speed that it had.
TEST(ElectricField, SendsBackWhatHasJustEnteredIt) {
  for (const double strength : {1e3, 1e4, 1e5, 1e6, 1e7}) {  // turns it within 52 mm to 5 um
    ElectricField plates;
    plates.length = 0.5;
    plates.field = -strength;
    plates.direction = {0, 1, 0};
    Beamline b =
        neutrons(ClassicalLaw{}, {place("below", 0.2, field_with(0.3, 1e-9, {})), place("E", 0.5, plates)});
    b.species = {{*find_species("proton"), 1}};
    b.source.speed = SingleSpeed{1e5};
    const Track t = trace(b, 0, best_isa());
    EXPECT_EQ(t.fate, "left_backwards") << strength;
    EXPECT_NEAR(t.vy.back() / -1e5, 1, 1e-6) << strength;
  }
}

}  // namespace
}  // namespace rabiline::test::field_flight_test
