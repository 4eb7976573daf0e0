// Charges and spins in electric fields against closed forms.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::electric_field_test {
namespace {

constexpr double speed_of_light = 299792458, e_cm = 0.01 * elementary_charge;
constexpr double begin = 0.1, length = 0.2;

ElectricField electric(double size, UnitVector direction, double l = length) {
  ElectricField part;
  part.length = l;
  part.field = size;
  part.direction = direction;
  return part;
}
UniformField magnetic(double size, UnitVector direction = {}, double l = length) {
  UniformField part{l, size, {}};
  part.direction = direction;
  return part;
}

/// Particles of one speed along the axis, to a wide screen at 1 m.
Beamline beam(const Species& species, double speed, std::vector<PlacedPart> parts,
              const Law& law = ClassicalLaw{}, const UnitVector& spin = {}) {
  Beamline b;
  b.title = "electric";
  b.species = {{species, 1}};
  b.law = law;
  b.source = {SingleSpeed{speed}, Rectangle{0, 0}, ParallelDirection{}};
  b.source.spin = PolarisedSpin{spin, 1};
  b.parts = std::move(parts);
  b.parts.push_back(place("screen", 1, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  b.particles = 8;
  b.seed = 1;
  return b;
}
Track fly(const Beamline& b) { return trace(b, 0, best_isa()); }

const Species& proton() { return *find_species("proton"); }

// ---- charges ----

TEST(ElectricField, AcrossTheBeamBendsAChargeInAParabola) {
  const double v = 1e6, size = 1e4;
  const Track t = fly(beam(proton(), v, {place("E", begin, electric(size, {}))}));
  const double a = proton().charge * size / proton().mass, stay = length / v,
               behind = (1 - begin - length) / v;
  const auto fallen = [&](double s) { return s * a * (stay * stay / 2 + stay * behind); };
  expect_agreement(t.z.back(), fallen, 1e-9 * fallen(1), "q E");
  expect_agreement(
      t.vz.back(), [&](double s) { return s * a * stay; }, 1e-9 * a * stay, "q E");
  EXPECT_EQ(t.x.back(), 0);
}

TEST(ElectricField, AlongTheBeamGivesAChargeTheEnergyOfItsVoltage) {
  const double v = 5e5, size = 2e4;
  const Species& p = proton();
  for (const double sign : {1.0, -1.0}) {
    const Track t = fly(beam(p, v, {place("E", begin, electric(sign * size, {0, 1, 0}, 0.05))}));
    const double gained = p.mass / 2 * (t.vy.back() * t.vy.back() - v * v);
    expect_agreement(
        gained, [&](double s) { return s * sign * p.charge * size * 0.05; }, 1e-12 * p.charge * size * 0.05,
        "q E L");
  }
}

TEST(ElectricField, TurnsAChargeBackThatCannotClimbIt) {
  const double v = 4e5;  // 835 eV
  const Track t = fly(beam(proton(), v, {place("E", begin, electric(-1e4, {0, 1, 0}))}));
  EXPECT_EQ(t.fate, "left_backwards");
  EXPECT_NEAR(t.vy.back(), -v, 1e-9 * v);
}

/// Energy is kept in a fringe, which Maxwell's equations ask of it: kinetic energy and q phi, phi = 0 on both
/// sides.
TEST(ElectricField, WithAFringeKeepsTheEnergyOfWhatPassesBesideTheAxis) {
  ElectricField part = electric(2e4, {}, 0.1);
  part.fringe = TanhFringe{0.01};
  Beamline b = beam(proton(), 1e6, {place("E", 0.3, part)});
  b.source.offset = {2e-3, -2e-3};
  const Track t = fly(b);
  const double before = 1e12,
               after = t.vx.back() * t.vx.back() + t.vy.back() * t.vy.back() + t.vz.back() * t.vz.back();
  EXPECT_NEAR(after / before, 1, 1e-5);
  EXPECT_GT(std::abs(t.vz.back()), 1e5);
}

/// W. Wien: v = E/B goes straight.
TEST(ElectricField, CrossedWithBLetsOneSpeedPassStraight) {
  const double v = 1e6, field = 10e-3;
  const auto x_behind = [&](double scale) {
    return fly(beam(proton(), v,
                    {place("B", begin, magnetic(field)),
                     place("E", begin, electric(-scale * v * field, {1, 0, 0}))}))
        .x.back();
  };
  EXPECT_NEAR(x_behind(1), 0, 1e-12);
  EXPECT_GT(std::abs(x_behind(1.01)), 1e-3);
}

/// In crossed fields a charge at rest in the frame of E x B/B^2 drifts with it, and a slower one on a
/// cycloid: after whole turns it has gone on by E/B.
TEST(ElectricField, MakesAChargeDriftWithECrossB) {
  const Species& p = proton();
  const double field = 0.05, drift = 1e6, v = 1.5e6;  // along y: E = -drift B along x
  const double turn = two_pi * p.mass / (p.charge * field), l = 3 * drift * turn;
  Beamline b = beam(
      p, v,
      {place("B", begin, magnetic(field, {}, l)), place("E", begin, electric(-drift * field, {1, 0, 0}, l))});
  b.parts.back().placement.at = begin + l;
  const Track t = fly(b);
  EXPECT_NEAR(t.x.back(), 0, 1e-7);
  EXPECT_NEAR((t.t.back() - begin / v) / (3 * turn), 1, 1e-6);
  EXPECT_NEAR(t.vy.back() / v, 1, 1e-6);
}

// ---- spins ----

/// B' = B - v x E/c^2: along y through E along x the spin sees v E/c^2 along z.
TEST(ElectricField, TurnsTheSpinOfANeutronByWhatItSeesOfIt) {
  const double v = 500, size = 1e8;
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}, Law{DoradoLaw{Closure::torque, 0}}}) {
    const Track t = fly(beam(neutron(), v, {place("E", begin, electric(size, {1, 0, 0}))}, law, {1, 0, 0}));
    // S turns about z with -gamma B'.
    const auto angle = [&](double s) {
      return -gamma_n * s * size * length / (speed_of_light * speed_of_light);
    };
    expect_agreement(std::atan2(t.sy.back(), t.sx.back()), angle, 1e-10, "v x E");
    EXPECT_NEAR(t.vy.back(), v, 1e-9);
  }
}

