#include "particle/speed.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "particle/law_tables.hpp"

namespace rabiline {
namespace {

using constants::boltzmann;
using constants::planck;

/// Beyond this many standard deviations is less than 1e-4.
constexpr double deviations = 4;
/// Speeds in units of the thermal one between which all but 1e-4 lie: flux, then density.
constexpr double slowest_flux = 0.12, slowest_density = 0.05, fastest_thermal = 4;

SpeedRange between(const SpeedQuantity& a, const SpeedQuantity& b, double mass) {
  const double v = speed_of(a, mass), w = speed_of(b, mass);
  return {std::min(v, w), std::max(v, w)};
}

/// What is drawn in that quantity becomes a speed: v = h/(m lambda), v = sqrt(2E/m).
void convert_from(Dimension quantity, double mass, SpeedDraw& draw) {
  if (quantity == Dimension::length) {
    draw.scale = SpeedScale::inverse;
    draw.factor = planck / mass;
  } else if (quantity == Dimension::energy) {
    draw.scale = SpeedScale::root;
    draw.factor = 2 / mass;
  }
}

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

/// y^3 exp(-S^2 (y-1)^2), y = v/u, on 4096 cells over all y where it is above 1e-16 of its maximum. What is
/// drawn differs from the law by less than 1e-5 in total variation.
SampledTable supersonic_table(double s) {
  constexpr int cells = 4096;
  const double low = std::max(0.0, 1 - 6.2 / s), high = 1 + 7.5 / s;
  std::vector<double> at, density;
  for (int i = 0; i <= cells; ++i) {
    const double y = std::lerp(low, high, static_cast<double>(i) / cells);
    at.push_back(y);
    density.push_back(y * y * y * portable::exp(-s * s * (y - 1) * (y - 1)));
  }
  return {std::move(at), std::move(density)};
}

}  // namespace

// ---- one speed ----

double SingleSpeed::mean_speed(double mass) const { return speed_of(value, mass); }
SpeedRange SingleSpeed::speed_range(double mass) const { return between(value, value, mass); }
SpeedDraw SingleSpeed::draw(double mass, LawTables&) const { return {mean_speed(mass)}; }
std::vector<StatedSpeed> SingleSpeed::stated_speeds(double) const { return {{"value", value}}; }

// ---- a normal law ----

double GaussianSpeed::mean_speed(double mass) const {
  return mean.dimension == Dimension::speed ? mean.value : mean_of_converted(*this, mass);
}
SpeedRange GaussianSpeed::speed_range(double mass) const {
  const double width = deviations * sigma.value;
  return between({std::max(mean.value - width, mean.value / 20), mean.dimension},
                 {mean.value + width, mean.dimension}, mass);
}
SpeedDraw GaussianSpeed::draw(double mass, LawTables&) const {
  SpeedDraw draw{mean_speed(mass), SpeedKind::gaussian, mean.value, sigma.value};
  convert_from(mean.dimension, mass, draw);
  // Waves so short that the program without relativity ends are drawn again, like those below zero.
  if (draw.scale == SpeedScale::inverse) draw.least = draw.factor / fastest_speed;
  return draw;
}
std::vector<StatedSpeed> GaussianSpeed::stated_speeds(double) const {
  std::vector<StatedSpeed> all{{"mean", mean}};
  // Five standard deviations up; a wavelength's fast tail is cut where it is drawn.
  if (mean.dimension == sigma.dimension && mean.dimension != Dimension::length && sigma.value > 0)
    all.push_back({"sigma", {mean.value + 5 * sigma.value, mean.dimension}});
  return all;
}

// ---- thermal laws ----

/// <y> = integral of 2 y^4 exp(-y^2) = 3 sqrt(pi)/4.
double EffusiveSpeed::mean_speed(double mass) const {
  return 0.75 * std::sqrt(std::numbers::pi) * thermal_speed(temperature, mass);
}
SpeedRange EffusiveSpeed::speed_range(double mass) const {
  const double alpha = thermal_speed(temperature, mass);
  return {slowest_flux * alpha, fastest_thermal * alpha};
}
SpeedDraw EffusiveSpeed::draw(double mass, LawTables&) const {
  SpeedDraw draw{mean_speed(mass), SpeedKind::effusive};
  draw.factor = thermal_speed(temperature, mass);
  return draw;
}
std::vector<StatedSpeed> EffusiveSpeed::stated_speeds(double mass) const {
  return {{"temperature", mean_speed(mass), true}};
}

/// <y> = 2/sqrt(pi).
double MaxwellSpeed::mean_speed(double mass) const {
  return 2 / std::sqrt(std::numbers::pi) * thermal_speed(temperature, mass);
}
SpeedRange MaxwellSpeed::speed_range(double mass) const {
  const double alpha = thermal_speed(temperature, mass);
  return {slowest_density * alpha, fastest_thermal * alpha};
}
SpeedDraw MaxwellSpeed::draw(double mass, LawTables&) const {
  SpeedDraw draw{mean_speed(mass), SpeedKind::maxwell};
  draw.factor = thermal_speed(temperature, mass);
  return draw;
}
std::vector<StatedSpeed> MaxwellSpeed::stated_speeds(double mass) const {
  return {{"temperature", mean_speed(mass), true}};
}

// ---- a nozzle beam ----

/// <y> = M4/M3 of M_n = integral of y^n exp(-S^2 (y-1)^2) over y > 0. With y = 1 + z/S the powers of z are
/// J_k = integral of z^k exp(-z^2) over z > -S = (-S)^(k-1) exp(-S^2)/2 + (k-1)/2 J_(k-2).
double SupersonicSpeed::mean_speed(double mass) const {
  const double s = speed_ratio, edge = portable::exp(-s * s) / 2;
  double j[5] = {std::sqrt(std::numbers::pi) / 2 * (1 + portable::erf(s)), edge};
  for (int k = 2; k < 5; ++k) j[k] = portable::pow(-s, k - 1) * edge + 0.5 * (k - 1) * j[k - 2];
  const double m3 = j[0] + 3 * j[1] / s + 3 * j[2] / (s * s) + j[3] / (s * s * s);
  const double m4 = m3 + j[1] / s + 3 * j[2] / (s * s) + 3 * j[3] / (s * s * s) + j[4] / (s * s * s * s);
  return terminal_speed(*this, mass) * m4 / m3;
}
SpeedRange SupersonicSpeed::speed_range(double mass) const {
  const double u = terminal_speed(*this, mass), width = deviations / speed_ratio;
  return {u * std::max(1 - width, 0.12 / speed_ratio), u * (1 + width)};
}
SpeedDraw SupersonicSpeed::draw(double mass, LawTables& tables) const {
  SpeedDraw draw{mean_speed(mass), SpeedKind::sampled};
  draw.table = tables.sampled(kind, {speed_ratio}, [&] { return supersonic_table(speed_ratio); });
  draw.factor = terminal_speed(*this, mass);
  return draw;
}
std::vector<StatedSpeed> SupersonicSpeed::stated_speeds(double mass) const {
  if (!(adiabatic_exponent > 1 && speed_ratio > 0)) return {};
  return {{"temperature", mean_speed(mass), true}};
}

// ---- the same between two limits ----

/// With r = spread: <1/q> = artanh(r)/(r q0) of a wavelength; of an energy <sqrt(q)> is
/// sqrt(q0) ((1+r)^(3/2) - (1-r)^(3/2))/3r.
double UniformSpeed::mean_speed(double mass) const {
  const double v = speed_of(mean, mass);
  if (mean.dimension == Dimension::length)
    return v * portable::asinh(spread / std::sqrt(1 - spread * spread)) / spread;
  if (mean.dimension == Dimension::energy) {
    const double up = 1 + spread, down = 1 - spread;
    return v * (up * std::sqrt(up) - down * std::sqrt(down)) / (3 * spread);
  }
  return v;
}
SpeedRange UniformSpeed::speed_range(double mass) const {
  return between({mean.value * (1 - spread), mean.dimension}, {mean.value * (1 + spread), mean.dimension},
                 mass);
}
SpeedDraw UniformSpeed::draw(double mass, LawTables& tables) const {
  SpeedDraw draw{mean_speed(mass), SpeedKind::sampled};
  const std::vector<double> limits{mean.value * (1 - spread), mean.value * (1 + spread)};
  draw.table = tables.sampled(kind, limits, [&] { return SampledTable(limits, {1, 1}); });
  convert_from(mean.dimension, mass, draw);
  return draw;
}
std::vector<StatedSpeed> UniformSpeed::stated_speeds(double) const {
  const double fastest = mean.dimension == Dimension::length ? 1 - spread : 1 + spread;
  return {{"mean", {fastest * mean.value, mean.dimension}}};
}

// ---- a measured spectrum ----

/// Three points of Gauss in each cell: exact for a speed, and to parts in a million for what cells vary by.
double TabulatedSpeed::mean_speed(double mass) const {
  static constexpr double node[] = {0.11270166537925831, 0.5, 0.88729833462074169},
                          weight[] = {5.0 / 18, 8.0 / 18, 5.0 / 18};
  const Spectrum& s = *file.spectrum;
  double sum = 0, all = 0;
  for (std::size_t i = 0; i + 1 < s.at.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double flux = weight[k] * (s.at[i + 1] - s.at[i]) * std::lerp(s.flux[i], s.flux[i + 1], node[k]);
      sum += flux * speed_of({std::lerp(s.at[i], s.at[i + 1], node[k]), s.dimension}, mass);
      all += flux;
    }
  return sum / all;
}
SpeedRange TabulatedSpeed::speed_range(double mass) const {
  const Spectrum& s = *file.spectrum;
  return between({s.at.front(), s.dimension}, {s.at.back(), s.dimension}, mass);
}
SpeedDraw TabulatedSpeed::draw(double mass, LawTables& tables) const {
  const Spectrum& s = *file.spectrum;
  SpeedDraw draw{mean_speed(mass), SpeedKind::sampled};
  std::vector<double> rows = s.at;
  rows.insert(rows.end(), s.flux.begin(), s.flux.end());
  draw.table = tables.sampled(kind, rows, [&] { return SampledTable(s.at, s.flux); });
  convert_from(s.dimension, mass, draw);
  return draw;
}
std::vector<StatedSpeed> TabulatedSpeed::stated_speeds(double) const {
  if (!file.spectrum) return {};
  const Spectrum& s = *file.spectrum;
  return {{"file", {s.dimension == Dimension::length ? s.at.front() : s.at.back(), s.dimension}}};
}

// ---- lines ----

double LineSpeeds::mean_speed(double mass) const {
  double sum = 0, all = 0;
  for (const SpeedLine& line : lines) {
    sum += line.weight * speed_of(line.value, mass);
    all += line.weight;
  }
  return sum / all;
}
SpeedRange LineSpeeds::speed_range(double mass) const {
  SpeedRange range{fastest_speed, 0};
  for (const SpeedLine& line : lines) {
    const double v = speed_of(line.value, mass);
    range = {std::min(range.slowest, v), std::max(range.fastest, v)};
  }
  return range;
}
SpeedDraw LineSpeeds::draw(double mass, LawTables& tables) const {
  std::vector<double> values, weights;
  for (const SpeedLine& line : lines) {
    values.push_back(speed_of(line.value, mass));
    weights.push_back(line.weight);
  }
  std::vector<double> numbers = values;
  numbers.insert(numbers.end(), weights.begin(), weights.end());
  SpeedDraw draw{mean_speed(mass), SpeedKind::sampled};
  draw.table = tables.sampled(kind, numbers, [&] { return SampledTable::of_lines(values, weights); });
  return draw;
}
std::vector<StatedSpeed> LineSpeeds::stated_speeds(double) const {
  std::vector<StatedSpeed> all;
  for (std::size_t i = 0; i < lines.size(); ++i)
    all.push_back({fmt::format("lines[{}].value", i), lines[i].value});
  return all;
}

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
  return std::visit([&](const auto& l) { return l.mean_speed(mass); }, law);
}
SpeedRange speed_range(const SpeedLaw& law, double mass) {
  return std::visit([&](const auto& l) { return l.speed_range(mass); }, law);
}

}  // namespace rabiline
