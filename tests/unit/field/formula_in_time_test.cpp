#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "field/field_formula.hpp"
#include "field/host_maths.hpp"
#include "field/time_course.hpp"

namespace rabiline::formula_in_time_test {
namespace {

const std::array<MapAxis, 3> axes{MapAxis{5, -0.01, 0.005}, MapAxis{7, 0, 0.02}, MapAxis{4, -0.03, 0.02}};
constexpr double duration = 3e-3;  // [s]

std::vector<FieldOfCourse> fields_of(const std::string& bx, const std::string& bz) {
  return sampled_in_time({{bx, "2e-4", bz}, {}, 0, duration}, axes);
}
TimeCourse course_of(const FieldOfCourse& field) {
  const int nodes = static_cast<int>(field.course.size()) - 2;
  return {field.course.data(), nodes, (nodes - 1) / duration, field.stops.data()};
}

TEST(FormulaInTime, IsTheSumOfItsFieldsAtEveryNodeAndTime) {
  const auto fields = fields_of("1e-3*exp(-((t-1e-3)/2e-4)^2)*(1+x/0.02) + 1e-4*cos(2*pi*(3000*t - y/0.1))",
                                "5e-4*min(t/2e-3, 1)*z/0.01");
  EXPECT_LE(fields.size(), 5U);
  for (const double t : {0.0, 0.7e-3, 1.0123e-3, 2.3e-3, 3e-3, 0.5}) {
    const double now = std::min(t, duration);
    std::size_t at = 0;
    for (int i = 0; i < 5; ++i)
      for (int j = 0; j < 7; ++j)
        for (int k = 0; k < 4; ++k, at += 3) {
          double sum[3] = {};
          for (const FieldOfCourse& field : fields)
            for (std::size_t m = 0; m < 3; ++m)
              sum[m] += field.nodes.field[at + m] * course_at<HostMaths>(course_of(field), t).share;
          const double x = -0.01 + 0.005 * i, y = 0.02 * j, z = -0.03 + 0.02 * k;
          EXPECT_NEAR(sum[0],
                      1e-3 * std::exp(-std::pow((now - 1e-3) / 2e-4, 2)) * (1 + x / 0.02) +
                          1e-4 * std::cos(2 * M_PI * (3000 * now - y / 0.1)),
                      1e-9)
              << t;
          EXPECT_NEAR(sum[1], 2e-4, 1e-9);
          EXPECT_NEAR(sum[2], 5e-4 * std::min(now / 2e-3, 1.0) * z / 0.01, 1e-9);
        }
  }
}

TEST(FormulaInTime, HasSharesOfOneAtMostAndTheirRates) {
  for (const FieldOfCourse& field : fields_of("0", "5e-4*sin(2000*t)*z")) {
    const TimeCourse course = course_of(field);
    for (double t = 0; t < 3e-3; t += 1e-5) {
      const auto at = [&](double moment) { return course_at<HostMaths>(course, moment); };
      EXPECT_LE(std::abs(at(t).share), 1 + 1e-9);
      EXPECT_NEAR(at(t + 5e-6).rate, (at(t + 1e-5).share - at(t).share) / 1e-5, 2.0);
    }
  }
}

TEST(FormulaInTime, StopsWhereACourseBends) {
  const auto fields = fields_of("0", "5e-4*min(max((t - 1.1e-3)/3e-4, 0), 1)");
  const auto ramp =
      std::ranges::max_element(fields, {}, [](const FieldOfCourse& f) { return f.stops.size(); });
  const TimeCourse course = course_of(*ramp);
  std::vector<double> stops;
  for (double t = 0; t < duration && stops.size() < 100; stops.push_back(t))
    t = next_stop<HostMaths>(course, t * (1 + 1e-12), duration);
  EXPECT_LT(stops.size(), 20U);
  for (const double bend : {1.1e-3, 1.4e-3})
    EXPECT_TRUE(std::ranges::any_of(stops, [&](double stop) {
      return std::abs(stop - bend) < 2 / course.per_second;
    })) << bend;
  EXPECT_EQ(next_stop<HostMaths>(course, 0.1, 0.2), 0.2);
}

}  // namespace
}  // namespace rabiline::formula_in_time_test
