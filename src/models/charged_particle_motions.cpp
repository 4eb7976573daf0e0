#include "models/charged_particle_motions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "models/ode.hpp"

namespace rabiline::charged {

using constants::speed_of_light;

namespace {

double lorentz_factor(double speed) {
  const double beta = speed / speed_of_light;
  return 1 / std::sqrt((1 - beta) * (1 + beta));
}

/// Integrates in units in which all is of order 1: time in that of the fastest turning, velocities (or
/// momenta) in those at the start. `step` turns a velocity (or momentum) and a spin into the derivatives of
/// place, of both, and gives the Lorentz factor.
template <class Step>
Path integrate_path(const Particle& p, const std::vector<double>& times, Step step) {
  const double rate = std::max(fastest_rate(p), 1 / times.back());
  std::vector<double> scaled;
  scaled.reserve(times.size());
  for (const double t : times) scaled.push_back(t * rate);
  const Vector3 u0 = (1 / p.speed) * p.velocity;
  const auto rows = integrate(
      [&](double, std::span<const double> y, std::span<double> d) {
        const Vector3 u{y[3], y[4], y[5]}, s{y[6], y[7], y[8]};
        Vector3 dr, du, ds;
        step(u, s, dr, du, ds);
        const Vector3* out[] = {&dr, &du, &ds};
        for (std::size_t i = 0; i < 3; ++i) {
          const double scale = i == 0 ? 1 : 1 / rate;
          d[3 * i] = scale * out[i]->x, d[3 * i + 1] = scale * out[i]->y, d[3 * i + 2] = scale * out[i]->z;
        }
      },
      {0, 0, 0, u0.x, u0.y, u0.z, p.spin.x, p.spin.y, p.spin.z}, scaled, 1e-14);
  Path path;
  for (const auto& y : rows) {
    const Vector3 u{y[3], y[4], y[5]}, s{y[6], y[7], y[8]};
    Vector3 dr, du, ds;
    path.lorentz.push_back(step(u, s, dr, du, ds));
    path.position.push_back((p.speed / rate) * Vector3{y[0], y[1], y[2]});
    path.velocity.push_back(p.speed * dr);
    path.spin.push_back(s);
  }
  return path;
}

}  // namespace

Particle particle_of(const ChargedParticle& model) {
  const Species& s = model.species.front().species;
  Particle p{};
  p.mass = s.mass, p.charge = s.charge, p.gamma = s.gyromagnetic_ratio;
  p.charge_rate = s.charge / s.mass;
  p.anomalous_rate = p.gamma - p.charge_rate;
  p.b = {0, 0, model.field};
  p.e = model.electric_field * Vector3(model.electric_direction);
  if (const auto* speed = std::get_if<StartSpeed>(&model.speed)) {
    p.speed = speed->speed;
    p.lorentz = lorentz_factor(p.speed);
  } else {
    p.lorentz = std::get<StartLorentzFactor>(model.speed).lorentz_factor;
    p.speed = speed_of_light * std::sqrt((p.lorentz - 1) * (p.lorentz + 1)) / p.lorentz;
  }
  // sin(pi) is 1e-16, and a particle along the field has nothing across it.
  const auto sine = [](double angle) {
    return std::abs(angle - std::numbers::pi) < 1e-15 ? 0 : portable::sin(angle);
  };
  p.velocity = {0, p.speed * sine(model.pitch), p.speed * portable::cos(model.pitch)};
  const double across = sine(model.spin_angle);
  p.spin = {-across * portable::sin(model.spin_azimuth), across * portable::cos(model.spin_azimuth),
            portable::cos(model.spin_angle)};
  return p;
}

Vector3 bmt(const Particle& p, const Vector3& v, double lorentz) {
  const double a = p.anomalous_rate, q = p.charge_rate;
  const Vector3 beta = (1 / speed_of_light) * v;
  return -(a + q / lorentz) * p.b + (a * lorentz / (lorentz + 1) * dot(beta, p.b)) * beta +
         ((a + q / (lorentz + 1)) / speed_of_light) * cross(beta, p.e);
}

Vector3 turning_of_momentum(const Particle& p, const Vector3& v, double lorentz) {
  return -(p.charge_rate / lorentz) * p.b + (p.charge_rate / lorentz / dot(v, v)) * cross(v, p.e);
}

double fastest_rate(const Particle& p) {
  const double b = std::abs(p.b.z), e = length_of(p.e) / speed_of_light;
  const double a = std::abs(p.anomalous_rate), q = std::abs(p.charge_rate);
  return std::max({std::abs(p.gamma) * b, (a + q / p.lorentz) * b + (a + q) * e,
                   q * e * speed_of_light / (p.lorentz * p.speed)});
}

Path standard_path(const Particle& p, const std::vector<double>& times) {
  const double beta = p.speed / speed_of_light, momentum = beta * p.lorentz;
  return integrate_path(
      p, times, [&](const Vector3& u, const Vector3& s, Vector3& dr, Vector3& du, Vector3& ds) {
        const double lorentz = std::sqrt(1 + momentum * momentum * dot(u, u));
        dr = (p.lorentz / lorentz) * u;
        du = p.charge_rate * ((1 / (p.lorentz * p.speed)) * p.e + (1 / lorentz) * cross(u, p.b));
        ds = cross(bmt(p, p.speed * dr, lorentz), s);
        return lorentz;
      });
}

Path hypothesis_path(const Particle& p, const std::vector<double>& times, bool torque) {
  const Vector3 larmor = -p.gamma * p.b;
  return integrate_path(p, times,
                        [&](const Vector3& u, const Vector3& s, Vector3& dr, Vector3& du, Vector3& ds) {
                          ds = cross(larmor, s);
                          dr = u;
                          du = cross(torque ? (1 / dot(s, s)) * cross(s, ds) : larmor, u);
                          return p.lorentz;
                        });
}

}  // namespace rabiline::charged
