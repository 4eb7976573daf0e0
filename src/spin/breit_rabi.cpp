#include "spin/breit_rabi.hpp"

#include <cmath>
#include <cstdlib>

#include "core/constants.hpp"

namespace rabiline {
namespace {

using constants::bohr_magneton;
using constants::planck;

/// D in hertz, with the sign of A.
double splitting(const HyperfineAtom& atom) { return atom.hyperfine_constant * (atom.twice_i + 1) / 2; }

}  // namespace

BreitRabi breit_rabi(const HyperfineAtom& atom, int twice_f, int twice_m, double field) {
  const double levels = atom.twice_i + 1;                                   // 2I + 1
  const double half_split = planck * splitting(atom) / 2;                   // hD/2
  const double zeeman = (atom.g_j - atom.g_i) * bohr_magneton * field / 2;  // x hD/2
  const double m = twice_m / 2.0, u = twice_m / levels;
  const double branch = twice_f > atom.twice_i ? 1 : -1;
  const double linear = half_split * u + zeeman;     // (u + x) hD/2
  double root = half_split + u * zeeman, slope = u;  // +-(hD/2) r, and its derivative by `zeeman`
  if (std::abs(twice_m) != atom.twice_i + 1) {
    const double size = std::sqrt(half_split * half_split * (1 - u * u) + linear * linear);
    const double side = half_split < 0 ? -branch : branch;
    root = side * size;
    slope = side * (size > 0 ? linear / size : 1);
  }
  return {.energy = -half_split / levels + atom.g_i * bohr_magneton * m * field + root,
          .moment = -bohr_magneton * (atom.g_i * m + (atom.g_j - atom.g_i) / 2 * slope)};
}

std::optional<double> zero_moment_field(const HyperfineAtom& atom, int twice_f, int twice_m) {
  const double difference = atom.g_j - atom.g_i;
  const double u = twice_m / (atom.twice_i + 1.0);
  const double sign = twice_f > atom.twice_i ? 1 : -1;
  const double c = -sign * atom.g_i * twice_m / difference;
  if (std::abs(twice_m) == atom.twice_i + 1 || std::abs(c) >= 1) return std::nullopt;
  const double s = c * std::sqrt((1 - u * u) / (1 - c * c));
  const double field = (s - u) * planck * splitting(atom) / (difference * bohr_magneton);
  if (!(field > 0)) return std::nullopt;
  return field;
}

double clock_quadratic_shift(const HyperfineAtom& atom) {
  const double per_tesla = (atom.g_j - atom.g_i) * bohr_magneton / planck;
  return per_tesla * per_tesla / (2 * std::abs(splitting(atom)));
}

}  // namespace rabiline
