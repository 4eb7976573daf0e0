// Shapes of magnets, and stepped paths through them.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_spline.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <memory>
#include <random>

#include "core/isa.hpp"
#include "particle/species.hpp"
#include "spin/levels.hpp"
#include "spin/moment_table.hpp"
#include "steering_samples.hpp"

namespace rabiline::steering_test {
namespace {

FieldSize<double> at(const MagnetShape& shape, double x, double z) {
  return field_size(shape, x, z, [](double q) { return std::sqrt(q); });
}
MagnetShape two_wires(double field = 0.5, double a = 2e-3) {
  MagnetShape shape;
  shape.kind = MagnetKind::two_wire;
  shape.field = field;
  shape.half_distance = a;
  shape.height = 1.2 * a;
  return shape;
}
MagnetShape gradient() {
  MagnetShape shape;
  shape.field = -0.1;
  shape.gradient = 100;
  shape.along_x = 0.6;
  shape.along_z = 0.8;
  return shape;
}
std::vector<MagnetShape> shapes() {
  std::vector<MagnetShape> out{two_wires(), two_wires(-0.5), gradient()};
  for (int power = 1; power < 10; ++power) out.push_back(multipole(power));
  return out;
}

TEST(MagnetShape, HasTheGradientOfItsSize) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> place(-4e-3, 4e-3);
  for (const MagnetShape& shape : shapes())
    for (int i = 0; i < 200; ++i) {
      const double x = place(random), z = place(random) + shape.height, d = 1e-8;
      const auto field = at(shape, x, z);
      const double scale = std::hypot(field.along_x, field.along_z) + field.bend * 1e-4;
      if (field.size < 1e-3 || std::sqrt(field.sharpness) * d > 1e-5) continue;
      ASSERT_NEAR((at(shape, x + d, z).size - at(shape, x - d, z).size) / (2 * d), field.along_x,
                  3e-6 * scale);
      ASSERT_NEAR((at(shape, x, z + d).size - at(shape, x, z - d).size) / (2 * d), field.along_z,
                  3e-6 * scale);
    }
}

TEST(MagnetShape, OfManyPolesIsThePowerOfTheRadius) {
  for (int power = 1; power < 10; ++power) {
    EXPECT_NEAR(at(multipole(power), 3e-3, -1e-3).size, std::pow(std::sqrt(10.0) / 5, power), 1e-15);
    const auto axis = at(multipole(power), 0, 0);
    EXPECT_EQ(axis.size, 0);
    EXPECT_EQ(axis.along_x, 0);
    EXPECT_EQ(axis.along_z, 0);
  }
}

// ---- paths ----

/// Moments of levels by diagonalisation at fields that rise by half a percent, and splines between them: no
/// table of the program.
class Moments {
 public:
  Moments(const CoupledSpins& spins, double most) {
    std::vector<double> fields{0};
    for (double b = 1e-6 * most; b < 1.01 * most; b *= 1.005) fields.push_back(b);
    std::vector<std::vector<double>> moments(static_cast<std::size_t>(spins.levels()));
    for (const double b : fields) {
      const Levels at = levels_at(spins, b);
      for (std::size_t n = 0; n < moments.size(); ++n) moments[n].push_back(at.moment[n]);
    }
    for (const std::vector<double>& of_level : moments) {
      splines_.emplace_back(gsl_spline_alloc(gsl_interp_cspline, fields.size()), gsl_spline_free);
      gsl_spline_init(splines_.back().get(), fields.data(), of_level.data(), fields.size());
    }
  }
  double operator()(int level, double field) const {
    return gsl_spline_eval(splines_[static_cast<std::size_t>(level)].get(), field, nullptr);
  }