/// With B along z, E in the xz plane at an angle from it: only E_x adds to |B| in first order.
TEST(ElectricField, BesideBActsAsTheExactSumOfBAndTheMotionalField) {
  const double v = 500, size = 1e8, b0 = 20e-6;
  const double motional = v * size / (speed_of_light * speed_of_light);
  for (const double angle : {0.0, 0.3, 1.2}) {
    const Track t = fly(beam(neutron(), v,
                             {place("B", begin, magnetic(b0)),
                              place("E", begin, electric(size, {std::sin(angle), 0, std::cos(angle)}))},
                             QuantumLaw{}, {1, 0, 0}));
    // -v y x E/c^2 = v (-E_z, 0, E_x)/c^2
    const Vector3 b{-motional * std::cos(angle), 0, b0 + motional * std::sin(angle)};
    const Vector3 s = turned_about((1 / length_of(b)) * b, -gamma_n * length_of(b) * length / v, {1, 0, 0});
    EXPECT_NEAR(t.sx.back(), s.x, 1e-9) << angle;
    EXPECT_NEAR(t.sy.back(), s.y, 1e-9) << angle;
    EXPECT_NEAR(t.sz.back(), s.z, 1e-9) << angle;
  }
}

/// H = -d sigma.E: 2 d E/hbar; reversing E shifts a precession by 4 d E/hbar.
TEST(ElectricField, TurnsASpinWithADipoleMomentAboutItself) {
  Species dipole = neutron();
  dipole.electric_dipole_moment = 1e-18 * e_cm;
  const double v = 200, size = 1e6;
  const auto azimuth = [&](double field) {
    const Track t = fly(beam(dipole, v, {place("E", begin, electric(field, {}))}, QuantumLaw{}, {1, 0, 0}));
    return std::atan2(t.sy.back(), t.sx.back());
  };
  const auto apart = [&](double s) { return -4 * s * 1e-18 * e_cm * size / hbar * length / v; };
  // v x E stands along x: it turns S about itself, but for what d E has turned.
  expect_agreement(azimuth(size) - azimuth(-size), apart, 1e-8, "4 d E/hbar");
}

/// Thomas: the spin of a charge with g = 1 in E does not turn in first order of v/c, g/2 = 1 - 1/2.
TEST(ElectricField, TurnsTheSpinOfAChargeByGLessOne) {
  const double v = 2e6, size = 3e4;
  for (const double g : {1.0, 2.0, 5.0}) {
    Species own = proton();
    own.name = "own";
    own.gyromagnetic_ratio = gyromagnetic_ratio(GFactor{g}, own.charge, own.mass);
    const Track t =
        fly(beam(own, v, {place("E", begin, electric(size, {1, 0, 0}))}, ClassicalLaw{}, {0, 1, 0}));
    // v x E = -v E z; W = (g - 1) q/(2 m) v x E/c^2, by v_y alone, which E does not change.
    const double rate = -(g - 1) * own.charge / (2 * own.mass) * v * size / (speed_of_light * speed_of_light);
    EXPECT_NEAR(std::atan2(-t.sx.back(), t.sy.back()), rate * length / v, 1e-12) << g;
  }
}

TEST(ElectricField, LeavesWhatHasNeitherChargeNorMomentAlone) {
  Species none = neutron();
  none.gyromagnetic_ratio = 0;
  const Track with = fly(beam(none, 500, {place("E", begin, electric(1e8, {}))})),
              without = fly(beam(none, 500, {}));
  EXPECT_EQ(with.x.back(), without.x.back());
  EXPECT_EQ(with.z.back(), without.z.back());
  EXPECT_NEAR(with.t.back(), without.t.back(), 1e-17);
  EXPECT_NEAR(with.sz.back(), 1, 1e-15);
}

TEST(ElectricField, ThatGoesToZeroLeavesThePlainFlight) {
  const auto spin = [](double size) {
    const Track t = fly(beam(
        neutron(), 500, {place("B", begin, magnetic(1e-5)), place("E", begin, electric(size, {1, 0, 0}))},
        QuantumLaw{}, {1, 0, 0}));
    return std::array{t.sx.back(), t.sy.back(), t.sz.back()};
  };
  const auto plain = spin(0), with = spin(1e-6);
  for (std::size_t i = 0; i < 3; ++i) EXPECT_NEAR(with[i], plain[i], 1e-12);
}

TEST(ElectricField, IsInTheCheckThatEveryRunMakes) {
  Beamline b =
      beam(proton(), 1e6,
           {place("B", begin, magnetic(0.02, {1, 0, 0})), place("E", begin, electric(3e4, {0, 0.6, 0.8}))});
  const auto found = check_of(b);
  ASSERT_TRUE(found);
  EXPECT_EQ(found->particles, 8U);
  EXPECT_LT(found->largest(), 1e-6);
}

}  // namespace
}  // namespace rabiline::test::electric_field_test
