#include "simulation/effects.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace rabiline::effects_test {
namespace {

/// Two axes, of two and three points; what one detector caught at each of the six.
Result caught(std::vector<double> detected) {
  Result result;
  result.axes = {{"A.field", Dimension::magnetic_field, {1, 2}, {}},
                 {"B.field", Dimension::magnetic_field, {1, 2, 3}, {}}};
  result.emitted.assign(6, 100);
  DetectorResult detector;
  detector.counts = detected;
  detector.levels.assign(6, std::numeric_limits<double>::quiet_NaN());
  detector.detected = std::move(detected);
  result.detectors = {std::move(detector)};
  return result;
}

std::vector<std::string> warnings_of(const Result& result) {
  Effects effects;
  effects.add(result);
  return effects.warnings(result);
}

TEST(WarningsOfAResult, NameTheParameterThatHadNoEffect) {
  EXPECT_THAT(warnings_of(caught({1, 2, 3, 1, 2, 3})), testing::ElementsAre(testing::HasSubstr("`A.field`")));
  EXPECT_THAT(warnings_of(caught({1, 1, 1, 2, 2, 2})), testing::ElementsAre(testing::HasSubstr("`B.field`")));
  EXPECT_EQ(warnings_of(caught({1, 1, 1, 1, 1, 1})).size(), 2U);
}

TEST(WarningsOfAResult, AreSilentWhereOnePointDiffersByABit) {
  EXPECT_TRUE(warnings_of(caught({1, 2, 3, 1, 2, std::nextafter(3.0, 4.0)})).empty());
}

TEST(WarningsOfAResult, CompareAcrossSlabs) {
  const Result first = caught({1, 2, 3, 1, 2, 3});
  for (const double last : {3.0, 4.0}) {
    Effects effects;
    for (const std::vector<double>& slab : {std::vector<double>{1, 2, 3, 1}, {2, last}}) {
      Result points = caught(slab);
      points.emitted.resize(slab.size());
      points.detectors.front().levels.resize(slab.size());
      effects.add(points);
    }
    EXPECT_EQ(effects.warnings(first).size(), last == 3 ? 1U : 0U);
  }
}

TEST(WarningsOfAResult, AreSilentWhereNothingIsScanned) {
  Result result;
  result.emitted = {100};
  result.detectors.emplace_back();
  result.detectors.front().detected = {0.5};
  EXPECT_TRUE(warnings_of(result).empty());
}

}  // namespace
}  // namespace rabiline::effects_test
