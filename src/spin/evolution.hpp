#pragma once
// Amplitudes that are mixed by fixed matrices and turned by angles that grow with a particle's slowness.
#include <Eigen/Core>
#include <vector>

#include "spin/level_block.hpp"

namespace rabiline {

/// A product of mixings and turns, the earliest on the right. Everything that does not depend on the slowness
/// s = 1/v [s/m] is multiplied out when it is added.
class Evolution {
 public:
  Evolution(int levels, int random_angles);
  /// a -> m a
  void mix(const Eigen::MatrixXd& matrix);
  /// a_k -> exp(-2 pi i (angle_k + rate_k s)) a_k; rates in cycles per s/m. Turns of the levels before the
  /// first mixing are left out: a start in one level knows nothing of them.
  void turn(const Eigen::VectorXd& angle, const Eigen::VectorXd& rate);
  /// a_k -> exp(-2 pi i sum_c n_ck x_c) a_k, with x_c the same in all calls and evenly spread over [0, 1).
  void turn_at_random(const Eigen::MatrixXi& n);

  bool mixes() const { return !steps_.empty(); }
  /// Row: to, column: from. Random angles are zero.
  Eigen::MatrixXcd amplitudes(double slowness) const;
  /// All of it as numbers, where it mixes, added behind those that are there. Probabilities are polynomials
  /// in exp(2 pi i x_c), so that their mean over more equal steps of x_c than their degree is exact.
  LevelBlock lay_out(std::vector<double>& numbers) const;

 private:
  struct Step {
    Eigen::MatrixXd mixing{};  // first this, then the turn
    Eigen::VectorXd angle{}, rate{};
    Eigen::MatrixXi random{};  // n_ck
    bool turns = false;
  };
  std::vector<int> samples() const;

  int levels_, random_angles_;
  std::vector<Step> steps_{};  // empty until something mixes
};

}  // namespace rabiline
