#include "models/rotating_cylinder.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "models/cylinder_motions.hpp"
#include "models/faults.hpp"
#include "models/findings.hpp"

namespace rabiline {
namespace {

using cylinder::Numbers;
using cylinder::State;

/// Whether the paper's solution is a circle: where the torque stays across the plane that the axis turns in.
bool is_circle(const CylinderTorque& torque) {
  if (const auto* field = std::get_if<FieldTorque>(&torque))
    return std::abs(portable::cos(field->angle)) < 1e-12;
  return std::holds_alternative<BodyFixedTorque>(torque);
}

/// The paper's circle, eqs. 14 and 32: about a centre below the start, turned about -x.
struct Circle {
  double radius;
  Vector3 from_centre(const State& s) const { return s.position - Vector3{0, 0, -radius}; }
  double distance(const State& s) const { return length_of(from_centre(s)); }
  /// P_theta = m r^2 dtheta/dt, eq. 20.
  double angular(const State& s, double mass) const {
    return mass * dot(cross(from_centre(s), s.velocity), {-1, 0, 0});
  }
  /// H = P_r^2/2m + P_theta^2/2mr^2, eq. 23.
  double hamiltonian(const State& s, double mass) const {
    const double r = distance(s);
    const double v_r = dot(from_centre(s), s.velocity) / r, p = angular(s, mass);
    return 0.5 * mass * v_r * v_r + p * p / (2 * mass * r * r);
  }
};

double rotational_energy(const Numbers& n, const State& s) {
  return 0.5 * (n.transverse * (s.omega_1 * s.omega_1 + s.omega_2 * s.omega_2) +
                n.longitudinal * s.omega_3 * s.omega_3);
}

template <class Value>
auto collect(const std::vector<State>& states, Value value) {
  std::vector<decltype(value(states.front()))> out;
  out.reserve(states.size());
  for (const State& s : states) out.push_back(value(s));
  return out;
}
template <class Value>
double largest(const std::vector<State>& states, Value value) {
  double out = 0;
  for (const State& s : states) out = std::max(out, std::abs(value(s)));
  return out;
}

/// Puts the states of one set of equations into columns, with all that is asked about them.
class CylinderMotion {
 public:
  CylinderMotion(const RotatingCylinder& model, const Numbers& n, const std::vector<State>& reference)
      : model_(model), n_(n), reference_(reference) {}

  Motion write(std::string name, std::string meaning, const std::vector<State>& states) const {
    Motion out{std::move(name), std::move(meaning)};
    out.time = collect(states, [](const State& s) { return s.time; });
    out.position = collect(states, [](const State& s) { return s.position; });
    out.vectors = {
        {"velocity", "m/s", "velocity", collect(states, [](const State& s) { return s.velocity; })},
        {"axis", "1", "axis of the cylinder, e3", collect(states, [](const State& s) { return s.axis; })},
        {"angular_momentum", "kg m2/s", "internal angular momentum",
         collect(states, [](const State& s) { return s.angular_momentum; })},
        {"torque", "N m", "torque", collect(states, [](const State& s) { return s.torque; })},
    };
    Course nutation{"nutation", "rad", "angle of the axis from that of the fast top"};
    Course apart{"distance", "m", "distance from the path of the paper"};
    for (std::size_t i = 0; i < states.size(); ++i) {
      nutation.values.push_back(angle_between(states[i].axis, reference_[i].axis));
      apart.values.push_back(length_of(states[i].position - reference_[i].position));
    }
    out.numbers = {std::move(nutation), std::move(apart)};
    const auto add = [&](const char* course, const char* unit, const char* about, auto value) {
      out.numbers.push_back({course, unit, about, collect(states, value)});
    };
    add("speed", "m/s", "size of the velocity", [](const State& s) { return length_of(s.velocity); });
    add("tilt", "rad", "angle of the axis from the internal angular momentum",
        [](const State& s) { return angle_between(s.axis, s.angular_momentum); });
    add("omega_1", "rad/s", "rate of the frame about e1", [](const State& s) { return s.omega_1; });
    add("omega_2", "rad/s", "rate of the frame about e2", [](const State& s) { return s.omega_2; });
    add("spin", "Hz", "turns per second about the axis",
        [](const State& s) { return s.omega_3 / constants::two_pi; });
    add("size_of_angular_momentum", "kg m2/s", "size of the internal angular momentum",
        [](const State& s) { return length_of(s.angular_momentum); });
    add("torque_along_axis", "N m", "part of the torque along the axis, which the paper supposes to be none",
        [](const State& s) { return dot(s.torque, s.axis); });
    add("rotational_energy", "J", "energy of the rotation",
        [&](const State& s) { return rotational_energy(n_, s); });
    if (n_.radius > 0 && is_circle(model_.torque)) {
      const Circle circle{n_.radius};
      add("radius", "m", "distance from the centre of the paper's circle",
          [&](const State& s) { return circle.distance(s); });
      add("p_theta", "kg m2/s", "P_theta = m r^2 dtheta/dt about that centre",
          [&](const State& s) { return circle.angular(s, model_.mass); });
      add("hamiltonian", "J", "H = P_r^2/2m + P_theta^2/2mr^2 about that centre",
          [&](const State& s) { return circle.hamiltonian(s, model_.mass); });
    }
    return out;
  }

