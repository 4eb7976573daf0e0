// What slits, collimators, beam stops and walls let through, against closed forms.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

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

// ---- walls that parabolas meet between two planes ----

/// Neutrons of 5 m/s from an opening of 4 x 4 mm, thrown up by 0.1 rad, through these parts. Their common way
/// has its top at `top`; `reach` before and behind it they are lower by `sagitta`.
struct Thrown {
  static constexpr double speed = 5, angle = 0.1, g = 9.81, reach = 0.1;
  double top = speed * speed * std::sin(angle) * std::cos(angle) / g;
  double sagitta = 0.5 * g * std::pow(reach / (speed * std::cos(angle)), 2);
  double height = 0.5 * std::pow(speed * std::sin(angle), 2) / g - sagitta;

  Beamline beam(std::vector<PlacedPart> parts) const {
    Beamline b = parallel(std::move(parts));
    b.law = ClassicalLaw{};
    b.source.speed = SingleSpeed{speed};
    b.source.tilt.x = angle;
    b.gravity = Gravity{g, {0, 0, -1}};
    b.parts.back().placement.at = 0.4;
    return b;
  }
  Beamline through(const Face& face) const {
    return beam({place("C", top - reach, Collimator{2 * reach, face, {0, height}})});
  }
};
/// Where two circles of one radius overlap.
double lens(double radius, double distance) {
  return 2 * radius * radius * std::acos(distance / (2 * radius)) -
         0.5 * distance * std::sqrt(4 * radius * radius - distance * distance);
}

TEST(Channel, StopsParabolasThatRiseToItsWallAndFallBack) {
  const Thrown thrown;
  const auto expect_overlap = [&](const Face& face, const std::function<double(double sagitta)>& area) {
    Beamline b = thrown.through(face);
    b.particles = 4000000;
    const double p = area(thrown.sagitta * 1e3) / 16;
    expect_agreement(
        detected(b), [&](double s) { return area(s * thrown.sagitta * 1e3) / 16; },
        4 * std::sqrt(p * (1 - p) / 4e6), "sagitta");
  };
  expect_overlap(Rectangle{3e-3, 3e-3}, [](double sagitta) { return 3 * (3 - sagitta); });
  expect_overlap(Disc{1.5e-3}, [](double sagitta) { return lens(1.5, sagitta); });
}

TEST(Channel, PassesWhatAHundredSlitsInItPass) {
  const Thrown thrown;
  Roll roll;
  roll.y = 0.4;
  for (const Face& face : {Face{Rectangle{2e-3, 5e-3}}, Face{Disc{2e-3}}}) {
    for (const UnitVector& down : {UnitVector{0, 0, -1}, UnitVector{0.028, 0, -0.999608}}) {
      const double begin = thrown.top - thrown.reach, length = 2 * thrown.reach;
      const Offset offset{0, thrown.height};
      Collimator channel{length, face, offset};
      if (std::holds_alternative<Rectangle>(face)) channel.tilt = roll;
      std::vector<PlacedPart> slits;
      for (int i = 0; i <= 100; ++i)
        slits.push_back(place("S" + std::to_string(i), begin + length * i / 100,
                              Slit{opening_of(face), offset, channel.tilt}));
      Beamline one = thrown.beam({place("C", begin, channel)}), many = thrown.beam(slits);
      const std::vector<PlacedPart> ends{slits.front(), slits.back()};
      Beamline two = thrown.beam(ends);
      for (Beamline* b : {&one, &two, &many}) {
        b->source.direction = GaussianDirection{10e-3, 5e-3};
        b->gravity->direction = down;
      }
      // What comes out between two slits and back by the next is 1e-4 of the sagitta deep.
      EXPECT_NEAR(detected(one), detected(many), 2e-4);
      EXPECT_GT(detected(two), detected(many) + 0.01);
      EXPECT_GT(detected(one), 0.01);
    }
  }
}

