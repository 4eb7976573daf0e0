// Closed forms and slow steps through fields that turn the velocity, against an independent integration.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/independent.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::courses_test {
namespace {

constexpr double field_begin = 0.3;

/// A uniform field with one that rotates in it, as drawn at random.
struct Setting {
  Sense sense = Sense::co;
  double gamma = gamma_n, b = 10e-3, h0 = 0.3e-6, frequency = 0, phase = 0, length = 0.1;
  DoradoLaw law;
  StartSpin spin = PolarisedSpin{{0, 0, 1}, 1};
  SourceTilt tilt{};
};

Beamline beamline_of(const Setting& s) {
  Beamline b = suggested(s.frequency, s.h0);
  Species species = neutron();
  species.gyromagnetic_ratio = s.gamma;
  b.species = {{species, 1}};
  b.law = s.law;
  b.chamber.reset();
  b.source.speed = SingleSpeed{1000};
  b.source.spin = s.spin;
  b.source.tilt = s.tilt;
  RotatingField h0 = std::get<RotatingField>(b.parts.at(2).part);
  h0.length = s.length;
  h0.sense = s.sense;
  h0.phase = {Phase::Kind::angle, s.phase};
  b.parts = {place("B", field_begin, UniformField{s.length, s.b, {}}), place("H0", field_begin, h0),
             place("screen", 1.2, Detector{Rectangle{4e-3, 4e-3}, {1, 1}, {}})};
  return b;
}

Motion motion_at(const Track& t, std::size_t i) {
  return {t.t[i], {t.x[i], t.y[i], t.z[i]}, {t.vx[i], t.vy[i], t.vz[i]}, {t.sx[i], t.sy[i], t.sz[i]}};
}
double distance(const Vec& a, const Vec& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// The largest distance of the path from the independent integration over its length, and that of the
/// direction where it ends.
struct Deviation {
  double place = 0, direction = 0, speed = 0, spin = 0;
};
Deviation deviation(const Setting& s, const Track& track, double gamma_scale = 1) {
  const double sense = (s.gamma > 0) == (s.sense == Sense::co) ? -1 : 1;
  Integrator integrator({gamma_scale * s.gamma, s.b, s.h0, sense * two_pi * s.frequency, s.phase, s.law.kappa,
                         s.law.closure == Closure::torque},
                        1e-12);
  std::size_t first = 0;
  while (track.y.at(first) < field_begin) ++first;
  std::size_t last = first;
  const auto inside = [&](double y) { return y >= field_begin && y <= field_begin + s.length; };
  while (last + 1 < track.y.size() && inside(track.y[last + 1])) ++last;
  Motion m = motion_at(track, first);
  const double speed = std::hypot(m.v[0], m.v[1], m.v[2]);
  Deviation found;
  const std::size_t stride = std::max<std::size_t>(1, (last - first) / 20);
  for (std::size_t i = first; i < last;) {
    i = std::min(i + stride, last);
    const Motion here = motion_at(track, i);
    m = integrator.to(here.t, m);
    found.place = std::max(found.place, distance(m.r, here.r));
    found.direction = distance(m.v, here.v) / speed;
    found.speed = std::max(found.speed, std::abs(std::hypot(here.v[0], here.v[1], here.v[2]) / speed - 1));
    found.spin = std::max(found.spin, std::abs(std::hypot(here.s[0], here.s[1], here.s[2]) - 1));
  }
  found.place /= speed * std::max(m.t - track.t[first], 1e-12);
  return found;
}

class Settings {
 public:
  explicit Settings(unsigned seed) : random_(seed) {}
  double even(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }
  double in_ratio(double low, double high) { return low * std::pow(high / low, even(0, 1)); }

  Setting draw() {
    Setting s;
    s.gamma = (even(0, 1) < 0.5 ? -1 : 1) * in_ratio(0.3, 1.5) * std::abs(gamma_n);
    s.b = in_ratio(1e-3, 15e-3);
    s.length = in_ratio(0.02, 0.2);
    const double larmor = std::abs(s.gamma) * s.b / two_pi, time = s.length / 1000;
    s.h0 = in_ratio(1e-3, two_pi) / (std::abs(s.gamma) * time);
    s.h0 = std::min(s.h0, 0.1 * s.b);
    const double offsets[] = {0, 300, -1000, 5e3, -15e3, 50e3};
    s.frequency = std::max(1e3, larmor + offsets[static_cast<int>(even(0, 6))]);
    s.phase = even(0, two_pi);
    if (even(0, 1) < 0.1) s.sense = Sense::counter;
    s.law.closure = even(0, 1) < 0.75 ? Closure::torque : Closure::larmor;
    s.law.kappa = even(-1.9, 1.9);
    if (s.law.closure == Closure::larmor) s.law.kappa *= in_ratio(1e-4, 1);
    if (s.law.closure == Closure::torque && even(0, 1) < 0.6) s.law.kappa = 1;
    if (even(0, 1) < 0.3) s.spin = PolarisedSpin{{0, 0, -1}, 1};
    if (even(0, 1) < 0.3) s.spin = PolarisedSpin{{std::sin(0.7), 0, std::cos(0.7)}, 1};
    s.tilt = {even(-0.1, 0.1), even(-0.3, 0.3)};
    return s;
  }

 private:
  std::mt19937_64 random_;
};

TEST(Courses, AgreeWithAnIndependentIntegrationAtThreeHundredRandomSettings) {
  Settings settings(1938);
  int seen = 0;
  for (int i = 0; i < 300; ++i) {
    const Setting s = settings.draw();
    const Track track = trace(beamline_of(s), 0, best_isa());
    const Deviation found = deviation(s, track);
    const std::string what =
        fmt::format("{}: {} kappa {}, gamma {:.3g}, {:.3g} T, {:.3g} T at {:.6g} Hz, {:.3g} m", i,
                    s.law.closure == Closure::torque ? "torque" : "larmor", s.law.kappa, s.gamma, s.b, s.h0,
                    s.frequency, s.length);
    EXPECT_LT(found.place, s.law.path_error) << what;
    EXPECT_LT(found.direction, 10 * s.law.path_error) << what;
    EXPECT_LT(found.speed, 1e-12) << what;
    EXPECT_LT(found.spin, 1e-12) << what;
    seen += deviation(s, track, 1.01).place > s.law.path_error ? 1 : 0;
  }
  EXPECT_GT(seen, 200) << "a gamma off by 1 % must show";
}

TEST(Courses, KeepTheErrorThatIsAskedFor) {
  for (const double path_error : {1e-4, 1e-9}) {
    Settings settings(7);
    for (int i = 0; i < 60; ++i) {
      Setting s = settings.draw();
      s.law.path_error = path_error;
      if (s.law.closure == Closure::torque) s.law.kappa = 1;
      const Deviation found = deviation(s, trace(beamline_of(s), 0, best_isa()));
      EXPECT_LT(found.place, path_error) << i;
    }
  }
}

TEST(Courses, KeepTheErrorForSlowParticlesOfAWideBeamToo) {
  Settings settings(12);
  for (int i = 0; i < 30; ++i) {
    Setting s = settings.draw();
    s.law = {};
    s.spin = PolarisedSpin{{0, 0, -1}, 1};
    s.tilt = {};
    Beamline b = beamline_of(s);
    b.source.speed = GaussianSpeed{1000, 220};
    for (std::uint64_t particle = 0; particle < 20; ++particle)
      EXPECT_LT(deviation(s, trace(b, particle, best_isa())).place, s.law.path_error)
          << i << ", " << particle;
  }
}

}  // namespace
}  // namespace rabiline::test::courses_test
