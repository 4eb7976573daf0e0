#include "particle/speed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

using constants::boltzmann;
using constants::planck;

/// <v> of a normal law in wavelength or energy, cut where it ends and where particles would be too fast.
double mean_of_converted(const GaussianSpeed& law, double mass) {
  constexpr int points = 801;
  constexpr double widest = 8;  // [sigma]
  double sum = 0, all = 0;
  for (int i = 0; i < points; ++i) {
    const double z = widest * (2.0 * i / (points - 1) - 1);
    const SpeedQuantity q(law.mean.value + z * law.sigma.value, law.mean.dimension);
    if (!(q.value > 0) || speed_of(q, mass) > fastest_speed) continue;
    const double weight = portable::exp(-z * z / 2);
    sum += weight * speed_of(q, mass);
    all += weight;
  }
  return all > 0 ? sum / all : speed_of(law.mean, mass);
}

double mean_of(const SingleSpeed& law, double mass) { return speed_of(law.value, mass); }
double mean_of(const GaussianSpeed& law, double mass) {
  return law.mean.dimension == Dimension::speed ? law.mean.value : mean_of_converted(law, mass);
}
/// <y> = integral of 2 y^4 exp(-y^2) = 3 sqrt(pi)/4.
double mean_of(const EffusiveSpeed& law, double mass) {
  return 0.75 * std::sqrt(std::numbers::pi) * thermal_speed(law.temperature, mass);
}
/// <y> = 2/sqrt(pi).
double mean_of(const MaxwellSpeed& law, double mass) {
  return 2 / std::sqrt(std::numbers::pi) * thermal_speed(law.temperature, mass);
}
/// <y> = M4/M3 of M_n = integral of y^n exp(-S^2 (y-1)^2) over y > 0. With y = 1 + z/S the powers of z are
/// J_k = integral of z^k exp(-z^2) over z > -S = (-S)^(k-1) exp(-S^2)/2 + (k-1)/2 J_(k-2).
double mean_of(const SupersonicSpeed& law, double mass) {
  const double s = law.speed_ratio, edge = portable::exp(-s * s) / 2;
  double j[5] = {std::sqrt(std::numbers::pi) / 2 * (1 + portable::erf(s)), edge};
  for (int k = 2; k < 5; ++k) j[k] = portable::pow(-s, k - 1) * edge + 0.5 * (k - 1) * j[k - 2];
  const double m3 = j[0] + 3 * j[1] / s + 3 * j[2] / (s * s) + j[3] / (s * s * s);
  const double m4 = m3 + j[1] / s + 3 * j[2] / (s * s) + 3 * j[3] / (s * s * s) + j[4] / (s * s * s * s);
  return terminal_speed(law, mass) * m4 / m3;
}
/// Three points of Gauss in each cell: exact for a speed, and to parts in a million for what cells vary by.
double mean_of(const TabulatedSpeed& law, double mass) {
  static constexpr double node[] = {0.11270166537925831, 0.5, 0.88729833462074169},
                          weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const Spectrum& s = *law.file.spectrum;
  double sum = 0, all = 0;
  for (std::size_t i = 0; i + 1 < s.at.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double flux = weight[k] * (s.at[i + 1] - s.at[i]) * std::lerp(s.flux[i], s.flux[i + 1], node[k]);
      sum += flux * speed_of({std::lerp(s.at[i], s.at[i + 1], node[k]), s.dimension}, mass);
      all += flux;
    }
  return sum / all;
}
double mean_of(const LineSpeeds& law, double mass) {
  double sum = 0, all = 0;
  for (const SpeedLine& line : law.lines) {
    sum += line.weight * speed_of(line.value, mass);
    all += line.weight;
  }
  return sum / all;
}

}  // namespace

double speed_of(const SpeedQuantity& q, double mass) {
  if (q.dimension == Dimension::length) return planck / (mass * q.value);
  if (q.dimension == Dimension::energy) return std::sqrt(2 * q.value / mass);
  return q.value;
}

double thermal_speed(double temperature, double mass) {
  return std::sqrt(2 * boltzmann * temperature / mass);
}

double terminal_speed(const SupersonicSpeed& law, double mass) {
  const double g = law.adiabatic_exponent;
  return std::sqrt(2 * g / (g - 1) * boltzmann * law.temperature / mass);
}

double mean_speed(const SpeedLaw& law, double mass) {
  return std::visit([&](const auto& l) { return mean_of(l, mass); }, law);
}

}  // namespace rabiline
