#pragma once
// Schroedinger's equation in the laboratory, for comparison: the whole field as it turns or swings, by small
// steps of Runge and Kutta.
#include <Eigen/Dense>
#include <cmath>
#include <complex>
#include <functional>
#include <span>
#include <vector>

#include "spin/level_drive.hpp"
#include "spin/levels.hpp"

namespace rabiline {

using Complex = std::complex<double>;
constexpr double two_pi = 6.283185307179586;

/// m from above; <m+1| S_+ |m> = sqrt(s(s+1) - m(m+1)). Axis 0, 1, 2 is x, y, z.
inline Eigen::MatrixXcd spin_matrix(int twice_s, int axis) {
  Eigen::MatrixXcd raise = Eigen::MatrixXcd::Zero(twice_s + 1, twice_s + 1), z = raise;
  const double s = twice_s / 2.0;
  for (int k = 0; k <= twice_s; ++k) {
    z(k, k) = s - k;
    if (k > 0) raise(k - 1, k) = std::sqrt(s * (s + 1) - (s - k) * (s - k + 1));
  }
  if (axis == 2) return z;
  if (axis == 0) return (raise + raise.adjoint()) / 2;
  return Complex(0, -0.5) * (raise - raise.adjoint());
}

/// S_axis of J or I in the basis of CoupledSpins.
inline Eigen::MatrixXcd in_product_basis(const CoupledSpins& spins, bool of_j, int axis) {
  const int nj = spins.twice_j + 1, ni = spins.twice_i + 1;
  const Eigen::MatrixXcd one = spin_matrix(of_j ? spins.twice_j : spins.twice_i, axis);
  Eigen::MatrixXcd out = Eigen::MatrixXcd::Zero(nj * ni, nj * ni);
  for (int r = 0; r < nj * ni; ++r)
    for (int c = 0; c < nj * ni; ++c) {
      if (of_j && r % ni == c % ni) out(r, c) = one(r / ni, c / ni);
      if (!of_j && r / ni == c / ni) out(r, c) = one(r % ni, c % ni);
    }
  return out;
}

inline Eigen::Vector3d driving_field(const RotatingTerm& drive, double y, double slowness) {
  double share = 1;
  if (drive.envelope.shape == Shape::half_sine)
    share = std::sin(two_pi / 2 * (y - drive.envelope.begin) / drive.envelope.length);
  if (drive.envelope.shape == Shape::gaussian)
    share = std::exp(
        -std::pow((y - drive.envelope.begin - drive.envelope.length / 2) / drive.envelope.sigma, 2) / 2);
  const int sense = sense_of(drive);  // the phase is an azimuth whatever the sense
  const double p = (sense < 0 ? -1 : 1) * two_pi * drive.oscillator.frequency * slowness * y +
                   drive.oscillator.phase,
               size = drive.amplitude * share;
  if (sense == 0) return size * std::cos(p) * Eigen::Vector3d(drive.first.x, drive.first.y, drive.first.z);
  return size * Eigen::Vector3d(std::cos(p), std::sin(p), 0);
}

/// The states at a field, with the signs that small steps in the field lead to.
inline Eigen::MatrixXd states_after(const CoupledSpins& spins, Eigen::MatrixXd states, double from,
                                    double to) {
  constexpr int steps = 1000;
  for (int k = 1; k <= steps; ++k) {
    Eigen::MatrixXd next = levels_at(spins, from + (to - from) * k / steps).states;
    for (int n = 0; n < next.cols(); ++n)
      if (next.col(n).dot(states.col(n)) < 0) next.col(n) *= -1;
    states = next;
  }
  return states;
}

/// P(from -> to), row from, column to. Zones follow one another without gaps.
inline Eigen::MatrixXd in_the_laboratory(const CoupledSpins& spins, std::span<const LevelZone> zones,
                                         double slowness, int steps_of_zone) {
  Eigen::MatrixXcd s_i[3], s_j[3], dot = Eigen::MatrixXcd::Zero(spins.levels(), spins.levels());
  for (int axis = 0; axis < 3; ++axis) {
    s_i[axis] = in_product_basis(spins, false, axis);
    s_j[axis] = in_product_basis(spins, true, axis);
    dot += s_i[axis] * s_j[axis];
  }
  const Eigen::MatrixXcd inner = spins.coupling * dot + spins.coupling_squared * dot * dot;
  double field = zones.front().field;
  Eigen::MatrixXd states = levels_at(spins, field).states;
  Eigen::MatrixXcd amplitudes = Eigen::MatrixXcd::Identity(spins.levels(), spins.levels());
  for (const LevelZone& zone : zones) {
    if (zone.field != field) states = states_after(spins, states, field, zone.field);
    field = zone.field;
    const auto slope = [&](double y, const Eigen::MatrixXcd& psi) -> Eigen::MatrixXcd {
      Eigen::Vector3d b(0, 0, zone.field);
      if (zone.drive) b += driving_field(*zone.drive, y, slowness);
      Eigen::MatrixXcd h = inner;
      for (int axis = 0; axis < 3; ++axis)
        h += b(axis) * (spins.zeeman_i * s_i[axis] + spins.zeeman_j * s_j[axis]);
      return Complex(0, -two_pi * slowness) * (h * psi);
    };
    Eigen::MatrixXcd psi = states.cast<Complex>() * amplitudes;
    const double step = (zone.end - zone.begin) / steps_of_zone;
    for (int k = 0; k < steps_of_zone; ++k) {
      const double y = zone.begin + k * step;
      const Eigen::MatrixXcd a = slope(y, psi), b = slope(y + step / 2, psi + step / 2 * a),
                             c = slope(y + step / 2, psi + step / 2 * b), d = slope(y + step, psi + step * c);
      psi += step / 6 * (a + 2 * b + 2 * c + d);
    }
    amplitudes = states.transpose() * psi;
  }
  return amplitudes.cwiseAbs2().transpose();
}

}  // namespace rabiline
