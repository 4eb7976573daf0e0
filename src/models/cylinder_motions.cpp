#include "models/cylinder_motions.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "models/ode.hpp"

namespace rabiline::cylinder {
namespace {

/// sin(x)/x and (1 - cos x)/x, also where x is zero.
double sine_over(double x) { return x == 0 ? 1 : portable::sin(x) / x; }
double versine_over(double x) { return x == 0 ? 0 : 2 * portable::sin(x / 2) * portable::sin(x / 2) / x; }

std::vector<double> times_of(const RotatingCylinder& model) {
  return rabiline::times_of(model.duration, 0, model.samples).all;
}

/// What all the paper's solutions share: L and the spinning along the axis; the torque's impulse is L - L(0).
State fast_top(const Numbers& n, double time, const Vector3& axis, double growth) {
  State out;
  out.time = time;
  out.axis = axis;
  out.omega_3 = n.spin_rate * growth;
  out.angular_momentum = (n.angular_momentum * growth) * axis;
  out.impulse = out.angular_momentum - Vector3{0, 0, n.angular_momentum};
  out.work = 0.5 * n.longitudinal * n.spin_rate * n.spin_rate * (growth * growth - 1);
  return out;
}

State paper_at(const BodyFixedTorque& torque, const Numbers& n, double speed, double t) {
  const double angle = n.precession * t, c = portable::cos(angle), s = portable::sin(angle);
  State out = fast_top(n, t, {0, s, c}, 1);
  out.velocity = speed * Vector3{0, c, -s};
  out.position = (speed * t) * Vector3{0, sine_over(angle), -versine_over(angle)};
  out.torque = torque.size * Vector3{0, c, -s};
  out.omega_1 = -n.precession;
  out.turned = angle;
  return out;
}

/// L(t) = L(0) + M u t leaves z by atan(M t / L0) and grows.
State paper_at(const SpaceFixedTorque& torque, const Numbers& n, double speed, double t) {
  const double ratio = n.precession * t, growth = portable::hypot(1, ratio);
  const double c = 1 / growth, s = ratio / growth;
  State out = fast_top(n, t, {0, s, c}, growth);
  out.velocity = speed * Vector3{0, c, -s};
  out.position =
      (speed * t) * Vector3{0, ratio == 0 ? 1 : portable::asinh(ratio) / ratio, -ratio / (growth + 1)};
  out.torque = {0, torque.size, 0};
  out.omega_1 = -n.precession / (growth * growth);
  out.turned = portable::atan(ratio);
  return out;
}

/// The axis turns about u at M/L, and the frame back about the axis by the cosine of the angle between them,
/// since Omega_3 = 0: v(t) = v R_u(a) R_z(-b) y with a = M t/L and b = a cos(angle).
State paper_at(const FieldTorque& torque, const Numbers& n, double speed, double t) {
  const Vector3 u = pole_of(torque);
  const double rate = torque.size / n.angular_momentum, a = rate * t, b = a * portable::cos(torque.angle);
  State out = fast_top(n, t, turned_about(u, a, {0, 0, 1}), 1);
  out.velocity = speed * turned_about(u, a, {portable::sin(b), portable::cos(b), 0});
  // The mean over time of (1, cos a, sin a) times (sin b, cos b), by sums and differences of the angles.
  const double sum = a + b, difference = a - b;
  const double cos_cos = (sine_over(sum) + sine_over(difference)) / 2,
               sin_sin = (sine_over(difference) - sine_over(sum)) / 2,
               sin_cos = (versine_over(sum) + versine_over(difference)) / 2,
               cos_sin = (versine_over(sum) - versine_over(difference)) / 2;
  const auto mean_turned = [&](const Vector3& w, double plain, double with_cos, double with_sin) {
    const Vector3 along = dot(u, w) * u;
    return plain * along + with_cos * (w - along) + with_sin * cross(u, w);
  };
  out.position = (speed * t) * (mean_turned({1, 0, 0}, versine_over(b), cos_sin, sin_sin) +
                                mean_turned({0, 1, 0}, sine_over(b), cos_cos, sin_cos));
  out.torque = torque.size * cross(u, out.axis);
  out.omega_1 = -n.precession * portable::cos(b);
  out.omega_2 = -n.precession * portable::sin(b);
  out.turned = a;
  return out;
}

/// The state of (6) as a row of numbers of order 1.
struct Layout {
  static constexpr std::size_t turn = 0, omega_1 = 4, omega_2 = 5, omega_3 = 6, position = 7, impulse = 10,
                               work = 13, turned = 14, size = 15;
};

/// The frame X'Y'Z' in the laboratory, from a quaternion that need not be of length 1.
struct Frame {
  Vector3 e1, e2, e3;
  explicit Frame(std::span<const double> q) {
    const double norm = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    const double w = q[0], x = q[1], y = q[2], z = q[3], two = 2 / norm;
    e1 = {1 - two * (y * y + z * z), two * (x * y + w * z), two * (x * z - w * y)};
    e2 = {two * (x * y - w * z), 1 - two * (x * x + z * z), two * (y * z + w * x)};
    e3 = {two * (x * z + w * y), two * (y * z - w * x), 1 - two * (x * x + y * y)};
  }
  Vector3 components(const Vector3& a) const { return {dot(a, e1), dot(a, e2), dot(a, e3)}; }
  Vector3 in_space(const Vector3& a) const { return a.x * e1 + a.y * e2 + a.z * e3; }
};

/// [N m] The torque along e1, e2 and e3.
Vector3 torque_in(const Frame& frame, const CylinderTorque& torque) {
  if (const auto* field = std::get_if<FieldTorque>(&torque)) {
    const Vector3 u = frame.components(pole_of(torque));
    return {field->size * u.y, -field->size * u.x, 0};  // u x e3
  }
  if (const auto* fixed = std::get_if<SpaceFixedTorque>(&torque))
    return fixed->size * frame.components({0, 1, 0});
  return {0, size_of(torque), 0};
}

class EulerEquations {
 public:
  EulerEquations(const RotatingCylinder& model, const Numbers& n)
      : model_(model),
        n_(n),
        rate_(n.precession > 0 ? n.precession : 1),
        energy_(0.5 * n.longitudinal * n.spin_rate * n.spin_rate) {}