 private:
  const RotatingCylinder& model_;
  const Numbers& n_;
  const std::vector<State>& reference_;
};

/// What can be held against a closed form, against the paper, or against a conservation law.
class CylinderFindings : private Findings {
 public:
  CylinderFindings(const RotatingCylinder& model, const Numbers& n, const std::vector<State>& paper,
                   const std::vector<State>& euler)
      : model_(model), n_(n), paper_(paper), euler_(euler) {}

  std::vector<Finding> all() {
    assumption();
    if (n_.radius > 0 && is_circle(model_.torque)) path();
    conserved("speed_drift", "m/s",
              largest(euler_, [&](const State& s) { return length_of(s.velocity) - model_.speed; }),
              "largest change of the speed, which (6) keeps, as the velocity only turns");
    conservation();
    suppositions();
    return take();
  }

 private:
  void assumption() {
    double apart = 0, turned = 0;
    for (std::size_t i = 0; i < euler_.size(); ++i) {
      apart = std::max(apart, length_of(euler_[i].position - paper_[i].position));
      turned = std::max(turned, angle_between(euler_[i].axis, paper_[i].axis));
    }
    if (n_.radius > 0)
      supposed("path_distance", "1", apart / n_.radius, 0,
               "largest distance between the paths of `euler` and `paper` over v/Omega: how far the fast top "
               "fails");
    supposed("axis_distance", "rad", turned, 0, "largest angle between the axes of `euler` and `paper`");
    supposed("fast_top", "1", n_.fast_top, 0, "M I1/L^2, which the fast top takes for nothing");
    precession();
    if (std::holds_alternative<BodyFixedTorque>(model_.torque)) linear();
  }

  /// An axis that starts precessing goes on steadily, but where the torque stands in space.
  void precession() {
    const double rate = euler_.back().turned / model_.duration, fast = paper_.back().turned / model_.duration;
    if (std::holds_alternative<BodyFixedTorque>(model_.torque) && model_.axis_start == AxisStart::at_rest &&
        fast > 0) {
      // The mean of omega_1 = -(M/L)(1 - cos kt).
      const double phase = n_.nutation_rate * model_.duration;
      return closed_form(
          "precession", "rad/s", rate, fast * (1 - portable::sin(phase) / phase),
          "mean rate of the axis about its pole: that of the fast top, less what is left of a nod");
    }
    const bool steady = model_.axis_start == AxisStart::precessing &&
                        !std::holds_alternative<SpaceFixedTorque>(model_.torque);
    add(steady ? Expectation::closed_form : Expectation::approximate, "precession", "rad/s", rate,
        steady ? fast * steady_over_fast() : fast,
        "mean rate of the axis about its pole; expected is that of steady precession, or of the fast top");
  }
  double steady_over_fast() const {
    const double size = cylinder::size_of(model_.torque);
    return std::holds_alternative<FieldTorque>(model_.torque) && size > 0
               ? cylinder::steady_rate(model_, n_) * n_.angular_momentum / size
               : 1;
  }

