#include "models/charged_particle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/portable_math.hpp"
#include "core/units.hpp"
#include "models/charged_particle_motions.hpp"
#include "models/faults.hpp"
#include "models/findings.hpp"
#include "models/measure.hpp"

namespace rabiline {

using namespace charged;

namespace {

using constants::speed_of_light;
using constants::two_pi;

constexpr double most_turns = 1e5;

/// [s]; infinite for turns where nothing turns.
double duration_of(const ChargedParticle& model, const Particle& p) {
  if (const auto* time = std::get_if<ForDuration>(&model.time)) return time->duration;
  return std::get<ForTurns>(model.time).turns * two_pi * p.lorentz / std::abs(p.charge_rate * p.b.z);
}

Times times_of(const ChargedParticle& model, const Particle& p) {
  const double duration = duration_of(model, p);
  return rabiline::times_of(duration, fastest_rate(p) * duration / two_pi, model.samples);
}

double kinetic_energy(const Particle& p, const Vector3& v, double lorentz) {
  return p.mass * lorentz * lorentz / (lorentz + 1) * dot(v, v);  // (gamma - 1) m c^2
}

/// f(i) for every time that is computed.
template <class F>
std::vector<double> course_of(const Path& path, F f) {
  std::vector<double> out;
  for (std::size_t i = 0; i < path.velocity.size(); ++i) out.push_back(f(i));
  return out;
}

/// What is written of a path.
Motion motion_of(const Particle& p, const Path& path, const Times& times, std::string name,
                 std::string meaning) {
  Motion out{std::move(name), std::move(meaning), {}, {}, {}, {}};
  VectorCourse velocity{"velocity", "m/s", "of the particle"},
      spin{"spin", "1", "direction of the spin, in the particle's rest frame"};
  Course speed{"speed", "m/s", "|v|"}, energy{"kinetic_energy", "J", "(gamma - 1) m c^2"},
      angle{"spin_to_velocity", "rad", "angle between S and v: alpha of the paper's Fig. 2"};
  for (std::size_t i = 0; i < times.all.size(); i += times.stride) {
    const Vector3 &v = path.velocity[i], &s = path.spin[i];
    out.time.push_back(times.all[i]);
    out.position.push_back(path.position[i]);
    velocity.values.push_back(v);
    spin.values.push_back(s);
    speed.values.push_back(length_of(v));
    energy.values.push_back(kinetic_energy(p, v, path.lorentz[i]));
    angle.values.push_back(angle_between(s, v));
  }
  out.vectors = {std::move(velocity), std::move(spin)};
  out.numbers = {std::move(speed), std::move(energy), std::move(angle)};
  return out;
}

// ---- findings ----

/// What is asked about a path.
class PathFindings : public Findings {
 public:
  PathFindings(const Particle& p, const std::vector<double>& times) : p_(p), times_(times) {}

  /// What a uniform magnetic field conserves, whatever the law.
  void drifts(const std::string& name, const Path& path) {
    const auto drift = [&](auto of) { return largest_change(course_of(path, of)); };
    conserved(name + "_speed_drift", "1",
              drift([&](std::size_t i) { return length_of(path.velocity[i]); }) / p_.speed,
              "largest change of |v|, over |v|");
    conserved(name + "_spin_drift", "1", drift([&](std::size_t i) { return length_of(path.spin[i]); }),
              "largest change of |S|, over |S|");
    if (name != "torque")
      conserved(name + "_pitch_drift", "1",
                drift([&](std::size_t i) { return path.velocity[i].z; }) / p_.speed,
                "largest change of v_z, over |v|");
    if (name != "standard")
      conserved(name + "_angle_drift", "rad",
                drift([&](std::size_t i) { return angle_between(path.spin[i], path.velocity[i]); }),
                "largest change of the angle between S and v: both turn together, as the paper asks for");
  }

  /// Radius and frequency of a helix, against closed forms; 0 or nothing where it is a straight line.
  double helix(const std::string& name, const Path& path, double rate, const std::string& formula) {
    const double across = portable::hypot(p_.velocity.x, p_.velocity.y);
    if (!(across > 1e-9 * p_.speed)) return 0;
    const double angle = angles_about({0, 0, 1}, path.velocity).back();
    closed_form(name + "_frequency", "Hz", angle / times_.back() / two_pi, rate / two_pi,
                fmt::format("turns of v per second about +z, right-handed: {}", formula));
    if (std::abs(angle) < 1) return 0;  // too little of a circle
    const std::optional<double> radius = radius_of(path.position);
    if (!radius) return 0;
    closed_form(name + "_radius", "m", *radius, across / std::abs(rate),
                "of the helix: v across z over that rate");
    return *radius;
  }

