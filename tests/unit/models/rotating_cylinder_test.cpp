#include "models/rotating_cylinder.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/cylinder_motions.hpp"
#include "physics/agreement.hpp"
#include "unit/models/findings.hpp"

namespace rabiline::rotating_cylinder_test {
namespace {

using test::expect_agreement;
using test::finding;

constexpr double pi = std::numbers::pi;
// Moments of a solid cylinder of 1 kg, 5 cm and 20 cm, and L at 100 turns per second, by hand.
constexpr double i1 = 0.0025 / 4 + 0.04 / 12, i3 = 0.0025 / 2, l = i3 * 2 * pi * 100, torque = 0.5, v = 2;

RotatingCylinder cylinder_with(const CylinderTorque& any, AxisStart start = AxisStart::at_rest) {
  RotatingCylinder c;
  c.mass = 1;
  c.radius = 0.05;
  c.length = 0.2;
  c.spin = 100;
  c.speed = v;
  c.torque = any;
  c.axis_start = start;
  c.duration = 10;
  c.samples = 2001;
  return c;
}

const std::vector<double>& course(const Motion& motion, const std::string& name) {
  for (const Course& c : motion.numbers)
    if (c.name == name) return c.values;
  throw std::out_of_range(name);
}
const std::vector<Vector3>& vectors(const Motion& motion, const std::string& name) {
  for (const VectorCourse& c : motion.vectors)
    if (c.name == name) return c.values;
  throw std::out_of_range(name);
}

TEST(RotatingCylinder, TurnsOnThePapersCircle) {
  const Motion paper = solve(cylinder_with(BodyFixedTorque{torque})).motions.at(0);
  EXPECT_EQ(paper.name, "paper");
  const std::size_t i = 700;
  const double t = paper.time[i];
  const auto angle = [&](double scale) { return scale * torque / l * t; };
  expect_agreement(
      paper.position[i].y, [&](double s) { return v * l / torque / s * std::sin(angle(s)); }, 1e-9, "y");
  expect_agreement(
      paper.position[i].z, [&](double s) { return -v * l / torque / s * (1 - std::cos(angle(s))); }, 1e-9,
      "z");
  EXPECT_EQ(paper.position[i].x, 0);
  // Eqs. 31 and 32.
  expect_agreement(
      course(paper, "radius")[i], [](double s) { return s * v * l / torque; }, 1e-9, "r");
  expect_agreement(
      course(paper, "p_theta")[i], [](double s) { return s * v * l / torque * v; }, 1e-9, "P_theta");
  expect_agreement(
      course(paper, "hamiltonian")[i], [](double s) { return s * v * v / 2; }, 1e-12, "H");
}

TEST(RotatingCylinder, SolvesTheEulerEquationsAsTheirClosedFormDoes) {
  const RotatingCylinder model = cylinder_with(BodyFixedTorque{torque});
  const Motion euler = solve(model).motions.at(1);
  const std::size_t i = 1234;
  const double t = euler.time[i];
  expect_agreement(
      course(euler, "omega_1")[i], [&](double s) { return -torque / l * (1 - std::cos(s * l / i1 * t)); },
      1e-8, "omega_1");
  expect_agreement(
      course(euler, "omega_2")[i], [&](double s) { return torque / l * std::sin(s * l / i1 * t); }, 1e-8,
      "omega_2");
  const ModelResult result = solve(model);
  EXPECT_LT(finding(result, "rates").value, 1e-9);
  EXPECT_EQ(finding(result, "spin_drift").value, 0);
  // The rate swings about M/L and has done 316 turns and a part.
  const double k = l / i1;
  expect_agreement(
      finding(result, "precession").value,
      [&](double s) { return s * torque / l * (1 - std::sin(k * 10) / (k * 10)); }, 1e-9, "precession");
}

TEST(RotatingCylinder, FollowsThePaperExactlyWhereItStartsPrecessing) {
  const ModelResult result = solve(cylinder_with(BodyFixedTorque{torque}, AxisStart::precessing));
  EXPECT_LT(finding(result, "path_distance").value, 1e-12);
  EXPECT_LT(finding(result, "axis_distance").value, 1e-12);
  EXPECT_LT(finding(result, "p_theta_drift_euler").value, 1e-12);
  expect_agreement(
      finding(result, "precession").value, [](double s) { return s * torque / l; }, 1e-12, "Omega");
  expect_agreement(
      finding(result, "tilt").value, [](double s) { return std::atan(s * torque * i1 / l / l); }, 1e-12,
      "tilt");
  // Also where the top is not fast at all.
  RotatingCylinder slow = cylinder_with(BodyFixedTorque{torque}, AxisStart::precessing);
  slow.spin = 3;
  const ModelResult slowly = solve(slow);
  EXPECT_GT(finding(slowly, "fast_top").value, 1);
  EXPECT_LT(finding(slowly, "path_distance").value, 1e-10);
}

TEST(RotatingCylinder, NodsTwiceAsFarAsThePrecessionTiltsIt) {
  RotatingCylinder model = cylinder_with(BodyFixedTorque{torque});
  model.duration = 2 * pi * i1 / l;  // one nod
  const ModelResult result = solve(model);
  expect_agreement(
      finding(result, "tilt").value, [](double s) { return std::atan(2 * s * torque * i1 / l / l); }, 1e-8,
      "tilt");
  expect_agreement(
      finding(result, "tilt").expected, [](double s) { return std::atan(2 * s * torque * i1 / l / l); },
      1e-12, "tilt expected");
}

TEST(RotatingCylinder, LosesThePaperWithTheSpin) {
  double before = 0;
  for (const double spin : {300.0, 100.0, 30.0, 10.0}) {
    RotatingCylinder model = cylinder_with(BodyFixedTorque{torque});
    model.spin = spin;
    model.duration = 1;
    const double apart = finding(solve(model), "axis_distance").value;
    EXPECT_GT(apart, 5 * before);  // as 1/spin^2
    before = apart;
  }
}

TEST(RotatingCylinder, GrowsItsAngularMomentumUnderATorqueFixedInSpace) {
  const ModelResult result = solve(cylinder_with(SpaceFixedTorque{torque}));
  const Vector3 end = vectors(result.motions.at(1), "angular_momentum").back();
  expect_agreement(
      end.y, [](double s) { return s * torque * 10; }, 1e-10, "L along the torque");
  expect_agreement(
      end.z, [](double s) { return s * l; }, 1e-10, "L along the axis at first");
  EXPECT_NEAR(end.x, 0, 1e-10);
  expect_agreement(
      finding(result, "growth").value, [](double s) { return std::hypot(1, s * torque * 10 / l) - 1; }, 1e-10,
      "growth");
  EXPECT_GT(finding(result, "torque_along_axis").value, 0.95);  // "permanently perpendicular" fails
  // The fast top: the axis follows L, v turns with it.
  const Motion& paper = result.motions.at(0);
  const double a = torque / l;
  expect_agreement(
      paper.position.back().y, [&](double s) { return v / a / s * std::asinh(s * a * 10); }, 1e-9, "y");
  expect_agreement(
      paper.position.back().z, [&](double s) { return -v / a / s * (std::hypot(1, s * a * 10) - 1); }, 1e-9,
      "z");
}

TEST(RotatingCylinder, PrecessesSteadilyInAField) {
  const double angle = 1;
  const ModelResult result = solve(cylinder_with(FieldTorque{torque, angle}, AxisStart::precessing));
  const double rate = finding(result, "precession").value;
  expect_agreement(
      rate * rate * i1 * std::cos(angle) - l * rate, [](double s) { return -s * torque; }, 1e-12,
      "I1 W^2 cos - L W + M");
  const Vector3 u{-std::sin(angle), 0, std::cos(angle)};
  for (const Vector3& axis : vectors(result.motions.at(1), "axis"))
    EXPECT_NEAR(dot(axis, u), std::cos(angle), 1e-12);
}

TEST(RotatingCylinder, KeepsInAFieldWhatAHeavyTopKeeps) {
  for (const double angle : {0.3, 1.0, pi / 2, 2.5}) {
    RotatingCylinder model = cylinder_with(FieldTorque{torque, angle});
    model.spin = 10;  // slow, so that it nods far
    const ModelResult result = solve(model);
    EXPECT_GT(finding(result, "axis_distance").value, 0.1);
    for (const char* kept : {"energy_with_field", "angular_momentum_along_field", "energy_balance",
                             "angular_momentum_balance", "spin_drift", "speed_drift"})
      EXPECT_LT(finding(result, kept).value, 1e-11) << kept << " at " << angle;
  }
}

/// The closed path of the fast top is the integral of its velocity, which turns with the axis.
TEST(RotatingCylinder, WritesAPathInAFieldThatIsTheIntegralOfItsVelocity) {
  const Motion paper = solve(cylinder_with(FieldTorque{torque, 1.0})).motions.at(0);
  const std::vector<Vector3>& velocity = vectors(paper, "velocity");
  const double step = paper.time[1];
  Vector3 place;
  for (std::size_t i = 0; i + 2 < paper.time.size(); i += 2) {  // Simpson
    place = place + (step / 3) * (velocity[i] + 4 * velocity[i + 1] + velocity[i + 2]);
    EXPECT_NEAR(length_of(place - paper.position[i + 2]), 0, 1e-9);
  }
  for (std::size_t i = 0; i < velocity.size(); ++i)
    EXPECT_NEAR(dot(velocity[i], vectors(paper, "axis")[i]), 0, 1e-13);
}

TEST(RotatingCylinder, FliesStraightUnderEstablishedMechanics) {
  const ModelResult result = solve(cylinder_with(BodyFixedTorque{torque}));
  const Motion &euler = result.motions.at(1), &standard = result.motions.at(2);
  EXPECT_EQ(standard.name, "standard");
  for (std::size_t i = 0; i < standard.time.size(); ++i) {
    EXPECT_EQ(standard.position[i], Vector3(0, v * standard.time[i], 0));
    EXPECT_EQ(vectors(standard, "axis")[i], vectors(euler, "axis")[i]);
  }
}

TEST(RotatingCylinder, HasNoCircleWithoutTorqueOrSpeed) {
  RotatingCylinder still = cylinder_with(BodyFixedTorque{torque});
  still.speed = 0;
  for (const RotatingCylinder& model :
       {still, cylinder_with(BodyFixedTorque{0}), cylinder_with(SpaceFixedTorque{0}),
        cylinder_with(FieldTorque{0, 1}), cylinder_with(FieldTorque{0, 1}, AxisStart::precessing)}) {
    const ModelResult result = solve(model);
    EXPECT_EQ(test::find(result, "radius"), nullptr);
    for (const Finding& f : result.findings)
      EXPECT_TRUE(std::isfinite(f.value) && std::isfinite(f.expected)) << f.name;
    for (const Motion& motion : result.motions)
      for (const Vector3& place : motion.position)
        EXPECT_NEAR(place.y, model.speed * motion.time[&place - &motion.position[0]], 1e-11);
    EXPECT_TRUE(faults_of(model).empty());
  }
}

TEST(RotatingCylinder, RefusesWhatCannotBeFollowedOrHasNoSteadyPrecession) {
  RotatingCylinder model = cylinder_with(BodyFixedTorque{torque});
  model.duration = 1e5;
  ASSERT_EQ(faults_of(model).size(), 1U);
  EXPECT_EQ(faults_of(model)[0].key, "duration");
  model = cylinder_with(FieldTorque{torque, 1}, AxisStart::precessing);
  EXPECT_TRUE(faults_of(model).empty());
  model.spin = 1;
  ASSERT_EQ(faults_of(model).size(), 1U);
  EXPECT_EQ(faults_of(model)[0].key, "axis_start");
  EXPECT_THROW(solve(model), std::invalid_argument);
}

}  // namespace
}  // namespace rabiline::rotating_cylinder_test