 private:
  std::vector<std::unique_ptr<gsl_spline, void (*)(gsl_spline*)>> splines_;
};

/// An independent integration: GSL's Runge-Kutta-Prince-Dormand 8(7), forces as differences of |B|.
struct Path {
  const Steering& s;
  double moment;  // [J/T], of a constant one
  const Moments* moments = nullptr;
  int level = 0;
};
double size_at(const MagnetShape& m, double x, double z) {
  if (m.kind == MagnetKind::gradient) return std::abs(m.field + m.gradient * (m.along_x * x + m.along_z * z));
  const double a = m.half_distance, h = m.height;
  if (m.kind == MagnetKind::two_wire)
    return std::abs(m.field) * (a * a + h * h) / (std::hypot(x - a, z) * std::hypot(x + a, z));
  return m.field * std::pow(std::hypot(x, z) / m.radius, m.power);
}
int derivative(double, const double y[], double f[], void* parameters) {
  const Path& p = *static_cast<Path*>(parameters);
  const MagnetShape& m = p.s.shape;
  // Five-point differences; to the lab's frame and back.
  const double c = p.s.cosine, s = p.s.sine, d = 2e-6;
  const double dx = y[0] - p.s.x0, dz = y[1] - p.s.z0;
  const double x = c * dx - s * dz, z = s * dx + c * dz + m.height;
  const auto slope = [&](double ux, double uz) {
    const auto b = [&](double k) { return size_at(m, x + k * d * ux, z + k * d * uz); };
    return (8 * (b(1) - b(-1)) - (b(2) - b(-2))) / (12 * d);
  };
  const double mu = p.moments ? (*p.moments)(p.level, size_at(m, x, z)) : p.moment;
  const double fx = mu * slope(1, 0) / p.s.mass, fz = mu * slope(0, 1) / p.s.mass;
  f[0] = y[2];
  f[1] = y[3];
  f[2] = c * fx + s * fz;
  f[3] = c * fz - s * fx;
  return GSL_SUCCESS;
}
std::array<double, 4> integrated(const Path& path, const BatchView& v, int i) {
  Path p = path;
  gsl_odeiv2_system system{derivative, nullptr, 4, &p};
  gsl_odeiv2_driver* driver =
      gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-6, 1e-13, 1e-11);
  gsl_odeiv2_driver_set_nmax(driver, 20000);
  std::array<double, 4> y{v.x[i], v.z[i], v.vx[i], v.vz[i]};
  double t = 0;
  EXPECT_EQ(gsl_odeiv2_driver_apply(driver, &t, (path.s.end - path.s.begin) / v.vy[i], y.data()),
            GSL_SUCCESS);
  gsl_odeiv2_driver_free(driver);
  return y;
}

/// Exits within 1e-9 m + 1e-6 of the deflection of the integration; returns the largest ratio to that.
double worst_exit(const Steering& s, int levels, const Moments* moments = nullptr, int every = 7,
                  double spread = 2e-3) {
  Batch before, after;
  fill(before, levels, spread);
  after.copy_from(before);
  kernel::steer(best_isa())(s, after.view());
  const BatchView &b = before.view(), &a = after.view();
  double worst = 0;
  for (int i = 0; i < b.count; i += every) {
    if (a.flying[i] == 0) continue;
    const int level = static_cast<int>(b.level[i]);
    const double part = s.levels > 0 ? 1 - 2.0 * level / (levels - 1) : b.sz[i];
    const auto y = integrated({s, s.moment * part, moments, level}, b, i);
    const double stay = (s.end - s.begin) / b.vy[i];
    const double bent = std::hypot(y[0] - b.x[i] - b.vx[i] * stay, y[1] - b.z[i] - b.vz[i] * stay);
    worst = std::max(worst, std::hypot(y[0] - a.x[i], y[1] - a.z[i]) / (1e-9 + 1e-6 * bent));
    worst = std::max(worst, std::hypot(y[2] - a.vx[i], y[3] - a.vz[i]) * stay / (1e-8 + 1e-5 * bent));
  }
  return worst;
}

TEST(Steering, LeavesWhereAFineIntegrationDoes) {
  std::vector<std::pair<const char*, Steering>> magnets{{"wires", magnet(two_wires())},
                                                        {"sextupole", magnet(multipole(2))},
                                                        {"octupole", magnet(multipole(3))},
                                                        {"ten poles", magnet(multipole(4))},
                                                        {"twelve poles", magnet(multipole(5))}};
  for (auto& [name, s] : magnets) {
    if (s.shape.kind == MagnetKind::multipole) {
      s.walls.circles[0] = {0, 0, 5e-3, -1};
    } else {
      s.walls.circles[0] = {2e-3, 0, 1e-3, 1};
      s.walls.circles[1] = {-2e-3, 0, 1e-3, 1};
    }
    const double worst = worst_exit(s, 2);
    RecordProperty(name, std::to_string(worst));
    EXPECT_LT(worst, 1) << name;
  }
  Steering classical = magnet(two_wires());
  classical.levels = 0;
  EXPECT_LT(worst_exit(classical, 2, nullptr, 7, 1e-3), 1);
}

TEST(Steering, DoesSoOffsetAndTurnedAndLong) {
  Steering s = magnet(two_wires(-0.5, 3e-3), 0.5);
  s.x0 = 0.3e-3;
  s.z0 = -0.2e-3;
  s.cosine = std::cos(2.5);
  s.sine = std::sin(2.5);
  s.walls.circles[0] = {3e-3, 0, 2e-3, 1};
  s.walls.circles[1] = {-3e-3, 0, 2e-3, 1};
  EXPECT_LT(worst_exit(s, 2, nullptr, 5, 1e-3), 1);
  Steering sextupole = magnet(multipole(2), 2);
  sextupole.walls.circles[0] = {0, 0, 5e-3, -1};
  EXPECT_LT(worst_exit(sextupole, 2, nullptr, 5, 1e-3), 1);
}