  std::vector<double> start() const {
    std::vector<double> y(Layout::size, 0.0);
    y[Layout::turn] = 1;
    y[Layout::omega_1] = start_rate(model_, n_) / rate_;
    y[Layout::omega_3] = 1;
    return y;
  }

  /// Eqs. 6 with omega_1 = Omega_1, omega_2 = Omega_2 and Omega_3 = 0.
  void operator()(std::span<const double> y, std::span<double> d) const {
    const Frame frame(y.subspan(Layout::turn, 4));
    const Vector3 m = torque_in(frame, model_.torque), space = frame.in_space(m);
    const double o1 = y[Layout::omega_1] * rate_, o2 = y[Layout::omega_2] * rate_,
                 o3 = y[Layout::omega_3] * n_.spin_rate, spinning = n_.longitudinal * o3;
    d[Layout::omega_1] = (m.x - spinning * o2) / n_.transverse / rate_;
    d[Layout::omega_2] = (m.y + spinning * o1) / n_.transverse / rate_;
    d[Layout::omega_3] = m.z / n_.angular_momentum;
    // dq/dt = q (0, o1, o2, 0) / 2
    d[0] = -0.5 * (y[1] * o1 + y[2] * o2);
    d[1] = 0.5 * (y[0] * o1 - y[3] * o2);
    d[2] = 0.5 * (y[0] * o2 + y[3] * o1);
    d[3] = 0.5 * (y[1] * o2 - y[2] * o1);
    put(d, Layout::position, (1 / model_.duration) * frame.e2);
    put(d, Layout::impulse, (1 / n_.angular_momentum) * space);
    d[Layout::work] = (m.x * o1 + m.y * o2 + m.z * o3) / energy_;
    d[Layout::turned] = turning(frame, o1, o2);
  }

  State state(double time, std::span<const double> y) const {
    const Frame frame(y.subspan(Layout::turn, 4));
    State out;
    out.time = time;
    out.position = (model_.speed * model_.duration) * get(y, Layout::position);
    out.velocity = model_.speed * frame.e2;
    out.axis = frame.e3;
    out.omega_1 = y[Layout::omega_1] * rate_;
    out.omega_2 = y[Layout::omega_2] * rate_;
    out.omega_3 = y[Layout::omega_3] * n_.spin_rate;
    out.angular_momentum = frame.in_space(
        {n_.transverse * out.omega_1, n_.transverse * out.omega_2, n_.longitudinal * out.omega_3});
    out.torque = frame.in_space(torque_in(frame, model_.torque));
    out.impulse = n_.angular_momentum * get(y, Layout::impulse);
    out.work = energy_ * y[Layout::work];
    out.turned = y[Layout::turned];
    return out;
  }

