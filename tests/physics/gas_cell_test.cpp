// Gas along the beam: the law of Lambert and Beer along the slant path, with whole quanta.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::gas_cell_test {
namespace {

constexpr double length = 0.3, density = 4e19, cross_section = 1e-19;

GasCell cell(const Gas& gas = GasDensity{density}) {
  GasCell part;
  part.length = length;
  part.gas = gas;
  part.cross_section = cross_section;
  return part;
}
/// Neutrons of one direction through a cell to a wide detector.
Beamline through(const GasCell& part, double tilt = 0, const Law& law = ClassicalLaw{}) {
  Beamline b = suggested(0);
  b.law = law;
  b.source.tilt.x = tilt;
  b.chamber.reset();
  b.particles = 1000;
  b.parts = {place("gas", 0.2, part), place("screen", 1.2, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  return b;
}
double detected(const Beamline& b) { return run_points({b}).detectors.at(0).detected.at(0); }
const FateResult& fate(const Result& r, const std::string& word) {
  return *std::find_if(r.fates.begin(), r.fates.end(), [&](const FateResult& f) { return f.fate == word; });
}

TEST(GasCell, LetsTheExponentialOfItsDepthPass) {
  for (const Law& law : {Law{ClassicalLaw{}}, Law{QuantumLaw{}}, Law{DoradoLaw{}}})
    expect_agreement(
        detected(through(cell(), 0, law)),
        [](double scale) { return std::exp(-density * scale * cross_section * length); }, 1e-11, "density");
}

TEST(GasCell, CountsTheSlantPath) {
  const double tilt = 0.6;
  expect_agreement(
      detected(through(cell(), tilt)),
      [&](double scale) { return std::exp(-density * cross_section * length * scale / std::cos(tilt)); },
      1e-11, "length");
}

TEST(GasCell, CountsTheParabola) {
  // Neutrons of 4 m/s thrown up by 0.6 rad: the way from vz to vz - g t is that of a parabola, in closed
  // form.
  const double speed = 4, tilt = 0.6, g = 9.81;
  Beamline b = through(cell(), tilt);
  b.source.speed = SingleSpeed{speed};
  b.gravity = Gravity{g, {0, 0, -1}};
  const double vy = speed * std::cos(tilt);
  const auto way = [&](double vz) {  // of v ds = sqrt(vy^2 + vz^2) dvz/g
    return (vz * std::hypot(vy, vz) + vy * vy * std::asinh(vz / vy)) / (2 * g);
  };
  const auto rise = [&](double y) { return speed * std::sin(tilt) - g * y / vy; };
  expect_agreement(
      detected(b),
      [&](double scale) {
        return std::exp(-density * cross_section * scale * (way(rise(0.2)) - way(rise(0.2 + length))));
      },
      1e-6, "path");
}

TEST(GasCell, TakesTheDensityOfAnIdealGas) {
  const double pressure = 0.2, temperature = 310;
  expect_agreement(
      detected(through(cell(GasPressure{pressure, temperature}))),
      [&](double scale) {
        return std::exp(-pressure / (constants::boltzmann * temperature * scale) * cross_section * length);
      },
      1e-11, "temperature");
}

TEST(GasCell, GivesWhatItScattersAFateOfItsOwnToTheQuantum) {
  const Result r = run_points({through(cell())});
  const FateResult& scattered = fate(r, "scattered");
  EXPECT_EQ(scattered.where, "gas");
  EXPECT_NEAR(scattered.particles.at(0), 1000 * (1 - std::exp(-density * cross_section * length)), 1e-8);
  EXPECT_EQ(scattered.quanta_low.at(0) + fate(r, "detected").quanta_low.at(0), 1000 * quanta_per_particle);
  EXPECT_EQ(scattered.quanta_low.at(0) % 1000, 0U);  // each particle loses the same whole number of quanta
}

TEST(GasCell, EndsWhatHasNoQuantumLeft) {
  GasCell dense = cell();
  dense.cross_section *= 1e3;
  const Result r = run_points({through(dense)});
  EXPECT_EQ(r.detectors.at(0).detected.at(0), 0);
  EXPECT_EQ(fate(r, "scattered").particles.at(0), 1000);
}

TEST(GasCell, StopsAtItsBoreWhatMissesTheGas) {
  GasCell narrow = cell();
  narrow.bore = Bore{1e-9};
  EXPECT_LT(detected(through(narrow)), 1e-3);
}

}  // namespace
}  // namespace rabiline::test::gas_cell_test
