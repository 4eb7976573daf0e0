// Spins in every kind of field of a straight flight, against closed forms and an independent integration.
#include <gtest/gtest.h>

#include <cmath>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/independent_spin.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::spin_fields_test {
namespace {

constexpr double deg = pi / 180;
constexpr double speed = 1000;
constexpr double begin = 0.3, length = 0.2, stay = length / speed;

/// Neutrons of one speed through these parts, spin S along -z or mixed, to a wide detector.
Beamline line(std::vector<PlacedPart> parts, const Law& law = ClassicalLaw{}, bool polarised = true) {
  Beamline b = suggested(0);
  b.law = law;
  b.source.speed = SingleSpeed{speed};
  b.chamber.reset();
  b.particles = 64;
  b.parts.clear();
  if (polarised) b.parts.push_back(place("P", 0.1, Polarizer{0.05, 1e-3, 1, {}}));
  for (PlacedPart& part : parts) b.parts.push_back(std::move(part));
  b.parts.push_back(place("screen", 1.2, Detector{Rectangle{1, 1}, {1, 1}, {}}));
  return b;
}
double final_sz(const Beamline& b) { return 2 * run_points({b}).detectors.at(0).levels.at(0) - 1; }
double detected(const Beamline& b) { return run_points({b}).detectors.at(0).detected.at(0); }

UniformField along(const UnitVector& direction, double field, double l = length) {
  UniformField part{l, field, {}};
  part.direction = direction;
  return part;
}
RotatingField rotating(double amplitude, double frequency) {
  RotatingField part;
  part.length = length;
  part.amplitude = amplitude;
  part.frequency = frequency;
  part.sense = Sense::co;
  return part;
}
OscillatingField oscillating(double amplitude, double frequency, Approximation approximation) {
  OscillatingField part;
  part.length = length;
  part.amplitude = amplitude;
  part.frequency = frequency;
  part.approximation = approximation;
  return part;
}

/// What the program gives against the integration of a neutron's spin, S = -z at the field's begin.
void expect_integrated(const Beamline& b, const std::function<FieldInTime(double scale)>& field,
                       double tolerance, const char* what) {
  const auto reference = [&](double scale) {
    return spin_after(gamma_n, field(scale), begin / speed, begin / speed + stay, {0, 0, -1})[2];
  };
  expect_agreement(final_sz(b), reference, tolerance, what);
}

TEST(UniformField, AcrossTheSpinTurnsItByTheLarmorAngle) {
  const double field = 2e-6;
  for (const UnitVector& direction : {UnitVector{1, 0, 0}, UnitVector{0, 1, 0}, UnitVector{0, -1, 0}})
    expect_agreement(
        final_sz(line({place("B", begin, along(direction, field))})),
        [&](double s) { return -std::cos(s * gamma_n * field * stay); }, 4e-12, "field");
}

TEST(UniformField, TiltedByAnAngleKeepsTheSpinsPartAlongIt) {
  // Far more turns than one, with speeds spread: the mean spin is its part along the field, cos^2(tilt).
  UniformField part = along({}, 5e-3);
  part.tilt.x = 30 * deg;
  Beamline b = line({place("B", begin, part)});
  b.source.speed = GaussianSpeed{speed, 50};
  b.particles = 100000;
  expect_agreement(
      final_sz(b), [&](double s) { return -std::pow(std::cos(s * 30 * deg), 2); },
      4 * 0.25 / std::sqrt(200000), "tilt");
}

TEST(Coil, TurnsSpinsByItsAngleAtItsSpeedAndFasterOnesByLess) {
  Coil coil;
  coil.length = 0.1;
  coil.axis = {1, 0, 0};
  coil.angle = 70 * deg;
  coil.speed = speed;
  Beamline b = line({place("C", begin, coil)});
  EXPECT_NEAR(final_sz(b), -std::cos(70 * deg), 4e-12);
  b.source.speed = SingleSpeed{2 * speed};
  EXPECT_NEAR(final_sz(b), -std::cos(35 * deg), 4e-12);
}

TEST(Coil, TurnsRightHandedWhateverTheSignOfGamma) {
  // Two quarter turns about x, then about z, then back about y take z to z; the wrong sense would not.
  for (const double gamma : {gamma_n, -gamma_n}) {
    Coil x{0.1, {1, 0, 0}, 90 * deg, speed, {}, {}, {}}, z = x, y = x;
    z.axis = {0, 0, 1};
    y.axis = {0, 1, 0};
    z.angle = 30 * deg;
    Beamline b = line({place("X", 0.3, x), place("Z", 0.45, z), place("Y", 0.6, y)});
    b.species[0].species.gyromagnetic_ratio = gamma;
    // From S = s z: about x right-handed to -s y, about z by 30 deg to s (1/2 x - cos 30 y), about y by 90
    // deg x goes to -z.
    const double s = gamma < 0 ? -1 : 1;
    EXPECT_NEAR(final_sz(b), -s / 2, 4e-12);
  }
}

TEST(RotatingField, WithATwistIsResonantForTheFrequencyThatAParticleSees) {
  // S5, Millman 1939: w_res = w0 + sgn(gamma) twist v/l for a right-handed twist.
  const double field = 1e-3, w1 = pi / stay, w0 = -gamma_n * field;
  for (const double twist : {90 * deg, -200 * deg}) {
    RotatingField part = rotating(w1 / -gamma_n, 0);
    part.twist = twist;
    const auto at = [&](double omega) {
      part.frequency = omega / two_pi;
      return final_sz(line({place("B", begin, along({}, field)), place("H0", begin, part)}));
    };
    EXPECT_NEAR(at(w0 - twist / stay), 1, 1e-9);
    expect_agreement(
        at(w0 + 2000),
        [&](double s) {
          const double delta = 2000 + s * twist / stay, rate = std::hypot(delta, w1);
          return 2 * std::pow(w1 / rate * std::sin(rate * stay / 2), 2) - 1;
        },
        1e-9, "twist");
  }
}

TEST(RotatingField, OfAnyProfileAgreesWithTheIntegration) {
  const double field = 1e-3, amplitude = 0.8 * pi / stay / -gamma_n, frequency = 30e3;
  for (const DriveProfile& profile :
       {DriveProfile{HalfSineProfile{}}, DriveProfile{GaussianProfile{30e-3}}}) {
    RotatingField part = rotating(amplitude, frequency);
    part.profile = profile;
    part.phase = {Phase::Kind::angle, 0.7};
    const bool gaussian = std::holds_alternative<GaussianProfile>(profile);
    expect_integrated(
        line({place("B", begin, along({}, field)), place("H0", begin, part)}),
        [&](double s) -> FieldInTime {
          return [=](double t) -> Vec {
            const double y = speed * t - begin, off = (y - length / 2) / 30e-3;
            const double size =
                s * amplitude * (gaussian ? std::exp(-off * off / 2) : std::sin(pi * y / length));
            const double angle = two_pi * frequency * t + 0.7;
            return {size * std::cos(angle), size * std::sin(angle), field};
          };
        },
        2e-8, gaussian ? "gaussian" : "half sine");
  }
}

TEST(RotatingField, OfHalfSineProfileOnResonanceTurnsByItsArea) {
  const double field = 1e-3, angle = 1.1;
  RotatingField part = rotating(angle * pi / 2 / stay / -gamma_n, -gamma_n * field / two_pi);
  part.profile = HalfSineProfile{};
  expect_agreement(
      final_sz(line({place("B", begin, along({}, field)), place("H0", begin, part)})),
      [&](double s) { return -std::cos(s * angle); }, 1e-8, "area");
}

TEST(RotatingField, TiltedOutOfTheStaticFieldsPlaneAgreesWithTheIntegration) {
  const double field = 0.4e-3, amplitude = 20e-6, frequency = 11e3;
  RotatingField part = rotating(amplitude, frequency);
  part.tilt.x = 25 * deg;
  part.phase = {Phase::Kind::angle, 0.3};
  expect_integrated(
      line({place("B", begin, along({0, 0.6, 0.8}, field)), place("H0", begin, part)}),
      [&](double s) -> FieldInTime {
        return [=](double t) -> Vec {
          const double angle = two_pi * frequency * t + 0.3, c = std::cos(angle), w = std::sin(angle);
          return {amplitude * c, 0.6 * field + amplitude * w * std::cos(s * 25 * deg),
                  0.8 * field + amplitude * w * std::sin(s * 25 * deg)};
        };
      },
      1e-6, "tilt");
}

TEST(FieldsThatAreTiltedTogether, DoWhatTheyDoUpright) {
  // Everything turned about the beam, the detector's axis by a filter: the same transmission.
  const auto transmitted = [](double tilt) {
    Polarizer p{0.05, 1e-3, 1, {}};
    UniformField b = along({}, 1e-3);
    RotatingField h0 = rotating(0.6 * pi / stay / -gamma_n, 29.3e3);
    SpinFilter analyser{{}, 1, 0, {}};
    p.tilt.y = b.tilt.y = h0.tilt.y = analyser.tilt.y = tilt;
    return detected(
        line({place("A", 0.15, p), place("B", begin, b), place("H0", begin, h0), place("F", 0.8, analyser)},
             QuantumLaw{}, false));
  };
  EXPECT_GT(transmitted(0), 0.1);
  EXPECT_NEAR(transmitted(50 * deg), transmitted(0), 1e-9);
}

TEST(OscillatingField, InTheRotatingWaveIsAFieldOfHalfTheSizeThatTurnsWithThePrecession) {
  const double field = 1e-3, w1 = 0.7 * pi / stay, f = -gamma_n * field / two_pi + 1200;
  for (const double sign : {1.0, -1.0}) {  // the precession turns round with the field
    expect_agreement(
        final_sz(line({place("B", begin, along({}, sign * field)),
                       place("RF", begin, oscillating(2 * w1 / -gamma_n, f, Approximation::rotating_wave))})),
        [&](double s) {
          const double rate = std::hypot(s * w1, two_pi * 1200);
          return 2 * std::pow(s * w1 / rate * std::sin(rate * stay / 2), 2) - 1;
        },
        1e-9, "amplitude");
  }
}

TEST(OscillatingField, InATiltedFieldActsWithItsPartAcrossIt) {
  const double field = 1e-3, w1 = 0.4 * pi / stay, f = -gamma_n * field / two_pi;
  Polarizer p{0.05, 1e-3, 1, {}};
  p.tilt.y = 40 * deg;
  const UnitVector tilted{std::sin(40 * deg), 0, std::cos(40 * deg)};
  OscillatingField rf = oscillating(2 * w1 / -gamma_n, f, Approximation::rotating_wave);
  const double transmitted =
      detected(line({place("A", 0.15, p), place("B", begin, along(tilted, field)), place("RF", begin, rf),
                     place("F", 0.8, SpinFilter{tilted, 1, 0, {}})},
                    QuantumLaw{}, false));
  // On resonance the flip is sin^2(w1 cos(40 deg) t/2): the axis x stands at 50 deg to the field.
  expect_agreement(
      transmitted, [&](double s) { return std::pow(std::sin(w1 * std::cos(s * 40 * deg) * stay / 2), 2); },
      1e-9, "tilt");
}

TEST(OscillatingField, AsAWholeAgreesWithTheIntegration) {
  const double field = 0.2e-3, amplitude = 60e-6, frequency = 6e3;
  OscillatingField part = oscillating(amplitude, frequency, Approximation::none);
  part.phase = {Phase::Kind::angle, 1.1};
  expect_integrated(
      line({place("B", begin, along({}, field)), place("RF", begin, part)}),
      [&](double s) -> FieldInTime {
        return [=](double t) -> Vec {
          return {s * amplitude * std::cos(two_pi * frequency * t + 1.1), 0, field};
        };
      },
      1e-6, "whole field");
}

TEST(OscillatingField, AsAWholeIsResonantAtTheBlochSiegertShift) {
  // S4: the time-averaged flip is largest at w_res/w0 = 1 + r^2/4, r = w1/w0 of one turning half. r = 0.2:
  // 1.01. Broad speeds average over time; a curve about its maximum is even.
  const double field = 2e-3, w0 = -gamma_n * field, r = 0.2;
  const auto mean_flip = [&](double ratio) {
    OscillatingField part = oscillating(2 * r * field, ratio * w0 / two_pi, Approximation::none);
    part.phase = {Phase::Kind::random, 0};
    Beamline b = line({place("B", begin, along({}, field)), place("RF", begin, part)});
    b.source.speed = GaussianSpeed{600, 150};
    b.particles = 4096;
    return (1 + final_sz(b)) / 2;
  };
  const auto odd_part = [&](double centre) { return mean_flip(centre + 0.04) - mean_flip(centre - 0.04); };
  EXPECT_NEAR(odd_part(1.01), 0, 0.004);
  EXPECT_GT(odd_part(1.0), 0.01);
}

TEST(GuideField, CarriesTheSpinAsTheIntegrationSays) {
  const double field = 20e-6;
  expect_integrated(
      line({place("G", begin, GuideField{length, field, {0, 0, 1}, {1, 0, 0}, {}})}),
      [&](double s) -> FieldInTime {
        return [=](double t) -> Vec {
          const double angle = pi / 2 * (speed * t - begin) / length;
          return {s * field * std::sin(angle), 0, s * field * std::cos(angle)};
        };
      },
      1e-9, "guide");
}

TEST(GuideField, ThatTurnsSlowlyTakesTheSpinAlong) {
  // Adiabatic: the part of the spin along the field is kept up to (turning/precession)^2.
  const GuideField guide{length, 2e-3, {0, 0, 1}, {1, 0, 0}, {}};
  const double turning = pi / 2 / stay, precession = -gamma_n * 2e-3;
  const double lost =
      1 -
      detected(line({place("G", begin, guide), place("F", 0.8, SpinFilter{UnitVector{-1, 0, 0}, 1, 0, {}})},
                    QuantumLaw{}));
  EXPECT_LT(lost, std::pow(turning / precession, 2));
}

TEST(GuideField, ThatDoesNotTurnIsAUniformField) {
  Beamline b = line({place("G", begin, GuideField{length, 2e-6, {1, 0, 0}, {1, 0, 0}, {}})});
  EXPECT_NEAR(final_sz(b), -std::cos(gamma_n * 2e-6 * stay), 4e-12);
}

TEST(SpinFilter, PassesHalfOfAnUnpolarisedBeamAndMalusLawOfTheRest) {
  Beamline b = line({place("F1", 0.2, SpinFilter{UnitVector{0, 0, 1}, 1, 0, {}}),
                     place("F2", 0.6, SpinFilter{UnitVector{std::sin(1.0), 0, std::cos(1.0)}, 1, 0, {}})},
                    QuantumLaw{}, false);
  b.particles = 2000000;
  expect_agreement(
      detected(b), [](double s) { return 0.5 * std::pow(std::cos(s * 0.5), 2); }, 4 * 0.385 / std::sqrt(2e6),
      "angle");
}

TEST(SpinFilter, OfPartialTransmissionKeepsTheRootOfTheProductOfCoherence) {
  // S along x: w = (up + down)/2 passes, and S_x = sqrt(up down)/w is left: an analyser along x tells.
  const Beamline b = line({place("F", 0.2, SpinFilter{UnitVector{1, 0, 0}, 1, 0, {}}),
                           place("G", 0.4, SpinFilter{UnitVector{0, 0, 1}, 0.8, 0.2, {}}),
                           place("H", 0.6, SpinFilter{UnitVector{1, 0, 0}, 1, 0, {}})},
                          QuantumLaw{});
  expect_agreement(
      detected(b), [](double s) { return 0.5 * (0.5 * (0.8 + 0.2) + std::sqrt(0.8 * 0.2 * s)) / 2; }, 1e-11,
      "coherence");
}

TEST(SpinFilter, OfNoTransmissionStopsEverythingAndOfFullTransmissionNothing) {
  EXPECT_EQ(detected(line({place("F", 0.2, SpinFilter{UnitVector{0, 0, 1}, 0, 0, {}})}, QuantumLaw{})), 0);
  EXPECT_EQ(detected(line({place("F", 0.2, SpinFilter{UnitVector{0.6, 0, 0.8}, 1, 1, {}})}, QuantumLaw{})),
            1);
}

TEST(SpinFilter, GivesTheSameForAVectorOfEverySpinLaw) {
  const std::vector<PlacedPart> parts{place("C", 0.3, Coil{0.1, {1, 0, 0}, 0.8, speed, {}, {}, {}}),
                                      place("F", 0.5, SpinFilter{UnitVector{0, 0.6, 0.8}, 0.9, 0.1, {}}),
                                      place("D", 0.6, Coil{0.1, {0, 1, 0}, 0.5, speed, {}, {}, {}})};
  const Beamline quantum = line(parts, QuantumLaw{}), classical = line(parts, ClassicalLaw{});
  EXPECT_NEAR(detected(quantum), detected(classical), 1e-11);
  EXPECT_NEAR(final_sz(quantum), final_sz(classical), 1e-9);
}

TEST(FieldAcrossTheBeam, TurnsTheVelocityAboutItUnderClosureLarmor) {
  // D1: a neutron of 1000 m/s crossing 1 mT circles with R = v/(gamma B) = 5.457 mm; W = -gamma B along +x
  // turns +y towards +z.
  Beamline b = line({place("B", begin, along({1, 0, 0}, 1e-3, 2e-3))}, DoradoLaw{Closure::larmor, 1}, false);
  b.parts.back() = place("screen", begin + 2e-3 + 0.1, Detector{Rectangle{1, 1}, {1, 2000}, {}});
  b.source.opening = Disc{0};
  const Result r = run_points({b});
  const auto& detector = r.detectors.at(0);
  double mean = 0, sum = 0;
  for (std::size_t i = 0; i < 2000; ++i) {
    mean += detector.counts_z[i] * (detector.z.edges[i] + detector.z.edges[i + 1]) / 2;
    sum += detector.counts_z[i];
  }
  const auto expected = [](double s) {
    const double radius = speed / (s * -gamma_n * 1e-3), sine = 2e-3 / radius,
                 cosine = std::sqrt(1 - sine * sine);
    return radius * (1 - cosine) + 0.1 * sine / cosine;
  };
  EXPECT_NEAR(expected(1), 0.1 * 0.394 + 0.0004, 0.004);
  EXPECT_NEAR(mean / sum, expected(1), 2.6e-4) << "half a bin";
  EXPECT_GT(std::abs(mean / sum - expected(1.01)), 2.6e-4);
}

}  // namespace
}  // namespace rabiline::test::spin_fields_test