  /// Under a torque along e2 eqs. 6 are linear, and solved in closed form.
  void linear() {
    const bool at_rest = model_.axis_start == AxisStart::at_rest;
    closed_form("rates", "rad/s",
                largest(euler_,
                        [&](const State& s) {
                          const cylinder::Rates exact = cylinder::linear_solution(model_, n_, s.time);
                          return portable::hypot(s.omega_1 - exact.omega_1, s.omega_2 - exact.omega_2);
                        }),
                0, "largest distance of omega_1 and omega_2 from the closed solution of (6)");
    closed_form("tilt", "rad",
                largest(euler_, [](const State& s) { return angle_between(s.axis, s.angular_momentum); }),
                portable::atan((at_rest ? 2 : 1) * n_.fast_top),
                "largest angle of the axis from the angular momentum, whose closed form needs many samples");
  }

  void path() {
    const Circle circle{n_.radius};
    double mean = 0;
    for (const State& s : euler_) mean += circle.distance(s) / static_cast<double>(euler_.size());
    supposed("radius", "m", mean, n_.radius,
             "mean distance of `euler` from the centre of the circle; the paper has v/Omega");
    const double p = model_.mass * n_.radius * model_.speed,
                 h = 0.5 * model_.mass * model_.speed * model_.speed;
    const bool circles = std::holds_alternative<BodyFixedTorque>(model_.torque);
    for (const auto& [name, states] : {std::pair{"paper", &paper_}, std::pair{"euler", &euler_}}) {
      const Expectation expectation =
          circles && states == &paper_ ? Expectation::conserved : Expectation::supposed;
      add(expectation, fmt::format("p_theta_drift_{}", name), "1",
          largest(*states, [&](const State& s) { return circle.angular(s, model_.mass) / p - 1; }), 0,
          fmt::format("largest change of P_theta under `{}`, over m r v", name));
      add(expectation, fmt::format("hamiltonian_drift_{}", name), "1",
          largest(*states, [&](const State& s) { return circle.hamiltonian(s, model_.mass) / h - 1; }), 0,
          fmt::format("largest change of H under `{}`, over m v^2/2", name));
    }
  }

  void conservation() {
    const double energy = rotational_energy(n_, euler_.front());
    const double scale = largest(euler_, [&](const State& s) { return rotational_energy(n_, s); });
    const double l = largest(euler_, [](const State& s) { return length_of(s.angular_momentum); });
    const Vector3 momentum = euler_.front().angular_momentum;
    conserved(
        "energy_balance", "1",
        largest(euler_, [&](const State& s) { return (rotational_energy(n_, s) - energy - s.work) / scale; }),
        "largest difference of rotational energy and work, over the largest energy");
    conserved(
        "angular_momentum_balance", "1",
        largest(euler_,
                [&](const State& s) { return length_of(s.angular_momentum - momentum - s.impulse) / l; }),
        "largest difference of L and the impulse of the torque, over the largest L");
    if (!std::holds_alternative<FieldTorque>(model_.torque)) return;
    const Vector3 u = cylinder::pole_of(model_.torque);
    const double size = cylinder::size_of(model_.torque);
    conserved("energy_with_field", "1",
              largest(euler_,
                      [&](const State& s) {
                        return (rotational_energy(n_, s) - energy + size * (dot(u, s.axis) - u.z)) / scale;
                      }),
              "largest change of rotational energy + M u.e3, over the largest energy");
    conserved("angular_momentum_along_field", "1",
              largest(euler_, [&](const State& s) { return dot(u, s.angular_momentum - momentum) / l; }),
              "largest change of L.u, over the largest L");
  }

  void suppositions() {
    supposed("growth", "1",
             length_of(euler_.back().angular_momentum) / length_of(euler_.front().angular_momentum) - 1, 0,
             "growth of |L| until the end, which the paper supposes to be none");
    supposed("spin_drift", "1", largest(euler_, [&](const State& s) { return s.omega_3 / n_.spin_rate - 1; }),
             0, "largest change of the spinning, which the paper supposes to be none");
    const double size = cylinder::size_of(model_.torque);
    if (size > 0)
      supposed("torque_along_axis", "1",
               largest(euler_, [&](const State& s) { return dot(s.torque, s.axis) / size; }), 0,
               "largest part of the torque along the axis, which the paper supposes to be none");
  }