 private:
  const Particle& p_;
  const std::vector<double>& times_;
};

/// The spin against the momentum, both followed by numbers: S seen from a frame that turns with v about z
/// turns about a fixed axis, W_rel = -a (q/m) [B - g/(g+1) (v.B) v/c^2] (Bargmann, Michel, Telegdi).
void find_anomaly(const Particle& p, const Path& path, const std::vector<double>& times,
                  PathFindings& findings) {
  const double cyclotron = -p.charge_rate * p.b.z / p.lorentz;
  const Vector3 relative = bmt(p, p.velocity, p.lorentz) - Vector3{0, 0, cyclotron};
  const double rate = length_of(relative);
  if (!(rate > 0)) return;
  const Vector3 axis = (1 / rate) * relative;
  const std::vector<double> turn = angles_about({0, 0, 1}, path.velocity);
  const bool across = portable::hypot(p.velocity.x, p.velocity.y) > 1e-9 * p.speed;
  std::vector<Vector3> seen;
  for (std::size_t i = 0; i < times.size(); ++i)
    seen.push_back(turned_about({0, 0, 1}, across ? -turn[i] : -cyclotron * times[i], path.spin[i]));
  if (length_of(cross(axis, p.spin)) < 1e-6) return;  // the spin lies on that axis
  findings.closed_form(
      "anomalous_frequency", "Hz", angles_about(axis, seen).back() / times.back() / two_pi, rate / two_pi,
      "turns of the spin against the momentum per second; a |q B|/(2 pi m) with a = g/2 - 1 for v "
      "across the field, at every energy (229 kHz for muons in 1.4513 T, as storage rings of BNL and "
      "Fermilab have it: G. Bennett et al., Phys. Rev. D 73, 072003 (2006))");
}

/// How the rates of spin and velocity compare, which is what traps measure.
void find_ratio(const Particle& p, const Path& standard, const Path& larmor, double standard_radius,
                double larmor_radius, PathFindings& findings) {
  const double half_g = p.gamma / p.charge_rate;
  if (standard_radius > 0 && larmor_radius > 0)
    findings.closed_form(
        "radius_ratio", "1", standard_radius / larmor_radius, std::abs(half_g) * p.lorentz,
        "radius by the Lorentz force over radius by `larmor`: |g|/2 for a slow particle, times the "
        "Lorentz factor for a fast one, since the hypothesis knows no relativity; 1 for g = 2");
  const bool flat = std::abs(p.velocity.z) < 1e-12 * p.speed;
  if (!flat || portable::hypot(p.spin.x, p.spin.y) < 1e-6) return;
  const Vector3 up{0, 0, 1};
  const auto ratio = [&](const Path& path) {
    return angles_about(up, path.spin).back() / angles_about(up, path.velocity).back();
  };
  findings.closed_form(
      "standard_spin_turns", "1", ratio(standard), 1 + p.lorentz * (half_g - 1),
      "turns of the spin for each turn of the velocity: 1 + gamma (g/2 - 1), g/2 for a slow particle. Both "
      "turnings of one proton were counted in a Penning trap and have the ratio g/2 = 2.79284734462(82) "
      "(G. Schneider et al., Science 358, 1081 (2017)), of one electron 1.00115965218059(13) (X. Fan et "
      "al., Phys. Rev. Lett. 130, 071801 (2023))");
  findings.closed_form(
      "larmor_spin_turns", "1", ratio(larmor), 1,
      "the same under `larmor`, where spin and velocity turn jointly whatever g is: measured ratios of "
      "protons contradict it, while the electron's differs from 1 by a thousandth");
}

/// Where an electric field acts: the energy, and the turning of the spin that it adds at the start.
void find_electric(const Particle& p, const Path& path, PathFindings& findings) {
  const std::vector<double> energy = course_of(path, [&](std::size_t i) {
    return kinetic_energy(p, path.velocity[i], path.lorentz[i]) - p.charge * dot(p.e, path.position[i]);
  });
  findings.conserved(
      "standard_energy_drift", "1", largest_change(energy) / energy.front(),
      "largest change of kinetic energy minus the work q E.r, over the kinetic energy at the start");
  if (std::abs(dot(p.velocity, p.e)) > 1e-12 * p.speed * length_of(p.e)) return;
  Particle without = p;
  without.e = {};
  const auto against = [&](const Particle& q) {
    return bmt(q, q.velocity, q.lorentz) - turning_of_momentum(q, q.velocity, q.lorentz);
  };
  const Vector3 across = cross(p.velocity, p.e);
  const double size = length_of(across) / speed_of_light / speed_of_light;
  const double square = (p.lorentz - 1) * (p.lorentz + 1);
  findings.closed_form(
      "electric_share", "Hz", dot(against(p) - against(without), (1 / length_of(across)) * across) / two_pi,
      (p.anomalous_rate - p.charge_rate / square) * size / two_pi,
      "what the electric field across v adds, at the start, to the turning of the spin against the momentum, "
      "about v x E: (q/m)(a - 1/(gamma^2 - 1)) |v x E|/c^2. It vanishes at the magic gamma = "
      "sqrt(1 + 1/a), 29.3 for muons");
}

}  // namespace

std::vector<Fault> faults_of(const ChargedParticle& model) {
  if (const std::optional<Fault> fault = fault_of_species(ChargedParticle::kind, model.species))
    return {*fault};
  const Particle p = particle_of(model);
  const double turns = fastest_rate(p) * duration_of(model, p) / two_pi;
  if (std::holds_alternative<ForTurns>(model.time) && p.charge_rate * p.b.z == 0)
    return {{"model", "turns", "`turns` counts those of a charge in a magnetic field, and here nothing turns",
             "write `duration` instead"}};
  if (!(turns <= most_turns))
    return {{"model", std::holds_alternative<ForTurns>(model.time) ? "turns" : "duration",
             fmt::format("spin or velocity turns {:.3g} times here, more than {:.0f} can be followed", turns,
                         most_turns),
             "make it shorter"}};
  return {};
}

std::vector<Fact> facts_of(const ChargedParticle& model) {
  const Particle p = particle_of(model);
  const auto hertz = [](double omega) { return pretty_quantity(omega / two_pi, Dimension::frequency); };
  const double cyclotron = -p.charge_rate * p.b.z / p.lorentz, larmor = -p.gamma * p.b.z;
  const double across = portable::hypot(p.velocity.x, p.velocity.y);
  std::vector<Fact> out{
      {"v/c", fmt::format("{:.6g}", p.speed / speed_of_light), fmt::format("gamma = {:.8g}", p.lorentz)},
      {"cyclotron", hertz(cyclotron), "-q B/(2 pi gamma m), turns of v by the Lorentz force about +z"},
      {"larmor", hertz(larmor), "-gamma B/(2 pi), turns of v under the closure larmor"},
      {"anomaly", hertz(std::abs(p.anomalous_rate * p.b.z)),
       "turns of the spin against the momentum, for v across the field"},
  };
  const auto radius = [&](double rate) {
    return pretty_quantity(across / std::abs(rate), Dimension::length);
  };
  if (cyclotron != 0) out.push_back({"r standard", radius(cyclotron), "of the helix by the Lorentz force"});
  if (larmor != 0)
    out.push_back({"r larmor", radius(larmor), "of the helix under the closure larmor, eq. 37"});
  if (p.charge != 0) out.push_back({"g", fmt::format("{:.9g}", 2 * p.gamma / p.charge_rate), "2 m gamma/q"});
  return out;
}

ModelResult solve(const ChargedParticle& model) {
  refuse(faults_of(model));
  const Particle p = particle_of(model);
  const Times times = times_of(model, p);
  const Path standard = standard_path(p, times.all), larmor = hypothesis_path(p, times.all, false),
             torque = hypothesis_path(p, times.all, true);
  ModelResult out;
  out.motions = {
      motion_of(
          p, standard, times, "standard",
          "standard physics: Lorentz force and the equation of Thomas, Bargmann, Michel and Telegdi, with "
          "special relativity"),
      motion_of(
          p, larmor, times, "larmor",
          "the hypothesis, closure larmor: dv/dt = W x v with W = -gamma B instead of the Lorentz force "
          "(eqs. "
          "34-41). The paper has no relativity: W is the same at every speed, and an electric field does "
          "nothing"),
      motion_of(
          p, torque, times, "torque",
          "the hypothesis, closure torque: W = S x (dS/dt)/|S|^2, the turning that the torque asks for (eqs. "
          "8-10, 33); a spin along the field flies straight")};

  PathFindings findings(p, times.all);
  double standard_radius = 0;
  const bool magnetic = model.electric_field == 0;
  if (magnetic) {
    findings.drifts("standard", standard);
    standard_radius = findings.helix("standard", standard, -p.charge_rate * p.b.z / p.lorentz,
                                     "-q B/(2 pi gamma m), the cyclotron frequency");
    find_anomaly(p, standard, times.all, findings);
  } else {
    find_electric(p, standard, findings);
  }
  findings.drifts("larmor", larmor);
  const double larmor_radius =
      findings.helix("larmor", larmor, -p.gamma * p.b.z, "-gamma B/(2 pi) = -g q B/(4 pi m), eq. 36");
  findings.drifts("torque", torque);
  if (magnetic && p.charge_rate * p.b.z != 0)
    find_ratio(p, standard, larmor, standard_radius, larmor_radius, findings);
  out.findings = findings.take();
  return out;
}

}  // namespace rabiline
