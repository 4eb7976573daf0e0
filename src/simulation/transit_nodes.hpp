#pragma once
// The moments of one projection as weights at places of the slowness, where probabilities are asked for.
#include <Eigen/Core>
#include <vector>

#include "transport/spin_path.hpp"
#include "transport/transit.hpp"

namespace rabiline {

/// Weights at the nodes of those cells that hold anything.
class NodeWeights {
 public:
  static constexpr Eigen::Index in_cell = transit_powers;
  using OfCell = Eigen::Matrix<double, in_cell, 1>;
  void add(Eigen::Index cell, const OfCell& weights) { cells_.emplace_back(cell, weights); }
  /// The sum over nodes of weight times f, or times f and g.
  double sum_of(const Eigen::Ref<const Eigen::VectorXd>& f) const {
    double sum = 0;
    for (const auto& [cell, weights] : cells_) sum += weights.dot(f.segment<in_cell>(cell * in_cell));
    return sum;
  }
  double sum_of(const Eigen::Ref<const Eigen::VectorXd>& f,
                const Eigen::Ref<const Eigen::VectorXd>& g) const {
    double sum = 0;
    for (const auto& [cell, weights] : cells_)
      sum += weights.dot(f.segment<in_cell>(cell * in_cell).cwiseProduct(g.segment<in_cell>(cell * in_cell)));
    return sum;
  }
  void add_to(Eigen::VectorXd& all) const {
    for (const auto& [cell, weights] : cells_) all.segment<in_cell>(cell * in_cell) += weights;
  }

 private:
  std::vector<std::pair<Eigen::Index, OfCell>> cells_;
};

/// Eight Chebyshev points in each cell that holds anything: a sum of w f(s) over the particles of a row is
/// weights(row).sum_of(f at the nodes) for every f that is a polynomial of degree 7 across each cell.
class TransitNodes {
 public:
  /// `sums`: those of the layout.
  TransitNodes(const TransitLayout& layout, const Sum* sums);

  Eigen::Index size() const { return static_cast<Eigen::Index>(slowness_.size()); }
  /// [quanta] of a row of w; of a row of w^2 in units of 2^-40 particle^2.
  const NodeWeights& weights(std::size_t row) const { return weights_[row]; }
  /// All that was booked in a row of w, exactly.
  Sum booked(std::size_t row) const;
  /// What a link has in its bins of each path, and of each pair of them, whatever the bins.
  struct WholeLink {
    std::vector<std::vector<Eigen::VectorXd>> paths;               // [from][rank]: weights of w
    std::vector<std::vector<std::vector<Eigen::VectorXd>>> pairs;  // [from][rank][rank]: weights of w^2
  };
  WholeLink whole_link(std::size_t link) const;

  /// What the kernel that shares out weights gives to each outcome of a level: [node][rank].
  Eigen::MatrixXd shares(const SpinPath& path, const RandomKey& key, std::size_t from) const {
    return shares(path, key, from, layout_.outcomes(from));
  }
  /// The flip probability of a spin 1/2 that turns likewise: [node].
  Eigen::VectorXd flips(SpinPath path, const RandomKey& key) const {
    path.levels = 2;
    return shares(path, key, 0, {1});
  }
  Eigen::MatrixXd shares(const SpinPath&, const RandomKey&, std::size_t from,
                         const std::vector<int>& outcomes) const;

 private:
  Eigen::VectorXd pair_weights(std::size_t link, std::size_t from, std::size_t a, std::size_t b) const;

  const TransitLayout& layout_;
  const Sum* sums_;
  std::vector<std::size_t> cells_;    // that hold anything
  std::vector<double> slowness_;      // [s/m]
  std::vector<NodeWeights> weights_;  // [row]
};

}  // namespace rabiline
