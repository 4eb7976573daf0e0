#pragma once
// Amplitudes that are mixed by fixed matrices and turned by angles that grow with a particle's slowness.
#include <Eigen/Core>
#include <vector>

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
  /// a_k -> exp(2 pi i sum_c n_ck x_c) a_k, with x_c the same in all calls and evenly spread over [0, 1).
  void turn_at_random(const Eigen::MatrixXi& n);

  /// Row: to, column: from. Random angles are zero.
  Eigen::MatrixXcd amplitudes(double slowness) const;
  /// Row: from, column: to; the mean over the random angles. The probabilities are polynomials in
  /// exp(2 pi i x_c), so the mean over more equal steps than their degree is exact.
  Eigen::MatrixXd probabilities(double slowness) const;

 private:
  /// The amplitudes' real parts and beside them the imaginary ones: a real matrix mixes both in one product.
  using Pairs = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  struct Step {
    Pairs mixing{};  // first this, then the turn
    Eigen::VectorXd angle{}, rate{};
    bool turns = false;
  };
  struct Segment {
    Eigen::MatrixXi random{};  // how the random angles turn the levels before it
    std::vector<Step> steps{};
  };
  void begin_step(const Eigen::MatrixXd& matrix);
  Pairs product_of(const Segment& segment, double slowness) const;
  std::vector<int> samples() const;

  int levels_, random_angles_;
  bool mixed_ = false;
  std::vector<Segment> segments_;
};

}  // namespace rabiline
