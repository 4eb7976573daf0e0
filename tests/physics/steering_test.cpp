// Magnets whose force depends on the place: two wires, iron poles, many poles.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "particle/species.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"
#include "spin/atoms.hpp"
#include "spin/breit_rabi.hpp"
#include "spin/moment_table.hpp"
#include "transport/stages/steering.hpp"

namespace rabiline::test::steering_test {
namespace {

/// mu = gamma hbar I along its spin.
Species atom(double mass, double moment) {
  return {"test", mass * atomic_mass, 0, {1}, 2 * moment / hbar, ""};
}
/// One particle from a point, by its state: level 0 is m = +1/2.
Beamline line(const Species& species, double speed, std::vector<PlacedPart> parts, int level) {
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.species = {{species, 1}};
  b.source.speed = SingleSpeed{speed};
  b.source.opening = Disc{0};
  b.source.spin = PopulatedSpin{{0, 0, 1}, level == 0 ? std::vector{1.0, 0.0} : std::vector{0.0, 1.0}};
  b.chamber.reset();
  b.parts = std::move(parts);
  b.particles = 1;
  return b;
}
struct Exit {
  double x, z, vx, vz;
  std::string fate;
};
Exit exit_of(const Beamline& b) {
  const Track t = trace(b, 0, best_isa());
  return {t.x.back(), t.z.back(), t.vx.back(), t.vz.back(), t.fate};
}
TwoWireMagnet wires(double field, double a) {
  TwoWireMagnet m;
  m.length = 0.5;
  m.half_distance = a;
  m.wire_radius = 0.5 * a;
  m.strength = FieldAtBeam{field};
  return m;
}
MultipoleMagnet poles(std::uint64_t n, double length) {
  MultipoleMagnet m;
  m.length = length;
  m.poles = n;
  m.pole_field = 1;
  m.radius = 5e-3;
  return m;
}

// ---- two wires ----

TEST(TwoWireMagnet, HasTheGradientOfTwoCurrents) {
  // B6: G/B = 2z/(a^2 + z^2), 0.98361/a at z = 1.2 a: the bend of a stiff beam, constant along it.
  const double a = 4e-3, field = 0.2, mass = 39, speed = 20000;
  const Exit out = exit_of(line(atom(mass, -bohr_magneton), speed, {place("A", 0, wires(field, a))}, 0));
  expect_agreement(
      out.vz,
      [&](double s) { return bohr_magneton * field * s * 0.98361 / a * 0.5 / speed / (mass * atomic_mass); },
      1e-3 * out.vz, "G/B");
  EXPECT_NEAR(out.vx, 0, 1e-12);
}

TEST(TwoWireMagnet, TakesACurrentOrTheFieldThatItGives) {
  const double a = 2e-3, current = 200;
  TwoWireMagnet by_current = wires(0, a);
  by_current.strength = WireCurrent{current};
  // mu_0/(4 pi) = 1e-7: B = 4e-7 I a/(a^2 + z^2).
  const double field = 4e-7 * current * a / (a * a * (1 + 1.44));
  const Exit one = exit_of(line(atom(39, -bohr_magneton), 600, {place("A", 0, by_current)}, 0));
  const Exit other = exit_of(line(atom(39, -bohr_magneton), 600, {place("A", 0, wires(field, a))}, 0));
  expect_agreement(
      one.vz, [&](double s) { return s * other.vz; }, 1e-8 * other.vz, "current");
  by_current.strength = WireCurrent{0};
  EXPECT_EQ(exit_of(line(atom(39, -bohr_magneton), 600, {place("A", 0, by_current)}, 0)).vz, 0);
}

TEST(TwoWireMagnet, BendsASlowBeamAsAnIntegrationDoes) {
  // On the symmetry line m z'' = mu dB/dz, B = B_0 (a^2 + h^2)/(a^2 + z^2), in 100000 steps of a leapfrog.
  const double a = 2e-3, h = 1.2 * a, field = 0.4, mass = 39, speed = 400;
  const auto integrated = [&](double scale) {
    double z = h, v = 0;
    const int steps = 100000;
    const double dt = 0.5 / speed / steps;
    for (int i = 0; i < steps; ++i) {
      z += v * dt / 2;
      const double d = a * a + z * z;
      v += dt * scale * bohr_magneton * field * (a * a + h * h) * 2 * z / (d * d) / (mass * atomic_mass);
      z += v * dt / 2;
    }
    return z - h;
  };
  const Exit out = exit_of(line(atom(mass, -bohr_magneton), speed, {place("A", 0, wires(field, a))}, 0));
  EXPECT_GT(out.z, 0.5 * a);  // the force has changed by much on the way
  expect_agreement(out.z, integrated, 1e-9 + 1e-6 * out.z, "deflection");
}

TEST(TwoWireMagnet, TurnedByHalfATurnUndoesAnother) {
  const double a = 4e-3;
  TwoWireMagnet first = wires(0.2, a), second = first;
  second.tilt.y = pi;
  second.strength = FieldAtBeam{-0.2};  // along +z again
  const Species species = atom(39, -bohr_magneton);
  const Exit up = exit_of(line(species, 2000, {place("A", 0, first)}, 0));
  const Exit down = exit_of(line(species, 2000, {place("B", 0, second)}, 0));
  EXPECT_GT(up.vz, 0);
  EXPECT_NEAR(up.vz, -down.vz, 1e-12 * up.vz);
  second = wires(0.2, a);
  second.tilt.y = pi / 2;
  Beamline aside = line(species, 2000, {place("B", 0, second)}, 0);
  aside.source.spin = PopulatedSpin{{1, 0, 0}, {1, 0}};
  EXPECT_NEAR(exit_of(aside).vx, up.vz, 1e-12 * up.vz);
  first.offset.z = a;
  EXPECT_GT(exit_of(line(species, 2000, {place("A", 0, first)}, 0)).vz, up.vz);  // closer to the wires
}

/// Spins of one direction through magnets that push what is along their field to +z of their own frame, and
/// a screen that catches this half.
struct Analysis {
  double turn = 0, field = 0.2;  // [rad], [T]
  int twice_spin = 1, magnets = 1;
  Outcomes outcomes = Outcomes::split;
  // A weak field within the first magnet, or one that begins and ends in a fringe around it: both are one
  // field that sorts levels.
  enum class Guide { none, within, around } guide = Guide::none;
  double along() const { return std::copysign(1, field) * std::cos(turn); }  // z . B/|B|
};
DetectorResult found(const Analysis& a, std::vector<double> populations) {
  const Species species{"test", 39 * atomic_mass, 0, {a.twice_spin}, -bohr_magneton / hbar, ""};
  std::vector<PlacedPart> parts;
  for (int i = 0; i < a.magnets; ++i) {
    TwoWireMagnet m = wires(a.field, 4e-3);
    m.tilt.y = a.turn;
    parts.push_back(place(i == 0 ? "A" : "B", 0.05 + 0.6 * i, m));
  }
  if (a.guide == Analysis::Guide::within) parts.push_back(place("G", 0.2, UniformField{0.1, 1e-9, {}}));
  if (a.guide == Analysis::Guide::around) {
    UniformField around{0.58, 1e-14, {}};
    around.fringe = TanhFringe{1e-3};
    parts.push_back(place("G", 0.02, around));
  }
  Detector half{Rectangle{0.1, 0.1}, {1, 1}, {}};
  half.tilt.y = a.turn;
  const double centre = 0.05 + 20e-6;  // what is not pushed misses it
  half.offset = {centre * std::sin(a.turn), centre * std::cos(a.turn)};
  parts.push_back(place("half", 1.5, half));
  Beamline b = line(species, 2000, parts, 0);
  b.law = QuantumLaw{a.outcomes};
  b.source.spin = PopulatedSpin{{0, 0, 1}, std::move(populations)};
  b.particles = a.outcomes == Outcomes::sample ? 10000 : 8;
  return run_points({b}).detectors.at(0);
}

TEST(TurnedMagnets, FindSpinsAlongTheirOwnField) {
  for (const double field : {0.2, -0.2})
    for (const double turn : {0.0, 0.5, pi / 2, 2.5, pi, -2.0})
      for (const int magnets : {1, 2}) {
        const Analysis a{turn, field, 1, magnets};
        const DetectorResult d = found(a, {1, 0});
        expect_agreement(
            d.detected[0], [&](double s) { return (s + a.along()) / 2; }, 1e-9, "along the field");
        // Those are then along the field, which the screen asks along z again.
        if (d.detected[0] > 1e-6) {
          EXPECT_NEAR(d.levels[0], (1 + a.along()) / 2, 1e-6) << turn;
        }
        for (const auto guide : {Analysis::Guide::within, Analysis::Guide::around})
          EXPECT_NEAR(found({turn, field, 1, magnets, Outcomes::split, guide}, {1, 0}).detected[0],
                      d.detected[0], 1e-9)
              << turn;
        EXPECT_NEAR(found({turn, field, 1, magnets, Outcomes::sample}, {1, 0}).detected[0], d.detected[0],
                    4.5 * 0.5 / 100)
            << turn;
      }
}

TEST(TurnedMagnets, FindLargerSpinsByMajoranasFormula) {
  const Analysis a{1.0, 0.2, 2};
  const double up = (1 + a.along()) / 2;
  expect_agreement(
      found(a, {1, 0, 0}).detected[0], [&](double scale) { return scale * up * up; }, 1e-9, "from m = 1");
  expect_agreement(
      found(a, {0, 1, 0}).detected[0], [&](double scale) { return scale * 2 * up * (1 - up); }, 1e-9,
      "from m = 0");
}

TEST(TurnedMagnets, PushVectorsByWhatTheyHaveAlongTheField) {
  const Species species = atom(39, -bohr_magneton);
  const auto exit = [&](double turn, double field, const Vector3& axis) {
    TwoWireMagnet m = wires(field, 4e-3);
    m.tilt.y = turn;
    Beamline b = line(species, 2000, {place("A", 0, m)}, 0);
    b.law = ClassicalLaw{};
    b.source.spin = PolarisedSpin{{axis.x, axis.y, axis.z}, 1};
    const Exit out = exit_of(b);
    return out.vx * std::sin(turn) + out.vz * std::cos(turn);
  };
  const double full = exit(0, 0.2, {0, 0, 1});
  for (const double field : {0.2, -0.2})
    for (const double turn : {0.4, pi / 2, 2.0, pi, -1.0}) {
      const double sign = std::copysign(1, field);
      // A full spin along the field, or against it, is pushed as in a magnet that stands upright.
      EXPECT_NEAR(exit(turn, field, {sign * std::sin(turn), 0, sign * std::cos(turn)}), full, 1e-9 * full);
      EXPECT_NEAR(exit(turn, field, {0, 1, 0}), 0, 1e-9 * full);
      const double along = exit(turn, field, {0, 0, 1}), against = exit(turn, field, {0, 0, -1});
      if (std::abs(std::cos(turn)) > 0.1) {
        EXPECT_EQ(along > 0, sign * std::cos(turn) > 0) << turn;
        EXPECT_LT(along * against, 0) << turn;
      }
    }
}

TEST(TwoWireMagnet, StopsAtItsWiresWhatTheyDraw) {
  const double a = 2e-3;
  TwoWireMagnet m = wires(0.4, a);
  m.offset.x = -a;  // a wire straight below
  EXPECT_EQ(exit_of(line(atom(39, -bohr_magneton), 400, {place("A", 0, m)}, 1)).fate, "stopped");
  EXPECT_EQ(exit_of(line(atom(39, -bohr_magneton), 400, {place("A", 0, m)}, 0)).fate, "passed");
}

TEST(TwoWireMagnet, IsAUniformFieldUnderTheHypothesis) {
  Beamline b = line(neutron(), 1000, {place("A", 0.1, wires(1e-3, 2e-3))}, 0);
  b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
  Beamline uniform = b;
  uniform.parts = {place("A", 0.1, UniformField{0.5, 1e-3, {}})};
  b.law = uniform.law = DoradoLaw{Closure::larmor, 1e-3};
  EXPECT_NE(exit_of(b).x, 0);
  EXPECT_NEAR(exit_of(b).x, exit_of(uniform).x, 1e-12);
}

TEST(IronMagnet, IsTwoWiresBetweenPoles) {
  IronMagnet iron;
  iron.length = 0.5;
  iron.field = 0.4;
  iron.half_distance = 2e-3;
  iron.convex = 1.8e-3;
  iron.concave = 3.2e-3;
  iron.width = 2e-3;
  const Species species = atom(39, -bohr_magneton);
  for (const int level : {0, 1}) {
    const Exit a = exit_of(line(species, 3000, {place("A", 0, iron)}, level));
    const Exit b = exit_of(line(species, 3000, {place("A", 0, wires(0.4, 2e-3))}, level));
    EXPECT_EQ(a.fate, "passed");
    EXPECT_EQ(a.vz, b.vz);
    EXPECT_EQ(exit_of(line(species, 400, {place("A", 0, iron)}, level)).fate, "stopped");
  }
  iron.offset.x = 1.01e-3;
  EXPECT_EQ(exit_of(line(species, 3000, {place("A", 0, iron)}, 0)).fate, "stopped");
}

// ---- many poles ----

/// B8: caesium, one Bohr magneton, 250 m/s, 1 T at 5 mm: w^2 = 2 mu B0/(m r0^2).
constexpr double caesium = 132.905, beam = 250;
double quarter_wave(double scale = 1) {
  return pi * beam / 2 / std::sqrt(2 * scale * bohr_magneton / (caesium * atomic_mass * 25e-6));
}

TEST(MultipoleMagnet, OfSixPolesMakesAPointSourceParallel) {
  EXPECT_NEAR(quarter_wave(), 0.2142, 5e-5);
  const Species cs = atom(caesium, -bohr_magneton);
  for (const double slope : {2e-3, 10e-3, 20e-3}) {
    Beamline b = line(cs, beam, {place("S", 0, poles(6, quarter_wave()))}, 0);
    b.source.tilt.x = slope;
    const Exit low = exit_of(b);
    const double v = beam * std::sin(slope);
    // The exact solution has the speed along the beam, v cos.
    const auto angle = [&](double s) { return pi / 2 / std::cos(slope) * std::sqrt(s); };
    expect_agreement(
        low.vz, [&](double s) { return v * std::cos(angle(s)); }, 2e-6 * v, "parallel");
    expect_agreement(
        low.z,
        [&](double s) { return v / std::sqrt(s) * quarter_wave() / beam / (pi / 2) * std::sin(angle(s)); },
        1e-9 + 1e-6 * low.z, "height");
    EXPECT_EQ(low.fate, "passed");
  }
}

TEST(MultipoleMagnet, OfSixPolesLosesTheOtherLevel) {
  Beamline b = line(atom(caesium, -bohr_magneton), beam, {place("S", 0, poles(6, quarter_wave()))}, 1);
  b.source.tilt.x = 20e-3;
  EXPECT_EQ(exit_of(b).fate, "stopped");
  b.source.tilt.x = 1e-3;  // cosh and sinh of a right angle
  const double v = beam * std::sin(1e-3);
  expect_agreement(
      exit_of(b).vz, [&](double s) { return v * std::cosh(pi / 2 * std::sqrt(s)); }, 1e-5 * v, "cosh");
}

TEST(MultipoleMagnet, OfFourPolesPullsWithAConstantForce) {
  Beamline b = line(atom(caesium, -bohr_magneton), beam, {place("Q", 0.01, poles(4, 0.05))}, 0);
  b.source.offset = {3e-3, 4e-3 * 0.75};
  const Exit out = exit_of(b);
  const double stay = 0.05 / beam, r = std::hypot(3e-3, 3e-3);
  expect_agreement(
      std::hypot(out.x, out.z),
      [&](double s) { return r - s * bohr_magneton / 5e-3 / (caesium * atomic_mass) * stay * stay / 2; },
      1e-9, "radius");
  EXPECT_NEAR(out.x, out.z, 1e-15);
}

TEST(MultipoleMagnet, WithoutFieldLeavesTheBeamAlone) {
  MultipoleMagnet m = poles(6, 0.2);
  m.pole_field = 0;
  Beamline b = line(atom(caesium, -bohr_magneton), beam, {place("S", 0, m)}, 0);
  b.source.tilt.x = 1e-3;
  EXPECT_NEAR(exit_of(b).z, 0.2 * std::tan(1e-3), 1e-15);
}

TEST(MultipoleMagnet, FocusesHydrogenByItsEffectiveMoment) {
  // The level (1, 0) of hydrogen, whose moment grows from nothing: Breit and Rabi's formula in 200000 steps.
  const HyperfineAtom& h = *find_atom("H");
  const Species& hydrogen = *find_species("H atom");
  const MomentTable table(coupled_spins(*hydrogen.structure));
  Steering s;
  s.end = 0.2;
  s.shape.kind = MagnetKind::multipole;
  s.shape.field = 0.5;
  s.shape.power = 2;
  s.shape.radius = 5e-3;
  s.mass = hydrogen.mass;
  s.moment = table.largest();
  s.levels = table.levels();
  s.moments = {table.coefficients().data(), table.cells(), table.scale()};
  Batch batch;
  BatchView& v = batch.view();
  v.count = v.padded = 8;
  for (int i = 0; i < 8; ++i) {
    v.x[i] = 2e-3;
    v.z[i] = v.vx[i] = v.vz[i] = v.t[i] = 0;
    v.vy[i] = 3000;
    v.slowness[i] = 1.0 / 3000;
    v.level[i] = 1;
    v.weight[i] = 1;
    v.flying[i] = ~std::uint64_t{0};
  }
  kernel::steer(best_isa())(s, v);
  const auto integrated = [&](double scale) {
    double x = 2e-3, speed = 0;
    const int steps = 200000;
    const double dt = 0.2 / 3000 / steps, k = 0.5 / 25e-6;
    for (int i = 0; i < steps; ++i) {
      x += speed * dt / 2;
      speed += dt * scale * breit_rabi(h, 2, 0, k * x * x).moment * 2 * k * x / hydrogen.mass;
      x += speed * dt / 2;
    }
    return x;
  };
  EXPECT_LT(v.x[0], 1.9e-3);
  expect_agreement(v.x[0], integrated, 1e-9, "place");
}

}  // namespace
}  // namespace rabiline::test::steering_test
