// Fields that drive or align spins, and do not do what they are there for.
#include <gtest/gtest.h>

#include <algorithm>

#include "warned.hpp"

namespace rabiline::drive_warnings_test {
namespace {

using test::place;
using test::standard;
using test::warned;

TEST(Warnings, TellThatNoPointOfAScanIsNearTheResonance) {
  const auto scan = [](double from, double to) {
    std::vector<Beamline> points(5, standard());
    for (std::size_t i = 0; i < points.size(); ++i)
      std::get<RotatingField>(points[i].parts[2].part).frequency =
          from + (to - from) * static_cast<double>(i) / 4;
    return warned(points);
  };
  // Spins precess at 291.6 kHz, and 1/T is 5 kHz.
  EXPECT_TRUE(scan(261.6e3, 321.6e3).empty());  // with a point on either side
  EXPECT_TRUE(scan(230e3, 285e3).empty());
  const std::vector<Fault> faults = scan(230e3, 280e3);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "H0");
  EXPECT_NE(faults[0].message.find("is 11.65 kHz away from the 291.6 kHz"), std::string::npos)
      << faults[0].message;
  EXPECT_TRUE(scan(280e3, 280e3).empty());  // is no scan
}

TEST(Warnings, TellThatAPolarizerHasNoField) {
  Beamline b = standard();
  std::get<Polarizer>(b.parts[0].part).field = 0;
  const std::vector<Fault> faults = warned({b});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "B_prime");
  EXPECT_EQ(faults[0].key, "field");
}

TEST(Warnings, TellThatADriveSwingsAlongTheStaticField) {
  const auto swinging = [](UnitVector direction) {
    Beamline b = standard();
    OscillatingField field;
    field.length = 0.2;
    field.amplitude = 1e-6;
    field.frequency = 291.64e3;
    field.direction = direction;
    b.parts[2] = place("RF", b.parts[2].placement.at, field);
    return warned({b});
  };
  EXPECT_TRUE(swinging({1, 0, 0}).empty());
  const std::vector<Fault> faults = swinging({0, 0, 1});
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "RF");
  EXPECT_EQ(faults[0].key, "direction");
}

TEST(Warnings, TellThatADriveTurnsSpinsRoundAndRound) {
  Beamline b = standard();
  RotatingField& drive = std::get<RotatingField>(b.parts[2].part);
  drive.frequency = 291.64e3;
  const auto with_cycles = [&](double cycles) {  // gamma B1 T/(2 pi), for 0.2 m at 1000 m/s
    drive.amplitude = cycles / (29.1646935e6 * 0.2e-3);
    return warned({b});
  };
  EXPECT_TRUE(with_cycles(99).empty());
  const std::vector<Fault> faults = with_cycles(101);
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_EQ(faults[0].subject, "H0");
  EXPECT_NE(faults[0].message.find("drives 101 Rabi cycles of the spins"), std::string::npos)
      << faults[0].message;
}

TEST(Warnings, TellOfTheRotatingWaveApproximationWhereItIsWorst) {
  Beamline b = standard();
  OscillatingField field;
  field.length = 0.2;
  field.frequency = 291.64e3;
  field.direction = {1, 0, 0};
  field.approximation = Approximation::rotating_wave;
  std::vector<Beamline> points;
  for (const double share : {0.01, 0.2, 0.5, 0.3}) {
    field.amplitude = 2 * share * 10e-3;
    b.parts[2] = place("RF", b.parts[2].placement.at, field);
    points.push_back(b);
  }
  const std::vector<Fault> faults = warned(points);
  const auto poor = std::ranges::find(faults, "approximation", &Fault::key);
  ASSERT_NE(poor, faults.end());
  EXPECT_NE(poor->message.find("is 0.5 of the static field"), std::string::npos) << poor->message;
}

TEST(Warnings, TellThatHalfOfAFieldOfZeroHertzIsLeftOut) {
  Beamline b = standard();
  OscillatingField field;
  field.length = 0.2;
  field.frequency = 0;
  field.amplitude = 1e-6;
  field.direction = {1, 0, 0};
  for (const auto& [approximation, count] :
       {std::pair{Approximation::rotating_wave, 1}, {Approximation::none, 0}}) {
    field.approximation = approximation;
    b.parts[2] = place("RF", b.parts[2].placement.at, field);
    const std::vector<Fault> faults = warned({b});
    EXPECT_EQ(std::ranges::count_if(
                  faults, [](const Fault& f) { return f.message.find("`RF` does not swing") == 0; }),
              count);
  }
}

/// Two rotating fields with a magnet of 1e-9 T/m between them.
TEST(Warnings, TellThatAGradientBetweenTwoDrivesIsNotIntegratedIntoThePhase) {
  Beamline b = standard();
  GradientMagnet magnet;
  magnet.length = 0.04;
  magnet.field = 1e-3;
  magnet.gradient = 1e-9;
  b.parts.insert(b.parts.begin() + 3, place("M", 0.7, magnet));
  EXPECT_TRUE(warned({b}).empty());
  RotatingField second = std::get<RotatingField>(b.parts[2].part);
  b.parts.insert(b.parts.begin() + 4, place("B2", 0.8, UniformField{0.25, 10e-3, {}}));
  b.parts.insert(b.parts.begin() + 5, place("H1", 0.8, second));
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}}) {
    b.law = law;
    const std::vector<Fault> faults = warned({b});
    ASSERT_EQ(faults.size(), 1U);
    EXPECT_EQ(faults[0].subject, "M");
  }
}

}  // namespace
}  // namespace rabiline::drive_warnings_test