  const RotatingCylinder& model_;
  const Numbers& n_;
  const std::vector<State>&paper_, &euler_;
};

/// What bounds the work of the integration: the angle that the fastest motion turns by.
double phase_of(const RotatingCylinder& model, const Numbers& n) {
  const double size = cylinder::size_of(model.torque), t = model.duration;
  const double nodding = std::min(2 * size / n.angular_momentum, size * t / n.transverse);
  const double growth =
      std::holds_alternative<SpaceFixedTorque>(model.torque) ? size * t / n.longitudinal : 0;
  return (n.nutation_rate * (1 + growth / n.spin_rate) + nodding + growth) * t;
}

constexpr double longest_phase = 1e6;  // [rad] some ten seconds of computing

}  // namespace

ModelResult solve(const RotatingCylinder& model) {
  refuse(faults_of(model));
  const Numbers n = cylinder::numbers_of(model);
  const std::vector<State> paper = cylinder::paper(model, n), euler = cylinder::euler(model, n);
  std::vector<State> standard = euler;
  for (State& s : standard) {
    s.velocity = {0, model.speed, 0};
    s.position = {0, model.speed * s.time, 0};
  }
  const CylinderMotion motion(model, n, paper);
  ModelResult out;
  out.motions.push_back(motion.write(
      "paper",
      "the paper's solution, with the angular momentum along the axis (fast top); that the velocity "
      "turns jointly with the axis is its hypothesis",
      paper));
  out.motions.push_back(motion.write(
      "euler",
      "the modified Euler equations (6), integrated; that the velocity turns jointly with the frame "
      "of the axis is the paper's hypothesis",
      euler));
  out.motions.push_back(motion.write(
      "standard",
      "established mechanics: a torque alone moves no centre of mass, which flies straight; the axis "
      "moves as in `euler`",
      standard));
  out.findings = CylinderFindings(model, n, paper, euler).all();
  return out;
}

std::vector<Fact> facts_of(const RotatingCylinder& model) {
  const Numbers n = cylinder::numbers_of(model);
  const auto number = [](double x, const char* unit) { return fmt::format("{:.6g} {}", x, unit); };
  std::vector<Fact> out{
      {"I1", number(n.transverse, "kg m2"), "moment of inertia across the axis"},
      {"I3", number(n.longitudinal, "kg m2"), "moment of inertia about the axis"},
      {"L", number(n.angular_momentum, "kg m2/s"), "internal angular momentum"},
      {"Omega", number(n.precession, "rad/s"), "M/L, the paper's precession"},
  };
  if (n.precession > 0)
    out.push_back({"period", pretty_quantity(constants::two_pi / n.precession, Dimension::time),
                   fmt::format("of one circle; the run lasts {:.4g} of them",
                               model.duration * n.precession / constants::two_pi)});
  if (n.radius > 0)
    out.push_back(
        {"r", pretty_quantity(n.radius, Dimension::length), "v/Omega, radius of the paper's circle"});
  const bool at_rest = model.axis_start == AxisStart::at_rest;
  out.push_back(
      {"fast top", fmt::format("{:.4g}", n.fast_top), "M I1/L^2: the paper's solution wants it far below 1"});
  out.push_back({"nutation", pretty_quantity(n.nutation_rate / constants::two_pi, Dimension::frequency),
                 at_rest ? fmt::format("up to {} from the precession, for a fast top",
                                       pretty_quantity(2 * n.fast_top, Dimension::angle))
                         : "none to first order: the axis starts with its precession"});
  if (std::holds_alternative<FieldTorque>(model.torque))
    out.push_back({"steady", number(cylinder::steady_rate(model, n), "rad/s"),
                   "precession about the field without nutation; 0 where there is none"});
  return out;
}

std::vector<Fault> faults_of(const RotatingCylinder& model) {
  const Numbers n = cylinder::numbers_of(model);
  std::vector<Fault> out;
  if (!std::isfinite(phase_of(model, n)) || phase_of(model, n) > longest_phase)
    out.push_back(
        {"model", "duration",
         fmt::format("the cylinder turns and nods by {:.2g} rad in {}, more than {:.0e} rad can be "
                     "followed",
                     phase_of(model, n), pretty_quantity(model.duration, Dimension::time), longest_phase),
         "take a shorter `duration`, a slower `spin` or a weaker torque"});
  const bool asks_steady = model.axis_start == AxisStart::precessing && cylinder::size_of(model.torque) > 0;
  if (asks_steady && cylinder::steady_rate(model, n) == 0)
    out.push_back({"model", "axis_start",
                   "this cylinder spins too slowly for a precession without nutation: L^2 < 4 M I1 cos",
                   "write `axis_start: at_rest`, or let it spin faster"});
  return out;
}

}  // namespace rabiline