TEST(Chamber, StopsParabolasBetweenThePartsThatAskForIt) {
  // Nothing stands between the source and the screen, and the common way has its top 12.7 mm above the axis.
  const Thrown thrown;
  Beamline b = thrown.beam({});
  b.source.opening = Rectangle{0, 4e-3};
  b.chamber = Chamber{thrown.height + thrown.sagitta + 0.5e-3};
  const double top = (thrown.height + thrown.sagitta) * 1e3;
  expect_agreement(
      detected(b), [&](double s) { return (top + 0.5 - top * s + 2) / 4; },
      4 * std::sqrt(0.625 * 0.375 / 2e5), "top");
}

/// Particles that fly nearly straight, in steps of every kind and length.
struct Course {
  std::string what;
  std::function<void(Beamline&, UniformField&)> bend;
};
std::vector<Course> courses() {
  const auto gravity = [](const UnitVector& along) {
    return [along](Beamline& b, UniformField&) { b.gravity = Gravity{1e-3, along}; };
  };
  const auto dorado = [](Closure closure) {
    return [closure](Beamline& b, UniformField&) { b.law = DoradoLaw{closure, 1}; };
  };
  return {{"straight", [](Beamline&, UniformField&) {}},
          {"falling along the beam", gravity({0, 1, 0})},
          {"falling obliquely", gravity({0.6, 0.8, 0})},
          {"closure torque", dorado(Closure::torque)},
          {"closure larmor", dorado(Closure::larmor)},
          {"in a gradient", [](Beamline&, UniformField& field) { field.gradient.quadrupole = 1e-9; }},
          {"under a profile", [](Beamline&, UniformField& field) { field.profile = HalfSineProfile{}; }}};
}

TEST(DeadArea, IsAPartOfTheFaceOfADetector) {
  // 0.8 x 0.6 mm, 0.5 mm along the face's own x and 0.2 mm along its z, within a beam of 1 mm^2.
  for (const Offset& offset : {Offset{}, Offset{3e-3, -2e-3}})
    for (const double tilt : {0.0, 0.5}) {
      Detector d{Rectangle{10e-3, 10e-3}, {1, 1}, offset};
      d.tilt.y = tilt;
      d.dead = DeadArea{Rectangle{0.8e-3, 0.6e-3}, {0.5e-3, 0.2e-3}};
      Beamline b = parallel({});
      b.parts.back() = place("screen", 1.2, d);
      // The face is turned from +z towards +x.
      const double c = std::cos(tilt), s = std::sin(tilt);
      b.source.opening = Rectangle{1e-3, 1e-3};
      b.source.offset = {offset.x + c * 0.5e-3 + s * 0.2e-3, offset.z + c * 0.2e-3 - s * 0.5e-3};
      expect_agreement(
          detected(b), [](double scale) { return 1 - 0.48 * scale; }, 4 * std::sqrt(0.48 * 0.52 / 2e5),
          "counted beside the dead area");
    }
}

TEST(Bore, StopsWhatMissesItsFrontAndWhatIsOutsideAtItsEndHoweverLongTheSteps) {
  for (const Course& course : courses()) {
    const auto share = [&](double x, double angle, double radius) {
      UniformField field{1, 1e-12, Bore{radius}};
      Beamline b = parallel({});
      b.law = QuantumLaw{};
      b.source.speed = SingleSpeed{30};
      b.source.opening = Rectangle{0, 0};
      b.source.offset = {x, 0};
      b.source.tilt.z = angle;
      course.bend(b, field);
      b.parts = {place("B", 0.1, field), place("screen", 2, Detector{Rectangle{4, 4}, {1, 1}, {}})};
      b.particles = 16;
      return detected(b);
    };
    // From 65 mm towards the axis, and from the axis to 55 mm at the bore's end.
    EXPECT_EQ(share(65e-3, std::atan(0.05), 59.9e-3), 0) << course.what;
    EXPECT_EQ(share(65e-3, std::atan(0.05), 60.1e-3), 1) << course.what;
    EXPECT_EQ(share(0, -std::atan(0.05), 54.9e-3), 0) << course.what;
    EXPECT_EQ(share(0, -std::atan(0.05), 55.1e-3), 1) << course.what;
  }
}

