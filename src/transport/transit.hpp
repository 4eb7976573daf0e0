#pragma once
// What particles come to whose weight is shared between levels, by their slowness: moments from which every
// reweighting follows without another flight.
//
// Behind a projection a particle flies one path in each level `to` that it may be found in, and ends at one
// place on each. Its share of a path is w P(from -> to; s), and P depends on nothing but its slowness
// s = 1/v_y. So what ends somewhere is summed as w (1, t, ... t^7), t in [-1, 1] across a cell of s; a scan
// point is then the sum over cells of these moments times the polynomial of its P through 8 Chebyshev points.
// Squares of what a particle is counted with, w^2 (sum of P)^2 over the paths of one place, are summed for
// each pair of paths. What a monitor or a tally sees on the way is summed likewise, and for the mean of a
// place u also w u and w u^2.
#include <cstdint>
#include <optional>
#include <vector>

#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"
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

/// A stage behind the projection. Particles end there, in its bins or outside of them; or it only looks in
/// which of its bins they are. A bin has q and q^2 among the stage's sums, and the next one follows.
struct TransitLink {
  std::size_t outcomes = 0;  // of the projection that come to it: the first ones
  bool ends = true;
  std::size_t bins = 0;
  std::size_t columns = 0, rows = 0;  // that the bins of a screen stand in
  std::size_t axes = 0;               // of a tally that have means; the last of its bins is outside of them
  double counted = 1;                 // of each weight in a bin
  int part = no_part, plane = 0;      // whose bins they are
  std::size_t whole = 0;              // the link whose bins have the same in all: itself, or what it tallies
  // Where among the stage's sums:
  std::size_t first_bin = 0;
  std::optional<std::size_t> total{};   // q and q^2 of all bins of a screen
  std::optional<std::size_t> groups{};  // q of every group of particles

  bool is_screen() const { return columns > 0; }
  bool is_tally() const { return !ends && bins > 0 && !groups; }
  std::size_t whole_sum() const { return total.value_or(first_bin); }
};

inline constexpr int transit_powers = 8;

/// Where each moment stands: rows of 8 moments for each cell. Paths are told by their rank among the outcomes
/// that their level before the projection can lead to; pairs of paths by both ranks, the lower one last.
/// Outcomes behind the levels are those of filters, which stop them, those of the last filter first.
class TransitLayout {
 public:
  /// `reachable`: the outcomes that can be found, as a mask for each level before. `weights_alike`: each
  /// weight is that of a whole particle, and w^2 = w of a path needs no rows of its own.
  TransitLayout(const SlownessCells&, const std::vector<std::uint64_t>& reachable,
                const std::vector<TransitLink>&, bool weights_alike);

  const SlownessCells& cells() const { return cells_; }
  bool weights_alike() const { return weights_alike_; }
  std::size_t levels() const { return outcomes_.size(); }  // before the projection
  const std::vector<int>& outcomes(std::size_t from) const { return outcomes_[from]; }
  /// How many of them come to a link: the first ones.
  std::size_t paths(std::size_t link, std::size_t from) const {
    return rows_of_[link].paths_before[from + 1] - rows_of_[link].paths_before[from];
  }
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

  /// Rows of w: of what ends at a link and is in no bin, and of what is in a bin.
  std::size_t stop(std::size_t link, std::size_t from, std::size_t rank) const {
    return rows_of_[link].stops + path(link, from, rank);
  }
  std::size_t share(std::size_t link, std::size_t bin, std::size_t from, std::size_t rank) const {
    return rows_of_[link].shares + paths(link) * bin + path(link, from, rank);
  }
  /// Rows of w^2: of pairs of paths, one of them may be the other, that are in one bin; of pairs in different
  /// bins of a column, of a row and of a screen.
  std::size_t square(std::size_t link, std::size_t bin, std::size_t from, std::size_t a,
                     std::size_t b) const {
    if (weights_alike_ && a == b) return share(link, bin, from, a);
    return rows_of_[link].squares + pairs(link, !weights_alike_) * bin +
           pairs_before(link, from, !weights_alike_) + (weights_alike_ ? a * (a - 1) : a * (a + 1)) / 2 + b;
  }
  std::size_t column(std::size_t link, std::size_t x, std::size_t from, std::size_t a, std::size_t b) const {
    return rows_of_[link].across + pairs(link, false) * x + pairs_before(link, from, false) +
           a * (a - 1) / 2 + b;
  }
  std::size_t row(std::size_t link, std::size_t z, std::size_t from, std::size_t a, std::size_t b) const {
    return column(link, links_[link].columns + z, from, a, b);
  }
  std::size_t screen(std::size_t link, std::size_t from, std::size_t a, std::size_t b) const {
    return row(link, links_[link].rows, from, a, b);
  }
  /// Rows of what is inside the axes of a tally, for each group of particles: of w, and for each axis of w u
  /// and w u^2, u from 0 to 1 along it.
  std::size_t inside(std::size_t link, std::size_t group, std::size_t from, std::size_t rank) const {
    return rows_of_[link].means + paths(link) * (1 + 2 * links_[link].axes) * group + path(link, from, rank);
  }
  std::size_t place(std::size_t link, std::size_t axis, std::size_t group, int power, std::size_t from,
                    std::size_t rank) const {
    return inside(link, group, from, rank) + paths(link) * (2 * axis + static_cast<std::size_t>(power));
  }

 private:
  struct RowsOfLink {
    std::vector<std::size_t> paths_before{0}, pairs_before{0};  // [from + 1]
    std::size_t stops = 0, shares = 0, squares = 0, across = 0, means = 0;
  };
  std::size_t path(std::size_t link, std::size_t from, std::size_t rank) const {
    return rows_of_[link].paths_before[from] + rank;
  }
  std::size_t paths(std::size_t link) const { return rows_of_[link].paths_before.back(); }
  std::size_t pairs_before(std::size_t link, std::size_t from, bool with_itself) const {
    return rows_of_[link].pairs_before[from] + (with_itself ? rows_of_[link].paths_before[from] : 0);
  }
  std::size_t pairs(std::size_t link, bool with_itself) const {
    return pairs_before(link, levels(), with_itself);
  }
  void add_link(std::size_t link, const std::vector<std::uint64_t>& reachable);

  SlownessCells cells_;
  bool weights_alike_;
  std::vector<std::vector<int>> outcomes_;  // [from] that are found
  std::vector<TransitLink> links_;
  std::vector<RowsOfLink> rows_of_;  // [link]
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
