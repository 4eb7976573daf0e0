#pragma once
// What particles come to whose weight is shared between levels, by their slowness: moments from which every
// way to share the weights follows without another flight.
//
// Behind a projection a particle flies one path in each level `to` that it may be found in, and ends at one
// place on each. Its share of a path is w P(from -> to; s), and P depends on nothing but its slowness
// s = 1/v_y. So what ends somewhere is summed as w (1, t, ... t^7), t in [-1, 1] across a cell of s; a scan
// point is then the sum over cells of these moments times the polynomial of its P through 8 Chebyshev points.
// Squares of what a particle is counted with, w^2 (sum of P)^2 over the paths of one place, are summed for
// each pair of paths.
#include <cstdint>
#include <vector>

#include "transport/kernels.hpp"
#include "transport/sum_layout.hpp"

namespace rabiline {

/// The slowness in equal cells [s/m].
struct SlownessCells {
  double first = 0, width = 0;
  int count = 0;
  bool contains(double slowness) const {
    const double at = (slowness - first) / width;
    return at >= 0 && at < count;
  }
};

/// A stage behind the projection.
struct TransitLink {
  bool is_screen = false;
  ScreenSums screen{1, 1};
  double counted = 1;  // of each weight that the screen catches
};

inline constexpr int transit_powers = 8;

/// Where each moment stands: rows of 8 moments for each cell. Paths are told by their rank among the outcomes
/// that their level before the projection can lead to; pairs of paths by both ranks, the lower one last.
/// Outcomes behind the levels are those of filters, which stop them: no screen catches these.
class TransitLayout {
 public:
  /// `reach`: the outcomes that can be found, as a mask for each level before. `weights_alike`: each weight
  /// is that of a whole particle, and w^2 = w of a path needs no rows of its own.
  TransitLayout(const SlownessCells&, const std::vector<std::uint64_t>& reach,
                const std::vector<TransitLink>&, bool weights_alike);

  const SlownessCells& cells() const { return cells_; }
  bool weights_alike() const { return weights_alike_; }
  std::size_t levels() const { return outcomes_.size(); }  // before the projection
  const std::vector<int>& outcomes(std::size_t from) const { return outcomes_[from]; }
  /// How many of them are levels: the first ones.
  std::size_t caught(std::size_t from) const { return caught_before_[from + 1] - caught_before_[from]; }
  const std::vector<std::vector<int>>& all_outcomes() const { return outcomes_; }
  const TransitLink& link(std::size_t number) const { return links_[number]; }
  std::size_t links() const { return links_.size(); }
  std::size_t rows() const { return rows_; }
  /// How many cells of moments, row after row.
  std::size_t size() const { return rows_ * static_cast<std::size_t>(cells_.count); }
  /// Among the sums of the projection: a moment of a cell, and behind all of them the weight that ends at a
  /// link whatever the level, by the level before.
  std::size_t moment(std::size_t row, std::size_t cell, int power) const {
    return (row * static_cast<std::size_t>(cells_.count) + cell) * transit_powers +
           static_cast<std::size_t>(power);
  }
  std::size_t decided(std::size_t link, std::size_t from) const {
    return size() * transit_powers + link * levels() + from;
  }
  std::size_t sums() const { return decided(links(), 0); }

  /// Rows of w: of what ends at a link and is not caught, and of what a bin catches.
  std::size_t stop(std::size_t link, std::size_t from, std::size_t rank) const {
    return first_row_[link] + paths_before_[from] + rank;
  }
  std::size_t share(std::size_t link, std::size_t bin, std::size_t from, std::size_t rank) const {
    return first_row_[link] + paths_before_.back() + caught_before_.back() * bin + caught_before_[from] +
           rank;
  }
  /// Rows of w^2: of pairs of paths, one of them may be the other, that end in one bin; of pairs in different
  /// bins of a column, of a row and of a screen.
  std::size_t square(std::size_t link, std::size_t bin, std::size_t from, std::size_t a,
                     std::size_t b) const {
    if (weights_alike_ && a == b) return share(link, bin, from, a);
    return squares_begin(link) + all_pairs(!weights_alike_) * bin + pairs_before(from, !weights_alike_) +
           (weights_alike_ ? a * (a - 1) : a * (a + 1)) / 2 + b;
  }
  std::size_t column(std::size_t link, std::size_t x, std::size_t from, std::size_t a, std::size_t b) const {
    return across_begin(link) + all_pairs(false) * x + pairs_before(from, false) + a * (a - 1) / 2 + b;
  }
  std::size_t row(std::size_t link, std::size_t z, std::size_t from, std::size_t a, std::size_t b) const {
    return column(link, links_[link].screen.columns + z, from, a, b);
  }
  std::size_t screen(std::size_t link, std::size_t from, std::size_t a, std::size_t b) const {
    return row(link, links_[link].screen.rows, from, a, b);
  }

 private:
  std::size_t pairs_before(std::size_t from, bool with_itself) const {
    return pairs_before_[from] + (with_itself ? caught_before_[from] : 0);
  }
  std::size_t all_pairs(bool with_itself) const { return pairs_before(levels(), with_itself); }
  std::size_t squares_begin(std::size_t link) const { return share(link, links_[link].screen.bins(), 0, 0); }
  std::size_t across_begin(std::size_t link) const {
    return squares_begin(link) + all_pairs(!weights_alike_) * links_[link].screen.bins();
  }

  SlownessCells cells_;
  bool weights_alike_;
  std::vector<std::vector<int>> outcomes_;                                // [from] that are found
  std::vector<std::size_t> paths_before_, caught_before_, pairs_before_;  // [from + 1]
  std::vector<TransitLink> links_;
  std::vector<std::size_t> first_row_;  // [link]
  std::size_t rows_ = 0;
};

/// The moments of one cell: whole numbers, so that the order of particles cannot matter.
struct alignas(64) CellMoments {
  std::int64_t of[transit_powers] = {};
};
/// Of a weight in units of 2^-40 particle, and of a product of two weights in units of 2^-40 particle^2.
struct TransitEntry {
  std::uint64_t cell;  // which of the layout
  double t, weight;
};

/// Adds w t^k to moment k for each entry, rounded to a whole number.
RABILINE_KERNEL(add_moments, void(const TransitEntry*, std::size_t count, CellMoments*))

/// sums[i][j] += sum over k of a[i][k] b[j][k] for i >= j, as the caller's whole sum is symmetric: columns of
/// so many rows, a multiple of 8, one after the other.
RABILINE_KERNEL(add_products, void(const double* a, const double* b, std::ptrdiff_t rows,
                                   std::ptrdiff_t columns, double* sums))

}  // namespace rabiline
