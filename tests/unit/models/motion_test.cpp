#include "models/motion.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "models/model.hpp"
#include "unit/models/findings.hpp"

namespace rabiline::motion_test {
namespace {

using test::finding;

TEST(FindingsOf, HaveWhatAnyPointHasAndSayNaNWhereOneLacksIt) {
  ModelResult first, second;
  first.findings = {{"drift", "1", "of the energy", Expectation::conserved, 1e-15, 0}};
  second.findings = {{"radius", "m", "of the path", Expectation::supposed, 2.5, 3},
                     {"drift", "1", "of the energy", Expectation::conserved, 3e-15, 0}};
  const std::vector<FoundAtPoints> found = findings_of({first, second});
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].name, "drift");
  EXPECT_EQ(found[0].values, (std::vector<double>{1e-15, 3e-15}));
  EXPECT_EQ(found[1].name, "radius");
  EXPECT_EQ(found[1].unit, "m");
  EXPECT_TRUE(std::isnan(found[1].values[0]) && std::isnan(found[1].expected[0]));
  EXPECT_EQ(found[1].values[1], 2.5);
  EXPECT_EQ(found[1].expected[1], 3);
}

TEST(FindingsOf, ExpectOfAScanWhatHoldsAtEveryPoint) {
  ModelResult sure, unsure;
  sure.findings = {{"precession", "Hz", "", Expectation::closed_form, 1, 1}};
  unsure.findings = {{"precession", "Hz", "", Expectation::approximate, 1, 1}};
  EXPECT_EQ(findings_of({sure, unsure}).front().expectation, Expectation::approximate);
  EXPECT_EQ(findings_of({unsure, sure}).front().expectation, Expectation::approximate);
  EXPECT_EQ(findings_of({sure, sure}).front().expectation, Expectation::closed_form);
}

TEST(Expectations, TellWhatThePaperSupposesFromWhatTheEquationsGive) {
  RotatingCylinder cylinder{1, 0.05, 0.2, 100, 2, BodyFixedTorque{0.5}, AxisStart::at_rest, 1, 101};
  const ModelResult nodding = solve(cylinder);
  for (const char* name : {"fast_top", "path_distance", "axis_distance", "radius", "growth", "spin_drift",
                           "torque_along_axis", "p_theta_drift_euler", "hamiltonian_drift_euler"})
    EXPECT_EQ(word_of(finding(nodding, name).expectation), "supposed") << name;
  for (const char* name :
       {"speed_drift", "energy_balance", "angular_momentum_balance", "p_theta_drift_paper"})
    EXPECT_EQ(word_of(finding(nodding, name).expectation), "conserved") << name;
  EXPECT_EQ(word_of(finding(nodding, "tilt").expectation), "closed_form");
  EXPECT_EQ(word_of(finding(nodding, "precession").expectation), "closed_form");
  cylinder.axis_start = AxisStart::precessing;
  EXPECT_EQ(word_of(finding(solve(cylinder), "precession").expectation), "closed_form");
  cylinder.torque = SpaceFixedTorque{0.5};
  EXPECT_EQ(word_of(finding(solve(cylinder), "precession").expectation), "approximate");
  EXPECT_EQ(test::find(solve(cylinder), "p_theta_drift_paper"), nullptr);  // no circle
}

TEST(Expectations, OfABoundChargeAreRightToSomeOrder) {
  BoundCharge charge;
  charge.species = {{*find_species("electron"), 1}};
  charge.field = 0.01;
  charge.binding = HarmonicBinding{1e12, 1e-9};
  charge.inclination = 0.7;
  charge.orbits = 10;
  charge.samples = 11;
  const ModelResult result = solve(charge);
  for (const char* name :
       {"precession", "second_order", "over_cyclotron", "eq74_over_precession", "mean_torque"})
    EXPECT_EQ(word_of(finding(result, name).expectation), "approximate") << name;
  EXPECT_EQ(word_of(finding(result, "closed_form").expectation), "closed_form");
  EXPECT_EQ(word_of(finding(result, "energy_drift").expectation), "conserved");
}

}  // namespace
}  // namespace rabiline::motion_test