TEST(Bore, StopsPathsThatGrazeItBetweenTwoSteps) {
  // A neutron of 1000 m/s circles with R = 5.457 mm under closure larmor, towards -x: at an angle to the
  // beam it comes farthest to +x inside the field.
  const double radius = 1000 / (-gamma_n * 1e-3), angle = 0.6, way = 1e-3;
  const double farthest = way * std::tan(angle) + radius * (1 - std::cos(angle));
  for (const double gravity : {0.0, 1e-9})  // in closed form, and in steps
    for (const double miss : {-6e-8, 6e-8}) {
      Beamline b = parallel({place("B", way, UniformField{6e-3, 1e-3, Bore{farthest + miss}})});
      b.law = DoradoLaw{Closure::larmor, 1};
      b.source.speed = SingleSpeed{1000};
      b.source.opening = Rectangle{0, 0};
      b.source.tilt.z = -angle;
      if (gravity > 0) b.gravity = Gravity{gravity, {0, 0, -1}};
      b.parts.back() = place("screen", 20e-3, Detector{Rectangle{1, 1}, {1, 1}, {}});
      b.particles = 16;
      EXPECT_EQ(detected(b), miss > 0 ? 1 : 0) << gravity << " " << miss;
    }
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

/// Cold neutrons into a slit 6 mm high, 2 m away: they fall by 2 mm.
Beamline falling(const DirectionLaw& direction, std::uint64_t number) {
  Beamline b = parallel({place("S", 2, Slit{Rectangle{20e-3, 6e-3}, {}})});
  b.source.speed = UniformSpeed{100, 0.1};
  b.source.opening = Disc{1e-3};
  b.source.direction = direction;
  b.gravity = Gravity{9.81, {0, 0, -1}};
  b.parts.back() = place("screen", 2.5, Detector{Rectangle{1, 20e-3}, {1, 40}, {}});
  b.particles = number;
  return b;
}
TEST(AimedSource, InFreeFallGivesWhatStartsInAllDirections) {
  const double half_angle = 0.012, aimed_at = std::pow(std::sin(half_angle), 2);
  const DetectorResult aimed =
                           run_points({falling(AimedDirection{"S", CosineEmission{}}, 200000)}).detectors[0],
                       all = run_points({falling(CosineDirection{half_angle}, 2000000)}).detectors[0];
  const double error = aimed_at * all.detected_errors[0];
  EXPECT_NEAR(aimed.detected_of_all[0], aimed_at * all.detected[0], 4 * error);
  EXPECT_LT(error, 0.004 * aimed.detected_of_all[0]);
  const double sum = std::accumulate(all.counts.begin(), all.counts.end(), 0.0),
               sum_aimed = std::accumulate(aimed.counts.begin(), aimed.counts.end(), 0.0);
  double chi_square = 0;
  int used = 0;
  for (std::size_t i = 0; i < 40; ++i) {
    if (all.counts[i] < 100) continue;
    const double off = aimed.counts[i] / sum_aimed - all.counts[i] / sum;
    chi_square += off * off /
                  (std::pow(aimed.counts_errors[i] / sum_aimed, 2) + std::pow(all.counts_errors[i] / sum, 2));
    ++used;
  }
  EXPECT_GT(used, 15);
  EXPECT_LT(chi_square, used + 4 * std::sqrt(2.0 * used));
}

TEST(AimedSource, KnowsWhatItsWeightsScatterBy) {
  // Everything is detected, and each particle weighs cos^4 of its angle.
  Beamline b = parallel({});
  b.source.direction = AimedDirection{"screen", CosineEmission{}};
  b.source.opening = Disc{1e-9};
  b.parts.back() = place("screen", 20e-3, Detector{Rectangle{60e-3, 20e-3}, {1, 1}, {}});
  b.particles = 200000;
  double mean = 0, square = 0;
  constexpr int places = 400;
  for (int i = 0; i < places; ++i)
    for (int k = 0; k < places; ++k) {
      const double x = 3 * ((i + 0.5) / places - 0.5), z = (k + 0.5) / places - 0.5,
                   weight = std::pow(1 + x * x + z * z, -2);
      mean += weight / (places * places);
      square += weight * weight / (places * places);
    }
  const DetectorResult d = run_points({b}).detectors.at(0);
  const double expected = std::sqrt((square / (mean * mean) - 1) / 200000);
  EXPECT_NEAR(d.detected_of_all_errors[0] / d.detected_of_all[0], expected, 0.005 * expected);
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
