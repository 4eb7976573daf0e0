// What slits, collimators, beam stops and walls let through, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/atoms.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::apertures_test {
namespace {

constexpr double deg = pi / 180;

/// A parallel beam from a 4 x 4 mm opening through these parts onto a wide detector.
Beamline parallel(std::vector<PlacedPart> parts) {
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.source.opening = Rectangle{4e-3, 4e-3};
  b.chamber.reset();
  b.parts = std::move(parts);
  b.parts.push_back(place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  b.particles = 200000;
  return b;
}
double detected(const Beamline& b) { return run_points({b}).detectors.at(0).detected.at(0); }

/// The fraction of the 16 mm^2 that an area [mm^2] covers, to four standard errors.
void expect_area(const Beamline& b, const std::function<double(double scale)>& area) {
  const double p = area(1) / 16;
  expect_agreement(
      detected(b), [&](double s) { return area(s) / 16; }, 4 * std::sqrt(p * (1 - p) / 2e5), "area");
}

TEST(Slit, OfARingPassesWhatIsBetweenItsCircles) {
  expect_area(parallel({place("S", 0.5, Slit{Ring{0.5e-3, 1.9e-3}, {}})}),
              [](double s) { return pi * (s * s * 1.9 * 1.9 - 0.25); });
}

TEST(Slit, TurnedInItsPlaneCutsACornerOff) {
  // A long slit 1.6 mm wide, turned by 30 deg, is seen by the square over a width of 1.6/cos(30).
  Slit slit{Rectangle{1.6e-3, 0.1}, {}};
  slit.tilt.y = 30 * deg;
  expect_area(parallel({place("S", 0.5, slit)}), [](double s) { return 4 * 1.6 * s / std::cos(30 * deg); });
}

TEST(Slit, TurnedByAPositiveAngleLeansFromZTowardsX) {
  Slit slit{Rectangle{0.4e-3, 0.1}, {}};
  slit.tilt.y = 45 * deg;
  Beamline b = parallel({place("S", 0.5, slit)});
  b.parts.back() =
      place("screen", 1.2, Detector{Rectangle{2e-3, 2e-3}, {1, 1}, {1e-3, 1e-3}});  // x and z positive
  EXPECT_GT(detected(b), 0.05);
  b.parts.back() = place("screen", 1.2, Detector{Rectangle{2e-3, 2e-3}, {1, 1}, {1e-3, -1e-3}});
  EXPECT_LT(detected(b), 0.01);
}

TEST(BeamStop, StopsWhatHitsItAndNothingElse) {
  expect_area(parallel({place("stop", 0.5, BeamStop{Disc{1.5e-3}, {0.2e-3, 0}})}),
              [](double s) { return 16 - s * s * pi * 1.5 * 1.5; });
}

TEST(Collimator, PassesWhatASlitAtEachEndPasses) {
  for (const Face& face : {Face{Rectangle{1e-3, 2e-3}}, Face{Disc{1e-3}}}) {
    const Offset offset{0.3e-3, -0.2e-3};
    const Opening opening = opening_of(face);
    Beamline channel = parallel({place("C", 0.2, Collimator{0.3, face, offset})});
    Beamline slits =
        parallel({place("A", 0.2, Slit{opening, offset}), place("B", 0.5, Slit{opening, offset})});
    for (Beamline* b : {&channel, &slits}) b->source.direction = GaussianDirection{3e-3, 3e-3};
    EXPECT_EQ(detected(channel), detected(slits));
    EXPECT_LT(detected(channel), 0.5);
    EXPECT_GT(detected(channel), 0.001);
  }
}

TEST(Bore, OfAFieldWithAnOffsetIsAWallAboutItsCentre) {
  UniformField field{0.2, 1e-3, Bore{1.2e-3}};
  field.offset = {0.5e-3, 0};
  expect_area(parallel({place("B", 0.5, field)}), [](double s) { return pi * 1.2 * 1.2 * s * s; });
}

TEST(Bore, OfAFieldThatTurnsThePathIsTheSameWall) {
  // A field without effect on the path to speak of, but stepped: the wall is asked about at every step.
  UniformField field{0.2, 1e-11, Bore{1.2e-3}};
  field.offset = {0.5e-3, 0};
  field.direction = {1, 0, 0};
  Beamline b = parallel({place("B", 0.5, field)});
  const double straight = detected(b);
  b.law = DoradoLaw{Closure::larmor, 1};
  EXPECT_NEAR(detected(b), straight, 1e-4);
}

TEST(TwoSlits, CastATrapezoidOfUmbraAndPenumbra) {
  // B4: source w1, collimator w2, a = 0.5 m to the collimator, b = 1 m on: half-top |w2 (1 + r) - w1 r|/2,
  // half-base (w2 (1 + r) + w1 r)/2, r = b/a.
  const double w1 = 1e-3, w2 = 0.4e-3, r = 2;
  Beamline b = parallel({place("S", 0.5, Slit{Rectangle{w2, 1e-6}, {}})});
  b.source.opening = Rectangle{w1, 1e-6};
  b.source.direction = AimedDirection{"S"};
  constexpr int bins = 200;
  b.parts.back() = place("screen", 1.5, Detector{Rectangle{4e-3, 1}, {bins, 1}, {}});
  b.particles = 20000000;
  const DetectorResult d = run_points({b}).detectors.at(0);
  const auto expected = [&](double scale) {
    const double w = scale * w2, top = std::abs(w * (1 + r) - w1 * r) / 2, base = (w * (1 + r) + w1 * r) / 2;
    std::vector<double> counts(bins);
    for (int i = 0; i < bins; ++i) {
      for (int k = 0; k < 10; ++k) {
        const double x = std::abs(4e-3 * ((i + (k + 0.5) / 10) / bins - 0.5));
        counts[static_cast<std::size_t>(i)] += std::clamp((base - x) / (base - top), 0.0, 1.0) / (base + top);
      }
      counts[static_cast<std::size_t>(i)] *= 2e7 * 4e-3 / bins / 10;
    }
    return counts;
  };
  const auto chi_square = [&](double scale) {
    double sum = 0;
    const std::vector<double> model = expected(scale);
    for (std::size_t i = 0; i < bins; ++i)
      if (model[i] > 20) sum += std::pow(d.counts_x[i] - model[i], 2) / model[i];
    return sum;
  };
  EXPECT_LT(chi_square(1), 200 + 4 * std::sqrt(2 * 200.0));
  EXPECT_GT(chi_square(1.01), 1000);
}

/// Where another field overlaps a weak magnet, levels stay coherent and atoms fly straight; point spins go in
/// steps. Both, and atoms in a magnet that sorts them, touch the same poles, a round wire in its middle too.
TEST(OverlappedMagnet, StopsAtomsThatItDoesNotSortAtItsPolesAsItStopsPointSpins) {
  GradientMagnet narrow = gradient_magnet(0.1, 1e-4, 1e-3);
  narrow.gap = Rectangle{1e-3, 1.5e-3};
  narrow.offset = {0.2e-3, -0.1e-3};
  TwoWireMagnet wires;
  wires.length = 0.4;
  wires.half_distance = 0.8e-3;
  wires.wire_radius = 0.6e-3;
  wires.strength = FieldAtBeam{1e-6};
  const auto let_through = [](const Part& magnet, const char* species, bool overlapped) {
    Beamline b = atoms(species, 600, UnpolarisedSpin{});
    b.source.opening = Rectangle{2e-3, 2e-3};
    b.source.direction = BoxDirection{1e-3, 1e-3};
    b.particles = 20000;
    b.parts = {place("M", 0.2, magnet), wide_screen(1)};
    if (overlapped) b.parts.insert(b.parts.begin(), place("F", 0.1, UniformField{0.6, 1e-6, {}}));
    return run_points({b}).detectors.at(0).detected.at(0);
  };
  for (const Part& magnet : {Part{narrow}, Part{wires}}) {
    const double atom = let_through(magnet, "K-39 atom", true),
                 alone = let_through(magnet, "K-39 atom", false);
    EXPECT_GT(atom, 0.1);
    EXPECT_LT(atom, 0.9);
    // Steps and the places where a straight path is looked at miss what only grazes a wire.
    EXPECT_NEAR(atom, let_through(magnet, "neutron", true), 2e-3);
    EXPECT_NEAR(atom, alone, 2e-3);
  }
}

}  // namespace
}  // namespace rabiline::test::apertures_test
