#include "simulation/transit_nodes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <numbers>

#include "core/portable_math.hpp"

namespace rabiline {
namespace {

constexpr int powers = transit_powers;
using Powers = Eigen::Matrix<double, powers, 1>;

/// A sum of moments, which may be negative.
double signed_number(Sum sum) { return static_cast<double>(static_cast<SignedSum>(sum)); }

double chebyshev_point(int j) { return portable::cos(std::numbers::pi * (j + 0.5) / powers); }

/// A polynomial through the points t_j is the sum of f(t_j) l_j(t); row j has the coefficients of l_j.
Eigen::Matrix<double, powers, powers> lagrange_polynomials() {
  Eigen::Matrix<double, powers, powers> vandermonde;
  for (int j = 0; j < powers; ++j) {
    double power = 1;
    for (int k = 0; k < powers; ++k, power *= chebyshev_point(j)) vandermonde(j, k) = power;
  }
  return vandermonde.inverse().transpose();
}

}  // namespace

TransitNodes::TransitNodes(const TransitLayout& layout, const Sum* sums)
    : layout_(layout), sums_(sums), weights_(layout.rows()) {
  const SlownessCells& cells = layout.cells();
  std::vector<bool> holds(static_cast<std::size_t>(cells.count));
  for (std::size_t row = 0; row < layout.rows(); ++row)
    for (std::size_t cell = 0; cell < holds.size(); ++cell)
      if (sums[layout.moment(row, cell, 0)] != 0) holds[cell] = true;
  std::vector<Eigen::Index> number(holds.size());
  for (std::size_t cell = 0; cell < holds.size(); ++cell) {
    if (!holds[cell]) continue;
    number[cell] = static_cast<Eigen::Index>(cells_.size());
    cells_.push_back(cell);
    for (int j = 0; j < powers; ++j)
      slowness_.push_back(cells.first +
                          cells.width * (static_cast<double>(cell) + 0.5 * (chebyshev_point(j) + 1)));
  }
  const Eigen::Matrix<double, powers, powers> lagrange = lagrange_polynomials();
  for (std::size_t row = 0; row < layout.rows(); ++row)
    for (const std::size_t cell : cells_) {
      if (sums[layout.moment(row, cell, 0)] == 0) continue;
      Powers moments;
      for (int k = 0; k < powers; ++k) moments[k] = signed_number(sums[layout.moment(row, cell, k)]);
      weights_[row].add(number[cell], lagrange * moments);
    }
}

Sum TransitNodes::booked(std::size_t row) const {
  Sum sum = 0;
  for (const std::size_t cell : cells_) sum += sums_[layout_.moment(row, cell, 0)];
  return sum;
}

TransitNodes::WholeLink TransitNodes::whole_link(std::size_t link) const {
  WholeLink whole;
  for (std::size_t from = 0; from < layout_.levels(); ++from) {
    const std::size_t ranks = layout_.paths(link, from);
    whole.paths.emplace_back(ranks, Eigen::VectorXd::Zero(size()));
    whole.pairs.emplace_back(ranks);
    for (std::size_t a = 0; a < ranks; ++a) {
      for (std::size_t bin = 0; bin < layout_.link(link).bins; ++bin)
        weights(layout_.share(link, bin, from, a)).add_to(whole.paths[from][a]);
      for (std::size_t b = 0; b < ranks; ++b) whole.pairs[from][a].push_back(pair_weights(link, from, a, b));
    }
  }
  return whole;
}

Eigen::VectorXd TransitNodes::pair_weights(std::size_t link, std::size_t from, std::size_t a,
                                           std::size_t b) const {
  if (a < b) std::swap(a, b);
  const TransitLink& kind = layout_.link(link);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(size());
  for (std::size_t bin = 0; bin < kind.bins; ++bin)
    weights(layout_.square(link, bin, from, a, b)).add_to(sum);
  if (a != b && kind.is_screen()) weights(layout_.screen(link, from, a, b)).add_to(sum);
  return sum;
}

Eigen::MatrixXd TransitNodes::shares(const SpinPath& path, const RandomKey& key, std::size_t from,
                                     const std::vector<int>& outcomes) const {
  struct alignas(64) Line {
    std::uint64_t of[8];
  };
  std::vector<Line> lines(static_cast<std::size_t>(path.outcomes()) * Batch::capacity / 8);
  std::uint64_t* shared = lines.front().of;
  Eigen::MatrixXd out(size(), static_cast<Eigen::Index>(outcomes.size()));
  Batch batch;
  BatchView& b = batch.view();
  for (std::size_t begin = 0; begin < slowness_.size(); begin += Batch::capacity) {
    const std::size_t count = std::min<std::size_t>(Batch::capacity, slowness_.size() - begin);
    b.count = b.padded = static_cast<int>(count);  // nodes come in eights
    for (const auto column : real_columns) std::fill_n(b.*column, count, 0.0);
    for (const auto column : word_columns) std::fill_n(b.*column, count, 0);
    for (std::size_t i = 0; i < count; ++i) {
      b.slowness[i] = slowness_[begin + i];
      b.vy[i] = 1 / b.slowness[i];
    }
    const UnitVector start = path.start.value_or(UnitVector{});
    std::fill_n(b.sx, count, start.x);
    std::fill_n(b.sy, count, start.y);
    std::fill_n(b.sz, count, start.z);
    std::fill_n(b.level, count, from);
    std::fill_n(b.weight, count, quanta_per_particle);
    share_levels(path, key, best_isa(), b, b.weight, shared);
    for (std::size_t rank = 0; rank < outcomes.size(); ++rank)
      for (std::size_t i = 0; i < count; ++i)
        out(static_cast<Eigen::Index>(begin + i), static_cast<Eigen::Index>(rank)) =
            static_cast<double>(shared[static_cast<std::size_t>(outcomes[rank]) * count + i]) /
            static_cast<double>(quanta_per_particle);
  }
  return out;
}

}  // namespace rabiline