TEST(Steering, DoesSoWithMomentsThatDependOnTheField) {
  for (const char* name : {"H atom", "Cs-133 atom", "ortho-H2"}) {
    const Species& atom = *find_species(name);
    const CoupledSpins spins = coupled_spins(*atom.structure);
    const MomentTable table(spins);
    const Moments moments(spins, 20);
    for (const MagnetShape& shape : {multipole(2), two_wires(0.05), gradient()}) {
      Steering s = magnet(shape);
      s.mass = shape.kind == MagnetKind::multipole ? 20 * atom.mass : 100 * atom.mass;
      if (shape.kind == MagnetKind::gradient) s.shape.field = 0.4;  // which does not vanish
      s.levels = table.levels();
      s.moment = table.largest();
      s.moments = {table.coefficients().data(), table.cells(), table.scale()};
      s.walls.circles[0] = {0, shape.height, 4e-3, -1};
      s.walls.circles[1] = {2e-3, 0, 1e-3, shape.kind == MagnetKind::two_wire ? 1 : 0};
      EXPECT_LT(worst_exit(s, table.levels(), &moments, 3, 0.8e-3), 1)
          << name << static_cast<int>(shape.kind);
    }
  }
}

TEST(Steering, OfAQuadrupoleIsRightAwayFromItsAxis) {
  Steering s = magnet(multipole(1));
  s.walls.circles[0] = {0, 0, 50e-6, 1};  // nothing closer is followed
  EXPECT_LT(worst_exit(s, 2), 1);
}

TEST(Steering, LetsWhatWasCaughtBeforeFlyStraightOn) {
  const Steering s = magnet(multipole(2));
  Batch batch, before;
  fill(batch, 2);
  batch.view().flying[3] = 0;
  before.copy_from(batch);
  kernel::steer(best_isa())(s, batch.view());
  const BatchView &b = before.view(), &a = batch.view();
  EXPECT_NEAR(a.x[3], b.x[3] + b.vx[3] * (s.end - s.begin) / b.vy[3], 1e-15);
  EXPECT_EQ(a.vx[3], b.vx[3]);
  EXPECT_EQ(a.flying[3], 0U);
}

TEST(Steering, EndsOnTheAxisWhereTheParabolaMeetsAWall) {
  Steering s = magnet(gradient());
  s.walls.rectangle = true;
  s.walls.half_x = s.walls.half_z = 0.4e-3;
  const double acceleration = 0.8 * bohr_magneton * 100 / s.mass, speed = 300;
  const double expected = s.begin + speed * std::sqrt(2 * 0.4e-3 / acceleration);
  const std::vector<double> stops = stops_of(s, {0, 1}, speed);
  ASSERT_EQ(stops.size(), 2U);
  for (const double y : stops) EXPECT_NEAR(y, expected, (s.end - s.begin) / 3000);
  EXPECT_TRUE(stops_of(s, {0, 1}, 2 * speed).empty());
}

TEST(Steering, DoesNothingWithoutAField) {
  Steering s = magnet(multipole(2, 0));
  Batch batch;
  fill(batch, 2);
  Batch before;
  before.copy_from(batch);
  EXPECT_EQ(kernel::steer(best_isa())(s, batch.view()), 0U);
  for (int i = 0; i < batch.view().count; ++i) {
    const BatchView &b = before.view(), &a = batch.view();
    EXPECT_EQ(a.vx[i], b.vx[i]);
    EXPECT_NEAR(a.x[i], b.x[i] + b.vx[i] * 0.2 / b.vy[i], 1e-15);
  }
}

TEST(Steering, OfParticlesThatMeetTheAxisEnds) {
  Steering s = magnet(multipole(1));
  Batch batch;
  fill(batch, 2);
  BatchView& v = batch.view();
  for (int i = 0; i < v.count; ++i) v.x[i] = v.z[i] = v.vx[i] = v.vz[i] = 0;
  for (int i = 0; i < v.count; i += 2) v.vx[i] = 3;  // along the axis, and through it
  EXPECT_EQ(kernel::steer(best_isa())(s, v), 0U);
  for (int i = 1; i < v.count; i += 2) EXPECT_EQ(v.x[i], 0);
  for (int i = 0; i < v.count; i += 2) EXPECT_TRUE(std::isfinite(v.x[i]));
}

}  // namespace
}  // namespace rabiline::steering_test
