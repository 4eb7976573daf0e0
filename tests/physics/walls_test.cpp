// What ends a path is what it meets first: fates, tracks and gas against closed forms.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "physics/agreement.hpp"
#include "physics/atoms.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::walls_test {
namespace {

Detector wide() { return {Rectangle{4, 4}, {1, 1}, {}}; }

/// Neutrons of 500 m/s from a point through these parts onto a wide detector at 2 m, within a chamber.
Beamline from_a_point(std::vector<PlacedPart> parts, double chamber = 30e-3) {
  Beamline b = suggested(0);
  b.law = ClassicalLaw{};
  b.source.speed = SingleSpeed{500};
  b.source.opening = Disc{0};
  b.chamber = Chamber{chamber};
  b.parts = std::move(parts);
  b.parts.push_back(place("screen", 2, wide()));
  b.particles = 1000;
  return b;
}
/// All of them at one slope, dx/dy and dz/dy.
Beamline along(Beamline b, double slope_x, double slope_z = 0) {
  // First about x, then about z.
  b.source.tilt.x = std::atan2(slope_z, std::hypot(1.0, slope_x));
  b.source.tilt.z = -std::atan(slope_x);
  return b;
}
double share_of(const Result& r, const std::string& fate, const std::string& where = "") {
  double sum = 0;
  for (const FateResult& f : r.fates)
    if (f.fate == fate && f.where == where) sum += f.particles.at(0);
  return sum / static_cast<double>(r.particles);
}
double stopped(const Beamline& b, const std::string& where) {
  return share_of(run_points({b}), "stopped", where);
}

/// The same flight in other ways: along a parabola and in steps that hardly bend it.
struct Flight {
  std::string what;
  std::function<void(Beamline&)> fly;
};
std::vector<Flight> flights() {
  const auto falls = [](const UnitVector& along) {
    return [along](Beamline& b) { b.gravity = Gravity{1e-6, along}; };
  };
  return {{"straight", [](Beamline&) {}},
          {"on a parabola", falls({0, 0, -1})},
          {"in steps", falls({0, 1, 0})},
          {"through a gradient",
           [](Beamline& b) {
             UniformField field{1.9, 1e-12, {}};
             field.gradient.quadrupole = 1e-9;
             b.parts.insert(b.parts.begin(), place("weak", 0.01, field));
           }},
          {"under closure larmor", [](Beamline& b) {
             b.law = DoradoLaw{Closure::larmor, 1};
             b.parts.insert(b.parts.begin(), place("weak", 0.01, UniformField{1.9, 1e-15, {}}));
           }}};
}

TEST(Ledger, BooksToTheChamberWhatMeetsItBeforeACollimator) {
  // Of a cosine law within alpha the share sin^2(theta)/sin^2(alpha) starts within theta.
  const double alpha = 0.05, chamber = 30e-3, radius = 10e-3, begin = 1, end = 1.5;
  const auto within = [&](double slope) { return std::pow(std::sin(std::atan(slope)) / std::sin(alpha), 2); };
  for (const Flight& flight : flights()) {
    Beamline b = from_a_point({place("C", begin, Collimator{end - begin, Disc{radius}})}, chamber);
    b.source.direction = CosineDirection{alpha};
    flight.fly(b);
    const bool straight = flight.what == "straight";
    b.particles = straight ? 2000000 : 20000;
    const Result r = run_points({b});
    const auto expect = [&](const std::string& fate, const std::string& where, double p) {
      const double tolerance = 4 * std::sqrt(p * (1 - p) / static_cast<double>(b.particles));
      if (straight && fate == "stopped")
        expect_agreement(
            share_of(r, fate, where), [&](double scale) { return p * scale; }, tolerance,
            (where + " " + flight.what).c_str());
      else
        EXPECT_NEAR(share_of(r, fate, where), p, tolerance) << where << " " << flight.what;
    };
    expect("stopped", "chamber", 1 - within(chamber / begin));
    expect("stopped", "C", within(chamber / begin) - within(radius / end));
    expect("detected", "screen", within(radius / end));
  }
}

TEST(Ledger, NamesOfTwoWallsThatWhichThePathMeetsFirst) {
  // A rectangular channel that sticks out of the chamber at its corners: both walls are crossed before its
  // end.
  const double chamber = 30e-3, half = 0.8 * chamber;
  for (const Flight& flight : flights()) {
    Beamline b = from_a_point({place("C", 0.02, Collimator{1.9, Rectangle{2 * half, 2 * half}})}, chamber);
    flight.fly(b);
    for (const double share : {0.0, 0.5, 0.7, 0.8, 0.9, 1.0}) {  // of the slope across, up
      const double slope = 0.05;
      const bool at_channel = std::hypot(1.0, share) * half < chamber;
      const Result r = run_points({along(b, slope, share * slope)});
      EXPECT_EQ(share_of(r, "stopped", at_channel ? "C" : "chamber"), 1) << share << " " << flight.what;
    }
  }
}

TEST(Ledger, AsksForAWallBeforeWhatStandsBehindItWithinIt) {
  // The path meets the bore at 0.5 m; a slit and a monitor stand at 0.7 m, within the field.
  Monitor monitor{Rectangle{1, 1}, {}};
  for (const Flight& flight : flights())
    for (const bool channel : {false, true}) {
      const Part wall = channel ? Part{Collimator{1.5, Rectangle{20e-3, 20e-3}}}
                                : Part{UniformField{1.5, 1e-12, Bore{10e-3}}};
      Beamline b = from_a_point(
          {place("wall", 0.2, wall), place("S", 0.7, Slit{Disc{5e-3}, {}}), place("M", 0.7, monitor)});
      flight.fly(b);
      const Result late = run_points({along(b, 10e-3 / 0.5)});
      EXPECT_EQ(share_of(late, "stopped", "wall"), 1) << flight.what << channel;
      EXPECT_EQ(late.monitors.at(0).passed.at(0), 0) << flight.what << channel;
      EXPECT_EQ(stopped(along(b, 10e-3 / 0.75), "S"), 1) << flight.what << channel;
    }
}

TEST(Track, EndsWhereThePathMeetsAWall) {
  const double chamber = 30e-3, slope = 0.04;
  for (const Flight& flight : flights())
    for (const bool collimated : {false, true}) {
      Beamline b = from_a_point({}, chamber);
      if (collimated) b.parts.insert(b.parts.begin(), place("C", 1.2, Collimator{0.3, Disc{10e-3}}));
      flight.fly(b);
      const Track t = trace(along(b, slope), 0, best_isa());
      EXPECT_EQ(t.fate, "stopped") << flight.what;
      EXPECT_EQ(t.where, "chamber") << flight.what;
      EXPECT_NEAR(t.y.back(), chamber / slope, 1e-7) << flight.what;
      EXPECT_NEAR(std::hypot(t.x.back(), t.z.back()), chamber, 1e-8) << flight.what;
    }
}

/// Both levels are pushed by the chamber's radius at the place `meets`.
TEST(Magnet, LeavesToTheChamberWhatMeetsItBeforeAPole) {
  const double chamber = 4e-3, begin = 0.1, length = 0.5, speed = 100, gradient = 80;
  const double pull = 0.5 * std::abs(gamma_n) * constants::hbar * gradient / neutron_mass;
  const double meets = begin + speed * std::sqrt(2 * chamber / pull);
  ASSERT_LT(meets, begin + length);
  for (const double half : {0.0, 3.9e-3, 4.1e-3}) {  // of the gap along the force
    GradientMagnet magnet;
    magnet.length = length;
    magnet.field = 1;
    magnet.gradient = gradient;
    if (half > 0) magnet.gap = Rectangle{10e-3, 2 * half};
    Beamline b = from_a_point({place("A", begin, magnet)}, chamber);
    b.law = QuantumLaw{};
    b.source.speed = SingleSpeed{speed};
    const bool at_pole = half > 0 && half < chamber;
    EXPECT_EQ(stopped(b, at_pole ? "A" : "chamber"), 1) << half;
    const Track t = trace(b, 0, best_isa());
    EXPECT_EQ(t.where, at_pole ? "A" : "chamber");
    if (at_pole) continue;
    expect_agreement(
        t.y.back(), [&](double scale) { return begin + (meets - begin) * std::sqrt(scale); }, 1e-7,
        "chamber");
    EXPECT_NEAR(std::abs(t.z.back()), chamber, 1e-9);
  }
}

/// Stepped magnets, alone and overlapped by a field.
TEST(Magnet, OfAtomsLeavesToTheChamberWhatMeetsItBeforeAPole) {
  for (const bool overlapped : {false, true})
    for (const double half : {1.8e-3, 2.2e-3}) {
      const double chamber = 2e-3;
      GradientMagnet magnet = gradient_magnet(1.0, 0.5, 100);
      magnet.gap = Rectangle{10e-3, 2 * half};
      Beamline b = atoms("K-39 atom", 600, UnpolarisedSpin{});
      b.chamber = Chamber{chamber};
      b.parts = {place("M", 0.1, magnet), wide_screen(1.5)};
      if (overlapped) b.parts.insert(b.parts.begin(), place("F", 0.05, UniformField{1.2, 1e-3, {}}));
      b.particles = 400;
      const std::string wall = half < chamber ? "M" : "chamber";
      EXPECT_EQ(stopped(b, wall), 1) << overlapped << half;
      const Track t = trace(b, 0, best_isa());
      EXPECT_EQ(t.where, wall) << overlapped << half;
      EXPECT_NEAR(std::abs(t.z.back()), std::min(half, chamber), 1e-6) << overlapped << half;
    }
}

// ---- gas ----

constexpr double density = 4e19, cross_section = 1e-19, per_metre = density * cross_section;
GasCell gas(double length) {
  GasCell part;
  part.length = length;
  part.gas = GasDensity{density};
  part.cross_section = cross_section;
  return part;
}

/// Paths at this slope from a point meet a wall of this radius a third of the way through the cell.
struct SlantGas {
  double begin = 0.2, length = 0.6, slope = 0.05;
  double third() const { return begin + length / 3; }
  double radius() const { return slope * third(); }
  double way() const { return length / 3 * std::hypot(1.0, slope); }
};

void expect_third(const Beamline& b, const std::string& wall, const std::string& what) {
  const SlantGas slant;
  const Result r = run_points({along(b, slant.slope)});
  expect_agreement(
      share_of(r, "scattered", "gas"),
      [&](double scale) { return -std::expm1(-per_metre * scale * slant.way()); }, 2e-11, what.c_str());
  expect_agreement(
      share_of(r, "stopped", wall), [&](double scale) { return std::exp(-per_metre * scale * slant.way()); },
      2e-11, what.c_str());
  std::uint64_t quanta = 0;
  for (const FateResult& f : r.fates) quanta += f.quanta_low.at(0);
  EXPECT_EQ(quanta, b.particles * quanta_per_particle) << what;
}

TEST(GasCell, AttenuatesUpToTheWallThatThePathMeets) {
  const SlantGas slant;
  const double r = slant.radius();
  GasCell with_bore = gas(slant.length);
  with_bore.bore = Bore{r};
  expect_third(from_a_point({place("gas", slant.begin, with_bore)}, 1), "gas", "its own bore");
  const PlacedPart cell = place("gas", slant.begin, gas(slant.length));
  expect_third(from_a_point({cell}, r), "chamber", "the chamber");
  expect_third(from_a_point({place("C", 0.1, Collimator{1, Rectangle{2 * r, 1}}), cell}, 2), "C",
               "a channel");
  expect_third(from_a_point({place("C", 0.1, Collimator{1, Disc{r}}), cell}, 2), "C", "a round collimator");
  expect_third(from_a_point({cell, place("stop", slant.third(), Slit{Disc{1e-3}, {}})}, 2), "stop", "a slit");
  expect_third(from_a_point({place("B", 0.3, UniformField{0.3, 1e-3, Bore{r}}), cell}, 2), "B",
               "a field's bore");
}

TEST(GasCell, ScattersNothingOfWhatMissesItsFront) {
  GasCell narrow = gas(0.3);
  narrow.bore = Bore{1e-3};
  const Beamline b = from_a_point({place("gas", 0.2, narrow)});
  EXPECT_EQ(stopped(along(b, 6e-3), "gas"), 1);
  EXPECT_EQ(share_of(run_points({along(b, 6e-3)}), "scattered", "gas"), 0);
}

TEST(GasCell, AttenuatesAParabolaUpToItsBore) {
  // Neutrons of 4 m/s thrown up by 0.6 rad: the way from vz to vz - g t in closed form.
  const double speed = 4, tilt = 0.6, g = 9.81, vy = speed * std::cos(tilt), begin = 0.2, meets = 0.3;
  const auto height = [&](double y) { return y * std::tan(tilt) - 0.5 * g * std::pow(y / vy, 2); };
  GasCell cell = gas(0.3);
  cell.bore = Bore{height(meets)};
  Beamline b = from_a_point({place("gas", begin, cell)}, 4);
  b.source.tilt.x = tilt;
  b.source.speed = SingleSpeed{speed};
  b.gravity = Gravity{g, {0, 0, -1}};
  const auto way = [&](double y) {  // ds = sqrt(vy^2 + vz^2) dt, dt = -dvz/g
    const double vz = speed * std::sin(tilt) - g * y / vy;
    return -(vz * std::hypot(vy, vz) + vy * vy * std::asinh(vz / vy)) / (2 * g);
  };
  const Result r = run_points({b});
  expect_agreement(
      share_of(r, "scattered", "gas"),
      [&](double scale) { return -std::expm1(-per_metre * scale * (way(meets) - way(begin))); }, 1e-6,
      "path");
  EXPECT_NEAR(share_of(r, "scattered", "gas") + share_of(r, "stopped", "gas"), 1, 1e-12);
}

TEST(GasCell, ShowsAMonitorInItWhatGotThere) {
  Monitor monitor{Rectangle{1, 1}, {}};
  const Beamline b = from_a_point({place("gas", 0.2, gas(0.6)), place("M", 0.35, monitor)});
  const Result r = run_points({b});
  expect_agreement(
      r.monitors.at(0).passed.at(0), [](double scale) { return std::exp(-per_metre * scale * 0.15); }, 2e-11,
      "way to the monitor");
  EXPECT_NEAR(share_of(r, "detected", "screen"), std::exp(-per_metre * 0.6), 2e-11);
}

TEST(Ledger, HasTheSameBitsForAnyNumberOfThreadsBatchesAndInstructionSets) {
  Beamline b =
      from_a_point({place("gas", 0.05, gas(1.5)), place("C", 0.1, Collimator{1.2, Rectangle{48e-3, 48e-3}}),
                    place("D", 1.4, Collimator{0.3, Disc{10e-3}})});
  b.source.direction = CosineDirection{0.06};
  b.gravity = Gravity{9.81, {0.6, 0, -0.8}};
  b.particles = 20000;
  RunOptions many;
  many.threads = 3;
  many.batch = 24;
  const Result one = run_points({b}), other = run_points({b}, many);
  for (const char* where : {"chamber", "C", "D"}) EXPECT_GT(share_of(one, "stopped", where), 1e-4) << where;
  ASSERT_EQ(one.fates.size(), other.fates.size());
  for (std::size_t i = 0; i < one.fates.size(); ++i) {
    EXPECT_EQ(one.fates[i].quanta_low, other.fates[i].quanta_low);
    EXPECT_EQ(one.fates[i].quanta_high, other.fates[i].quanta_high);
  }
}

}  // namespace
}  // namespace rabiline::test::walls_test
