// Stepped paths where the force turns over.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/isa.hpp"
#include "steering_samples.hpp"

namespace rabiline::steering_jumps_test {
namespace {

using namespace steering_test;

/// Along x, of one that is pulled by `a` [m/s^2] towards x = 0, or pushed away where it is negative.
std::array<double, 2> there_and_back(double x, double v, double a, double stay) {
  for (;;) {
    const double side = x != 0 ? std::copysign(1, x) : std::copysign(1, v);
    const double u = side * v, away = std::abs(x), square = u * u + 2 * a * away;
    double next = stay;  // until |x| + u t - a t^2/2 = 0
    if (a > 0) next = (u + std::sqrt(square)) / a;
    if (a < 0 && u < 0 && square > 0) next = 2 * away / (std::sqrt(square) - u);
    next = std::min(next, stay);
    const bool meets = next < stay;
    x = meets ? 0 : x + v * next - side * a * next * next / 2;
    v -= side * a * next;
    stay -= next;
    if (!meets) return {x, v};
  }
}

TEST(SteeringJumps, TurnsOverWhereTheFieldVanishes) {
  for (const MagnetKind kind : {MagnetKind::gradient, MagnetKind::multipole}) {
    MagnetShape shape = multipole(1, 0.5);
    shape.kind = kind;
    if (kind == MagnetKind::gradient)
      shape.field = 0, shape.gradient = 100, shape.along_x = 1, shape.along_z = 0;
    const Steering s = magnet(shape);
    Batch before, after;
    fill(before, 2);
    for (int i = 0; i < before.view().count; ++i) before.view().z[i] = before.view().vz[i] = 0;
    after.copy_from(before);
    kernel::steer(best_isa())(s, after.view());
    const BatchView &b = before.view(), &a = after.view();
    for (int i = 0; i < b.count; ++i) {
      const double stay = (s.end - s.begin) / b.vy[i];
      const double pull = (b.level[i] == 0 ? 1 : -1) * bohr_magneton * 100 / s.mass;
      const auto [x, v] = there_and_back(b.x[i], b.vx[i], pull, stay);
      const double bent = std::abs(pull) * stay * stay / 2;
      EXPECT_NEAR(a.x[i], x, 1e-9 + 1e-6 * bent) << i << ' ' << b.level[i];
      EXPECT_NEAR(a.vx[i], v, (1e-8 + 1e-5 * bent) / stay) << i;
    }
  }
}

int towards_the_axis(double, const double y[], double f[], void* pull) {
  const double r = std::hypot(y[0], y[1]), a = *static_cast<double*>(pull);
  f[0] = y[2], f[1] = y[3];
  f[2] = -a * y[0] / r, f[3] = -a * y[1] / r;
  return GSL_SUCCESS;
}
TEST(SteeringJumps, OfAQuadrupoleIsRightPastItsAxisAtAnyDistance) {
  const Steering s = magnet(multipole(1));
  Batch before, after;
  fill(before, 2);
  BatchView& b = before.view();
  for (int i = 0; i < b.count; ++i) {
    b.x[i] = b.vz[i] = 0;
    b.z[i] = 1e-5 * (1 + i % 13);
    b.vx[i] = std::pow(10, -7 + 0.01 * i);  // the axis is missed by 1e-12 m and more
    b.level[i] = 0;
  }
  after.copy_from(before);
  kernel::steer(best_isa())(s, after.view());
  for (int i = 0; i < b.count; i += 7) {
    const double stay = (s.end - s.begin) / b.vy[i];
    double pull = bohr_magneton * 200 / s.mass, t = 0, y[4]{b.x[i], b.z[i], b.vx[i], b.vz[i]};
    gsl_odeiv2_system system{towards_the_axis, nullptr, 4, &pull};
    gsl_odeiv2_driver* driver =
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-6, 1e-17, 1e-13);
    ASSERT_EQ(gsl_odeiv2_driver_apply(driver, &t, stay, y), GSL_SUCCESS);
    gsl_odeiv2_driver_free(driver);
    const double bent = pull * stay * stay / 2;
    EXPECT_NEAR(after.view().x[i], y[0], 1e-9 + 1e-6 * bent) << i;
    EXPECT_NEAR(after.view().z[i], y[1], 1e-9 + 1e-6 * bent) << i;
    EXPECT_NEAR(after.view().vx[i], y[2], (1e-8 + 1e-5 * bent) / stay) << i;
    EXPECT_NEAR(after.view().vz[i], y[3], (1e-8 + 1e-5 * bent) / stay) << i;
  }
}

}  // namespace
}  // namespace rabiline::steering_jumps_test
