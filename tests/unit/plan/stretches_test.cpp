// Whether levels stay coherent in fields that differ from place to place.
#include "plan/stretches.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "beamline/experiment.hpp"
#include "physics/atoms.hpp"
#include "plan/explain.hpp"
#include "plan/plan.hpp"
#include "rules/part_effects.hpp"

namespace rabiline::stretches_test {
namespace {

using test::place;

Tally tally_of(Quantity quantity, double half, std::uint64_t bins) {
  TallyAxis axis;
  axis.quantity = quantity;
  axis.from = AxisEnd{-half};
  axis.to = AxisEnd{half};
  axis.bins = bins;
  return {"t", {axis}};
}
/// Neutrons from a point through a quadrupole on a field, 0.2 m to 0.7 m, onto a screen of one bin, 1 m wide.
Beamline neutrons() {
  Beamline b = test::suggested(0);
  b.law = QuantumLaw{};
  b.species = {{test::neutron(), 1}};
  b.source.speed = SingleSpeed{600};
  b.source.opening = Disc{0};
  b.chamber.reset();
  UniformField field;
  field.length = 0.5;
  field.field = 1;
  field.gradient.quadrupole = 50;
  b.parts = {place("A", 0.2, field), test::wide_screen(0.8)};
  return b;
}
StretchOutlook outlook(const Beamline& b) {
  const std::vector<Stretch> all = stretches_of(b, b.species.front().species, sections_of(b));
  return all.empty() ? StretchOutlook{} : all.front().outlook;
}
Beamline with_tally(Quantity quantity, double half, std::uint64_t bins) {
  Beamline b = neutrons();
  std::get<Detector>(b.parts.back().part).tallies = {tally_of(quantity, half, bins)};
  return b;
}

TEST(Stretches, AreJudgedByTheBinsOfTallies) {
  EXPECT_NEAR(outlook(neutrons()).feature, 1, 1e-12);
  EXPECT_FALSE(outlook(neutrons()).sorts);
  for (const Quantity quantity : {Quantity::x, Quantity::z}) {
    const StretchOutlook found = outlook(with_tally(quantity, 2e-3, 400));
    EXPECT_NEAR(found.feature, 10e-6, 1e-12);
    EXPECT_TRUE(found.sorts);
  }
  // Bins of 0.1 mrad, 0.35 m behind the middle of the field.
  for (const Quantity quantity : {Quantity::angle_x, Quantity::angle_z, Quantity::angle})
    EXPECT_NEAR(outlook(with_tally(quantity, 5e-3, 100)).feature, 35e-6, 1e-12);
  EXPECT_NEAR(outlook(with_tally(Quantity::speed, 5, 1000)).feature, 1, 1e-12);
}

TEST(Stretches, AreJudgedByWhatMonitorsTally) {
  Beamline b = neutrons();
  Monitor monitor;
  monitor.face = Rectangle{1, 1};
  b.parts.insert(b.parts.begin() + 1, place("M", 0.75, monitor));
  EXPECT_NEAR(outlook(b).feature, 1, 1e-12);  // its face stops nothing
  std::get<Monitor>(b.parts[1].part).tallies = {tally_of(Quantity::z, 2e-3, 400)};
  EXPECT_NEAR(outlook(b).feature, 10e-6, 1e-12);
  b.parts[1].placement.at = 0.1;
  EXPECT_NEAR(outlook(b).feature, 1, 1e-12);  // nothing has come apart there
}

// A beam 4 cm high in a gradient across its width: |B| grows along its height in second order alone.
TEST(Stretches, AreJudgedByHowFarTheFieldSpreadsPhasesOverTheBeam) {
  constexpr double half = 0.02, field = 10e-3, gradient = 0.075, length = 1.9, speed = 791.2;
  Beamline b = neutrons();
  b.source.speed = SingleSpeed{speed};
  b.source.opening = Rectangle{0, 2 * half};
  UniformField guide{length, field, {}};
  guide.gradient.transverse = gradient;
  b.parts = {place("A", 0.1, guide), test::wide_screen(2.2)};
  const double turns = std::abs(test::gamma_n) / test::two_pi * length / speed;
  EXPECT_NEAR(outlook(b).turns, turns * (std::hypot(field, gradient * half) - field),
              1e-6 * outlook(b).turns);
  guide.gradient = {0, 0, gradient};  // along the height of what a slit lets through
  b.parts = {place("slit", 0.05, Slit{Rectangle{1e-3, 50e-6}, {}}), place("A", 0.1, guide),
             test::wide_screen(2.2)};
  EXPECT_NEAR(outlook(b).turns, turns * gradient * 25e-6, 1e-6 * outlook(b).turns);
  EXPECT_NEAR(outlook(b).feature, 50e-6, 1e-12);
}

TEST(Stretches, AreJudgedByTheSpotOfTheBeam) {
  const auto feature = [](const SourceOpening& opening) {
    Beamline b = neutrons();
    b.source.opening = opening;
    return outlook(b).feature;
  };
  EXPECT_NEAR(feature(Disc{10e-6}), 20e-6, 1e-12);
  EXPECT_NEAR(feature(Rectangle{30e-6, 2e-3}), 30e-6, 1e-12);
  EXPECT_NEAR(feature(Rectangle{0, 2e-3}), 2e-3, 1e-12);
  EXPECT_NEAR(feature(Ring{100e-6, 140e-6}), 40e-6, 1e-12);
  EXPECT_NEAR(feature(GaussianSpot{3e-3, 50e-6}), 50e-6, 1e-12);
  EXPECT_NEAR(feature(Disc{1e-6}), 1, 1e-12);  // a pencil
}

/// Potassium through a uniform field with a weak gradient.
Beamline potassium(double gradient) {
  Beamline b = test::atoms("K-39 atom", 600, test::in_level(2, 2));
  UniformField field;
  field.length = 0.2;
  field.field = 1e-3;

  field.gradient.quadrupole = gradient;
  b.source.opening = Disc{1e-3};
  b.parts = {place("C", 0.1, field), test::wide_screen(0.8)};
  return b;
}
std::string explained(const Beamline& b) {
  Experiment e;
  e.points.push_back(b);
  return explain(e, make_plan(e));
}

TEST(Stretches, ThroughWhichAtomsFlyStraightAreToldAndMoveNothing) {
  const Beamline coherent = potassium(1e-3), sorted = potassium(100);
  EXPECT_NE(explained(coherent).find(
                "levels stay coherent, and atoms fly straight here: their paths come apart by "),
            std::string::npos);
  EXPECT_NE(explained(coherent).find("(smallest slit, bin or spot 2 mm)"), std::string::npos);
  EXPECT_EQ(report_of_parts(coherent),
            "what the fields do\n  C                uniform_field    turns spins\n");
  EXPECT_EQ(explained(sorted).find("fly straight"), std::string::npos);
  EXPECT_NE(report_of_parts(sorted).find("turns spins and moves particles"), std::string::npos);
  Beamline magnet = coherent;  // alone it draws levels
  magnet.parts[0] = place("M", 0.1, test::gradient_magnet(0.2, 1e-3, 1e-3));
  EXPECT_NE(report_of_parts(magnet).find("turns spins and moves particles"), std::string::npos);
  // A point is pushed by its coherent moment.
  EXPECT_NE(report_of_parts(neutrons()).find("turns spins and moves particles"), std::string::npos);
}

TEST(Stretches, AreWhereTheBeamIs) {
  Beamline on_axis = with_tally(Quantity::z, 2e-3, 400);
  std::get<UniformField>(on_axis.parts[0].part).field = 0;
  std::get<UniformField>(on_axis.parts[0].part).gradient = {};
  MultipoleField sextupole;
  sextupole.poles = 6;
  sextupole.length = 0.5;
  sextupole.field = 0.05;
  sextupole.radius = 6e-3;
  on_axis.parts.push_back(place("S", 0.2, sextupole));
  Beamline source_beside = on_axis, field_beside = on_axis, aslant = on_axis;
  source_beside.source.offset = {1e-3, -2e-3};
  std::get<MultipoleField>(field_beside.parts.back().part).offset = {-1e-3, 2e-3};
  aslant.source.tilt.x = -std::atan(2e-3 / 0.45);  // in the middle of the field 2 mm below the axis
  aslant.source.tilt.z = -std::atan(1e-3 / 0.45) * std::cos(aslant.source.tilt.x);
  EXPECT_LT(outlook(on_axis).splitting, 1e-12);
  EXPECT_GT(outlook(source_beside).splitting, 1e-6);
  EXPECT_NEAR(outlook(source_beside).splitting / outlook(field_beside).splitting, 1, 1e-9);
  EXPECT_NEAR(outlook(aslant).splitting / outlook(field_beside).splitting, 1, 1e-4);
}

}  // namespace
}  // namespace rabiline::stretches_test
