#include "field/field_formula.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "field/host_maths.hpp"

namespace rabiline::field_formula_test {
namespace {

const std::array<MapAxis, 3> axes{MapAxis{5, -0.01, 0.005}, MapAxis{7, 0, 0.02}, MapAxis{4, -0.03, 0.02}};

FormulaFault fault_of(const std::string& text) {
  try {
    sampled({{"0", text, "0"}, {{"B0", 2e-3}}}, axes);
  } catch (const FormulaFault& fault) {
    return fault;
  }
  return {"none", ""};
}

TEST(FieldFormula, GivesEachComponentAtEachNode) {
  const auto parts =
      sampled({{"-G*x", "B0*sin(2*pi*y)^2", "B0 + G*z - 2^-3^2"}, {{"B0", 2e-3}, {"G", 0.5}}}, axes);
  ASSERT_EQ(parts.size(), 1u);
  const MapNodes& nodes = parts.front().nodes;
  ASSERT_EQ(nodes.field.size(), 5u * 7u * 4u * 3u);
  std::size_t at = 0;
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 7; ++j)
      for (int k = 0; k < 4; ++k, at += 3) {
        const double x = -0.01 + 0.005 * i, y = 0.02 * j, z = -0.03 + 0.02 * k;
        EXPECT_NEAR(nodes.field[at], -0.5 * x, 1e-16);
        EXPECT_NEAR(nodes.field[at + 1], 2e-3 * std::pow(std::sin(2 * M_PI * y), 2), 1e-16);
        EXPECT_NEAR(nodes.field[at + 2], 2e-3 + 0.5 * z - std::pow(2.0, -9), 1e-16);
      }
}

TEST(FieldFormula, KnowsTheFunctionsAndOperatorsThatItNames) {
  const auto value = [](const std::string& text) {
    return sampled({{text, "0", "0"}, {}}, axes).front().nodes.field[0];
  };
  // At x = -0.01, y = 0, z = -0.03.
  EXPECT_NEAR(value("tanh(x)"), std::tanh(-0.01), 1e-16);
  EXPECT_NEAR(value("sinh(3) + cosh(3)"), std::exp(3.0), 1e-13);
  EXPECT_DOUBLE_EQ(value("hypot(x, z)"), std::hypot(0.01, 0.03));
  EXPECT_DOUBLE_EQ(value("atan2(z, x)"), std::atan2(-0.03, -0.01));
  EXPECT_DOUBLE_EQ(value("x < 0 && z > 0 ? 1 : 3"), 3);
  EXPECT_DOUBLE_EQ(value("min(x, z) + max(1, 2) + abs(x) + sqrt(4) + log(1) + erf(0)"), -0.03 + 2 + 0.01 + 2);
  EXPECT_DOUBLE_EQ(value("mu_0*1e6"), 1.25663706127);
  EXPECT_DOUBLE_EQ(value("(-2)^3 + 4^0.5"), -6);
}

TEST(FieldFormula, SaysWhatIsWrongAndWhere) {
  const auto expect = [](const std::string& text, const std::string& message, std::size_t from,
                         std::size_t length) {
    const FormulaFault fault = fault_of(text);
    EXPECT_NE(std::string(fault.what()).find(message), std::string::npos) << text << ": " << fault.what();
    EXPECT_EQ(fault.component, 1u);
    EXPECT_EQ(fault.from, from) << text;
    EXPECT_EQ(fault.length, length) << text;
  };
  expect("B0*(1 + B1*z)", "`B1` is not a place", 8, 2);
  expect("1 + cso(x)", "`cso` is not a place", 4, 3);
  expect("B0*(1 + x", "a bracket is not closed", 9, 1);
  expect("B0 x", "an operator is missing before `x`", 3, 1);
  expect("B0 + ", "ends too soon", 5, 1);
  expect("B0 = 3", "", 3, 1);
  expect("1/y", "no finite value", 0, 3);
  expect("hypot(x)", "another number of arguments", 0, 5);
  expect("1, 2", "several values", 0, 4);
}

TEST(FieldFormula, IsTheSumOfItsHarmonicsAtEachTime) {
  const double f = 3e3, w = 2 * M_PI * f;
  const auto field = [&](double x, double y, double z, double t) {
    return std::array{1e-3 * std::pow(std::cos(w * t - 7 * y), 3), 2e-3 * z,
                      x * (1 + std::sin(w * t)) * std::cos(3 * w * t)};
  };
  const auto parts = sampled(
      {{"B0/2*cos(w*t - 7*y)^3", "B0*z", "x*(1 + sin(w*t))*cos(3*w*t)"}, {{"B0", 2e-3}, {"w", w}}, f}, axes);
  std::vector<std::pair<int, bool>> found;
  for (const FieldHarmonic& part : parts) found.emplace_back(part.number, part.sine);
  EXPECT_EQ(found, (std::vector<std::pair<int, bool>>{
                       {0, false}, {1, false}, {1, true}, {2, true}, {3, false}, {3, true}, {4, true}}));
  for (const double t : {0.0, 1.234e-4, 7.7e-3}) {
    std::size_t at = 0;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 7; ++j)
        for (int k = 0; k < 4; ++k, at += 3) {
          const auto expected = field(-0.01 + 0.005 * i, 0.02 * j, -0.03 + 0.02 * k, t);
          for (std::size_t m = 0; m < 3; ++m) {
            double sum = 0;
            for (const FieldHarmonic& part : parts)
              sum += part.nodes.field[at + m] *
                     (part.sine ? std::sin(part.number * w * t) : std::cos(part.number * w * t));
            EXPECT_NEAR(sum, expected[m], 1e-14);
          }
        }
  }
}

TEST(FieldFormula, HasNoConstantsWhoseNamesMeanSomethingElse) {
  EXPECT_TRUE(can_name_constant("B0"));
  for (const char* name : {"x", "t", "pi", "sin", "", "1a", "a-b"})
    EXPECT_FALSE(can_name_constant(name)) << name;
}

}  // namespace
}  // namespace rabiline::field_formula_test
