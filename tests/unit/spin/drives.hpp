#pragma once
// What the tests of driven levels share.
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>

#include "spin/coupled_spins.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

constexpr int positive = 1, negative = -1, oscillating = 0;  // as sense_of() has them
constexpr double slowest = 0.02;                             // [s/m]

inline RotatingTerm drive(int sense, double amplitude, double frequency, double phase = 0) {
  RotatingTerm out;
  out.motion = sense == 0 ? FieldMotion::swings_in_rotating_wave : FieldMotion::turns;
  out.oscillator.turn = sense < 0 ? Turn::negative : Turn::positive;
  out.amplitude = amplitude;
  out.oscillator.frequency = frequency;
  out.oscillator.phase = phase;
  return out;
}
inline RotatingTerm along_z(RotatingTerm out) {
  out.first = {0, 0, 1};
  return out;
}
inline RotatingTerm on_clock(RotatingTerm out, int clock, bool random = false) {
  out.oscillator.part = clock;
  out.oscillator.random_phase = random;
  return out;
}

/// An electron without a nucleus: E = B zeeman_j m, so m = +1/2 (level 0) is the upper level.
inline CoupledSpins half() { return {.twice_j = 1, .zeeman_j = 2.8e10}; }
/// Levels a few hundred kilohertz apart, which small steps in the laboratory can follow. J = 3/2: with
/// (I.J)^2 levels of one m_F come close to each other and their states may change sign.
inline CoupledSpins small_atom(int twice_i, int twice_j) {
  return {.twice_i = twice_i,
          .twice_j = twice_j,
          .coupling = 2e5,
          .coupling_squared = twice_j > 1 ? 2e4 : 0,
          .zeeman_i = -4e8,
          .zeeman_j = 1.4e10};
}

inline double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

inline void expect_doubly_stochastic(const Eigen::MatrixXd& p) {
  EXPECT_FALSE(p.hasNaN());
  EXPECT_LT((p.rowwise().sum().array() - 1).abs().maxCoeff(), 2e-11);
  EXPECT_LT((p.colwise().sum().array() - 1).abs().maxCoeff(), 2e-11);
}

inline double rabi(double w1, double detuning, double time) {  // [rad/s], [s]
  const double w = std::hypot(w1, detuning);
  return std::pow(w1 / w * std::sin(w * time / 2), 2);
}

}  // namespace rabiline