 private:
  static void put(std::span<double> d, std::size_t at, const Vector3& a) {
    d[at] = a.x;
    d[at + 1] = a.y;
    d[at + 2] = a.z;
  }
  static Vector3 get(std::span<const double> y, std::size_t at) { return {y[at], y[at + 1], y[at + 2]}; }

  /// How fast the axis turns about the pole. Under a torque that goes with the frame the pole does too.
  double turning(const Frame& frame, double o1, double o2) const {
    if (std::holds_alternative<BodyFixedTorque>(model_.torque)) return -o1;
    const Vector3 pole = pole_of(model_.torque), across = cross(pole, frame.e3);
    const double distance = dot(across, across);
    return distance > 0 ? dot(pole, o1 * frame.e1 + o2 * frame.e2) / distance : 0;
  }

  const RotatingCylinder& model_;
  const Numbers& n_;
  double rate_, energy_;  // what the row's rates and work are divided by
};

}  // namespace

double size_of(const CylinderTorque& torque) {
  return std::visit([](const auto& any) { return any.size; }, torque);
}

Vector3 pole_of(const CylinderTorque& torque) {
  const auto* field = std::get_if<FieldTorque>(&torque);
  if (!field) return {-1, 0, 0};
  return {-portable::sin(field->angle), 0, portable::cos(field->angle)};
}

Numbers numbers_of(const RotatingCylinder& model) {
  Numbers n;
  const double r2 = model.radius * model.radius, l2 = model.length * model.length;
  n.transverse = model.mass * (r2 / 4 + l2 / 12);
  n.longitudinal = model.mass * r2 / 2;
  n.spin_rate = constants::two_pi * model.spin;
  n.angular_momentum = n.longitudinal * n.spin_rate;
  n.torque = size_of(model.torque);
  if (const auto* field = std::get_if<FieldTorque>(&model.torque)) n.torque *= portable::sin(field->angle);
  n.precession = n.torque / n.angular_momentum;
  n.nutation_rate = n.angular_momentum / n.transverse;
  n.fast_top = n.precession / n.nutation_rate;
  if (n.precession > 0) n.radius = model.speed / n.precession;
  return n;
}

double steady_rate(const RotatingCylinder& model, const Numbers& n) {
  const auto* field = std::get_if<FieldTorque>(&model.torque);
  if (!field) return n.precession;
  // I1 cos(angle) W^2 - L W + M = 0, the slow root, which tends to M/L.
  const double discriminant =
      n.angular_momentum * n.angular_momentum - 4 * n.transverse * field->size * portable::cos(field->angle);
  return discriminant < 0 ? 0 : 2 * field->size / (n.angular_momentum + std::sqrt(discriminant));
}

double start_rate(const RotatingCylinder& model, const Numbers& n) {
  if (model.axis_start == AxisStart::at_rest) return 0;
  const auto* field = std::get_if<FieldTorque>(&model.torque);
  return -steady_rate(model, n) * (field ? portable::sin(field->angle) : 1);
}

std::vector<State> paper(const RotatingCylinder& model, const Numbers& n) {
  std::vector<State> out;
  for (const double t : times_of(model))
    out.push_back(
        std::visit([&](const auto& torque) { return paper_at(torque, n, model.speed, t); }, model.torque));
  return out;
}

std::vector<State> euler(const RotatingCylinder& model, const Numbers& n) {
  const EulerEquations equations(model, n);
  const std::vector<double> times = times_of(model);
  const auto rows =
      integrate([&](double, std::span<const double> y, std::span<double> d) { equations(y, d); },
                equations.start(), times, 1e-14);
  std::vector<State> out;
  for (std::size_t i = 0; i < times.size(); ++i) out.push_back(equations.state(times[i], rows[i]));
  return out;
}

Rates linear_solution(const RotatingCylinder& model, const Numbers& n, double time) {
  if (model.axis_start == AxisStart::precessing) return {-n.precession, 0};
  const double phase = n.nutation_rate * time;
  return {-n.precession * (1 - portable::cos(phase)), n.precession * portable::sin(phase)};
}

}  // namespace rabiline::cylinder
