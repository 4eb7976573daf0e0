#include "models/bound_charge.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "core/units.hpp"
#include "models/faults.hpp"
#include "models/findings.hpp"
#include "models/measure.hpp"
#include "models/ode.hpp"

namespace rabiline {
namespace {

using constants::two_pi;

constexpr double most_orbits = 1e5, fastest = 0.05;  // of the speed of light
constexpr Vector3 z{0, 0, 1};

enum class Force { harmonic, coulomb, none };

/// The start in SI.
struct Orbit {
  Force force = Force::none;
  double mass = 0, charge = 0;
  double omega = 0;   // [rad/s] of the orbit without the field; of a free charge, of its turn in it
  double radius = 0;  // [m]
  double larmor = 0;  // [rad/s] w = -q B/2m about +z, right-handed: what L turns with
  Vector3 r{}, v{};   // [m], [m/s]
  bool bound() const { return force != Force::none; }
};

/// k of the force k/r^2 towards the centre, over the mass [m^3/s^2]; negative where it repels.
double attraction(const CoulombBinding& binding, const Species& s) {
  return -binding.charge * s.charge / (2 * two_pi * constants::vacuum_permittivity * s.mass);
}

Orbit orbit_of(const BoundCharge& model) {
  const Species& s = model.species.front().species;
  Orbit o;
  o.mass = s.mass, o.charge = s.charge;
  o.larmor = -s.charge * model.field / (2 * s.mass);
  double speed = 0;
  if (const auto* harmonic = std::get_if<HarmonicBinding>(&model.binding)) {
    o.force = Force::harmonic;
    o.omega = two_pi * harmonic->frequency;
    o.radius = harmonic->radius;
    speed = o.omega * o.radius;
  } else if (const auto* coulomb = std::get_if<CoulombBinding>(&model.binding)) {
    o.force = Force::coulomb;
    o.radius = coulomb->radius;
    speed = std::sqrt(attraction(*coulomb, s) / o.radius);
    o.omega = speed / o.radius;
  } else {
    speed = std::get<NoBinding>(model.binding).speed;
    o.omega = 2 * std::abs(o.larmor);
    o.radius = speed / o.omega;
  }
  // sin(pi) is 1e-16, and an orbit across the field stays there.
  const double sine =
      std::abs(model.inclination - std::numbers::pi) < 1e-15 ? 0 : portable::sin(model.inclination);
  o.r = o.bound() ? Vector3{o.radius, 0, 0} : Vector3{};
  o.v = speed * Vector3{0, portable::cos(model.inclination), sine};
  return o;
}

/// Places and velocities at all times.
struct OrbitPath {
  std::vector<Vector3> r{}, v{};
};

/// d2r/dt2 = -(what binds it) + (q/m) v x B, with (q/m) v x B = 2 w z x v; in units of radius and 1/omega.
OrbitPath fly(const Orbit& o, double larmor, const Vector3& v, const std::vector<double>& times) {
  const double w = larmor / o.omega, speed = o.radius * o.omega;
  std::vector<double> scaled;
  scaled.reserve(times.size());
  for (const double t : times) scaled.push_back(o.omega * t);
  const auto rows = integrate(
      [&](double, std::span<const double> y, std::span<double> d) {
        const Vector3 place{y[0], y[1], y[2]}, u{y[3], y[4], y[5]};
        const double square = dot(place, place);
        const double pull = o.force == Force::harmonic  ? 1
                            : o.force == Force::coulomb ? 1 / (square * std::sqrt(square))
                                                        : 0;
        const Vector3 a = 2 * w * cross(z, u) - pull * place;
        d[0] = u.x, d[1] = u.y, d[2] = u.z;
        d[3] = a.x, d[4] = a.y, d[5] = a.z;
      },
      {o.r.x / o.radius, o.r.y / o.radius, o.r.z / o.radius, v.x / speed, v.y / speed, v.z / speed}, scaled,
      1e-14);
  OrbitPath path;
  for (const auto& y : rows) {
    path.r.push_back(o.radius * Vector3{y[0], y[1], y[2]});
    path.v.push_back(speed * Vector3{y[3], y[4], y[5]});
  }
  return path;
}

/// The orbit without the field, turned with w about z: the start is the same, since v = v' + w x r'.
OrbitPath fly_turned(const Orbit& o, double w, const std::vector<double>& times) {
  OrbitPath path = fly(o, 0, o.v - w * cross(z, o.r), times);
  for (std::size_t i = 0; i < times.size(); ++i) {
    path.v[i] = turned_about(z, w * times[i], path.v[i] + w * cross(z, path.r[i]));
    path.r[i] = turned_about(z, w * times[i], path.r[i]);
  }
  return path;
}

/// In the frame that turns with w the harmonic binding is an oscillator of sqrt(omega^2 + w^2) along x and y
/// (the Lorentz and the centrifugal force leave m w^2 rho), of omega along z. Exact.
Vector3 harmonic_place(const Orbit& o, double t) {
  const double w = o.larmor, across = portable::hypot(o.omega, w);
  const Vector3 start = o.v - w * cross(z, o.r);
  const Vector3 seen{o.r.x * portable::cos(across * t), start.y / across * portable::sin(across * t),
                     o.v.z / o.omega * portable::sin(o.omega * t)};
  return turned_about(z, w * t, seen);
}

double energy(const Orbit& o, const Vector3& r, const Vector3& v) {
  const double square = o.omega * o.omega, kinetic = o.mass / 2 * dot(v, v);
  if (o.force == Force::harmonic) return kinetic + o.mass / 2 * square * dot(r, r);
  if (o.force == Force::coulomb) return kinetic - o.mass * square * portable::pow(o.radius, 3) / length_of(r);
  return kinetic;
}
Vector3 angular_momentum(const Orbit& o, const Vector3& r, const Vector3& v) { return o.mass * cross(r, v); }
/// r x (m v + q A) with A = B x r/2; its z part is conserved.
Vector3 canonical(const Orbit& o, const Vector3& r, const Vector3& v) {
  return angular_momentum(o, r, v - o.larmor * cross(z, r));
}

double turns_of(const BoundCharge& model, const Orbit& o) {
  return model.orbits * (1 + 2 * std::abs(o.larmor) / o.omega);
}
Times times_of(const BoundCharge& model, const Orbit& o) {
  return rabiline::times_of(two_pi / o.omega * model.orbits, turns_of(model, o), model.samples);
}

Motion motion_of(const Orbit& o, const OrbitPath& path, const Times& times, std::string name,
                 std::string meaning) {
  Motion out{std::move(name), std::move(meaning), {}, {}, {}, {}};
  VectorCourse velocity{"velocity", "m/s", "of the charge"},
      kinetic{"angular_momentum", "kg m2/s", "L = r x m v"},
      whole{"canonical_angular_momentum", "kg m2/s", "r x (m v + q A), A = B x r/2"};
  Course turned{"precession", "rad", "how far L has turned about z"},
      total{"energy", "J", "kinetic and potential"};
  std::vector<Vector3> momenta;
  for (std::size_t i = 0; i < path.r.size(); ++i)
    momenta.push_back(angular_momentum(o, path.r[i], path.v[i]));
  const std::vector<double> angles = angles_about(z, momenta);
  for (std::size_t i = 0; i < times.all.size(); i += times.stride) {
    out.time.push_back(times.all[i]);
    out.position.push_back(path.r[i]);
    velocity.values.push_back(path.v[i]);
    kinetic.values.push_back(momenta[i]);
    turned.values.push_back(angles[i]);
    whole.values.push_back(canonical(o, path.r[i], path.v[i]));
    total.values.push_back(energy(o, path.r[i], path.v[i]));
  }
  out.vectors = {std::move(velocity), std::move(kinetic), std::move(whole)};
  if (o.bound()) out.numbers.push_back(std::move(turned));
  out.numbers.push_back(std::move(total));
  return out;
}

/// What is conserved: the energy, since a magnetic field does no work, and the canonical L_z.
void find_conserved(const Orbit& o, const OrbitPath& path, Findings& out) {
  std::vector<double> energies, momenta;
  for (std::size_t i = 0; i < path.r.size(); ++i) {
    energies.push_back(energy(o, path.r[i], path.v[i]));
    momenta.push_back(canonical(o, path.r[i], path.v[i]).z);
  }
  const double speed = length_of(o.v);
  out.conserved("energy_drift", "1", largest_change(energies) / (o.mass / 2 * speed * speed),
                "largest change of the energy, over the kinetic energy at the start");
  out.conserved("canonical_drift", "1", largest_change(momenta) / (o.mass * speed * o.radius),
                "largest change of the canonical L_z = (r x m v)_z + q B rho^2/2, over m v r");
}

/// How L precesses, in the mean over orbits, and what eq. 74 makes of it.
void find_precession(const Orbit& o, const OrbitPath& path, const std::vector<double>& times,
                     double inclination, Findings& out) {
  constexpr double fewest = 9.5;  // orbits that have a mean
  const double small = std::abs(o.larmor) / o.omega, orbits = times.back() * o.omega / two_pi;
  // Within an orbit L nods by about w/omega: an axis that near to z has no azimuth.
  if (small > 0.1 || portable::sin(inclination) < 10 * small || !(portable::sin(inclination) > 1e-6) ||
      orbits < fewest)
    return;
  std::vector<Vector3> momenta;
  for (std::size_t i = 0; i < path.r.size(); ++i)
    momenta.push_back(angular_momentum(o, path.r[i], path.v[i]));
  const double rate = mean_rate(times, angles_about(z, momenta));
  // To second order the field adds m w^2 rho^2/2 to the energy, on a circle in the mean
  // m w^2 r^2 (1 + cos^2 i)/4 with cos i = L_z/L: L turns by its derivative to L_z (L. Landau, E. Lifshitz,
  // Quantum Mechanics, section 112, has the term; L = m omega r^2).
  const double second = o.larmor * o.larmor * portable::cos(inclination) / (2 * o.omega);
  out.approximate(
      "precession", "Hz", rate / two_pi, (o.larmor + second) / two_pi,
      "turns of L about +z per second, in the mean over orbits: w/(2 pi) with w = -q B/2m, and the "
      "second order in w/omega");
  if (o.larmor == 0) return;
  // Both bindings are degenerate, so that the orbit's shape drifts within (omega/w)^2 orbits.
  if (small < 0.01 && std::numbers::pi * small * small * orbits < 0.1)
    out.approximate("second_order", "Hz", (rate - o.larmor) / two_pi, second / two_pi,
                    "what of it is beyond w/(2 pi): w^2 cos(i)/(2 omega)/(2 pi)");
  out.approximate(
      "over_cyclotron", "1", rate / (2 * o.larmor), (1 + second / o.larmor) / 2,
      "precession over the rate -q B/m at which a free charge turns: one half, and the second order");
  out.approximate("eq74_over_precession", "1", 2 * o.larmor / rate, 2 / (1 + second / o.larmor),
                  "rate of eq. 74, dL/dt = L x W with W = q B/m, over the precession: 2 to first order");
}

/// Eqs. 73 and 74 side by side: the mean over the first orbit of r x (q v x B) along L x W, over |L x W|.
void find_mean_torque(const Orbit& o, double inclination, Findings& out) {
  constexpr int steps = 64;
  std::vector<double> times;
  for (int i = 0; i <= steps; ++i) times.push_back(two_pi / o.omega * i / steps);
  if (std::abs(o.larmor) > 0.1 * o.omega) return;
  const OrbitPath path = fly(o, o.larmor, o.v, times);
  Vector3 torque, momentum;
  for (std::size_t i = 0; i < steps; ++i) {
    torque = torque + 2 * o.larmor * o.mass * cross(path.r[i], cross(z, path.v[i]));
    momentum = momentum + angular_momentum(o, path.r[i], path.v[i]);
  }
  const Vector3 claimed = 2 * o.larmor * cross(z, momentum);
  if (!(length_of(claimed) > 1e-6 * 2 * std::abs(o.larmor) * length_of(momentum))) return;
  out.approximate(
      "mean_torque", "1", dot(torque, claimed) / dot(claimed, claimed),
      o.force == Force::coulomb ? 0.5 - 1.5 * o.larmor / o.omega * portable::cos(inclination) : 0.5,
      "mean of r x (q v x B) over the first orbit, over L x W of eq. 74: one half, since the step to (r x m "
      "v) "
      "x W needs r.v = v.W = 0; and, of a Coulomb orbit, the first order -(3/2) (w/omega) cos(i)");
}

void find_free(const Orbit& o, const OrbitPath& path, const std::vector<double>& times, Findings& out) {
  if (!(portable::hypot(o.v.x, o.v.y) > 1e-9 * length_of(o.v))) return;
  const double rate = angles_about(z, path.v).back() / times.back();
  out.closed_form("turn", "Hz", rate / two_pi, 2 * o.larmor / two_pi,
                  "turns of v about +z per second: -q B/(2 pi m)");
  out.closed_form("over_larmor", "1", rate / o.larmor, 2,
                  "that over Larmor's -q B/(4 pi m), with which bound orbits precess");
}

}  // namespace

std::vector<Fault> faults_of(const BoundCharge& model) {
  if (const std::optional<Fault> fault = fault_of_species(BoundCharge::kind, model.species)) return {*fault};
  const Species& s = model.species.front().species;
  const auto* coulomb = std::get_if<CoulombBinding>(&model.binding);
  if (coulomb && !(attraction(*coulomb, s) > 0))
    return {
        {"model", "binding",
         fmt::format("the charges {:+.4g} e of `{}` and {:+.4g} e of the centre do not attract each other",
                     s.charge / constants::elementary_charge, s.name,
                     coulomb->charge / constants::elementary_charge),
         "give the centre a charge of the other sign"}};
  const Orbit o = orbit_of(model);
  if (!o.bound() && o.larmor == 0)
    return {{"model", "binding", "a free charge turns in the field, and here nothing turns it",
             "give it a `field` and a charge, or bind it"}};
  if (const double share = length_of(o.v) / constants::speed_of_light; !(share < fastest))
    return {
        {"model", "binding",
         fmt::format("the charge flies at {:.3g} of the speed of light, and this model knows no relativity",
                     share),
         fmt::format("keep it below {:g}", fastest)}};
  const double turns = turns_of(model, o);
  if (!(turns <= most_orbits))
    return {{"model", "orbits",
             fmt::format("it turns {:.3g} times, more than {:.0f} can be followed", turns, most_orbits),
             "take fewer `orbits`"}};
  return {};
}

std::vector<Fact> facts_of(const BoundCharge& model) {
  const Species& s = model.species.front().species;
  const Orbit o = orbit_of(model);
  const auto hertz = [](double omega) { return pretty_quantity(omega / two_pi, Dimension::frequency); };
  std::vector<Fact> out{
      {"orbit", hertz(o.omega), o.bound() ? "without the field" : "q B/(2 pi m), of the free charge"},
      {"v/c", fmt::format("{:.4g}", length_of(o.v) / constants::speed_of_light), "no relativity here"},
      {"larmor", hertz(o.larmor), "-q B/(4 pi m): how L precesses, to first order"},
      {"eq. 74", hertz(2 * o.larmor), "how L precesses by eq. 74"},
  };
  if (o.bound())
    out.push_back(
        {"w/omega", fmt::format("{:.4g}", std::abs(o.larmor) / o.omega), "small where it is a precession"});
  if (s.charge != 0)
    out.push_back({"eq. 75", fmt::format("{:.9g}", s.gyromagnetic_ratio * s.mass / s.charge),
                   "m v mu B/S over q v B: g/2, where eq. 75 has 1"});
  return out;
}

ModelResult solve(const BoundCharge& model) {
  refuse(faults_of(model));
  const Orbit o = orbit_of(model);
  const Times times = times_of(model, o);
  const OrbitPath standard = fly(o, o.larmor, o.v, times.all);
  ModelResult out;
  Findings findings;
  out.motions.push_back(motion_of(o, standard, times, "standard",
                                  o.bound() ? "standard physics: the binding and the Lorentz force"
                                            : "standard physics: the Lorentz force"));
  find_conserved(o, standard, findings);
  if (!o.bound()) {
    find_free(o, standard, times.all, findings);
    out.findings = findings.take();
    return out;
  }
  out.motions.push_back(
      motion_of(o, fly_turned(o, o.larmor, times.all), times, "larmor_theorem",
                "Larmor's theorem: the orbit without the field, turned with w = -q B/2m; right "
                "to first order in w/omega"));
  Motion eq74 =
      motion_of(o, fly_turned(o, 2 * o.larmor, times.all), times, "eq74",
                "eq. 74 as it is written, dL/dt = L x W with W = q B/m; the path is the orbit without "
                "the field, turned with it");
  const Vector3 start = angular_momentum(o, o.r, o.v);
  for (std::size_t i = 0; i < eq74.time.size(); ++i) {
    eq74.vectors[1].values[i] = turned_about(z, 2 * o.larmor * eq74.time[i], start);
    eq74.numbers[0].values[i] = 2 * o.larmor * eq74.time[i];
  }
  out.motions.push_back(std::move(eq74));

  if (o.force == Force::harmonic) {
    double farthest = 0;
    for (std::size_t i = 0; i < times.all.size(); ++i)
      farthest = std::max(farthest, length_of(standard.r[i] - harmonic_place(o, times.all[i])));
    findings.closed_form("closed_form", "1", farthest / o.radius, 0,
                         "largest distance from the exact orbit, over the radius: an oscillator of "
                         "sqrt(omega^2 + w^2) across z in the frame that turns with w");
  }
  find_precession(o, standard, times.all, model.inclination, findings);
  if (o.larmor != 0) find_mean_torque(o, model.inclination, findings);
  out.findings = findings.take();
  return out;
}

}  // namespace rabiline
