#include "simulation/contraction.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <stdexcept>

#include "core/in_parallel.hpp"
#include "simulation/counting.hpp"

namespace rabiline {
namespace {

/// One stage behind the projection: where its sums begin.
struct Link {
  std::size_t sums, ledger;
  int reads;                                       // the part whose catch it counts the levels of
  std::optional<TransitNodes::WholeLink> whole{};  // of what has groups
};

/// For each level before: of each level behind, a column over the nodes.
using Shares = std::vector<Eigen::MatrixXd>;
auto of_rank(const Eigen::MatrixXd& shares, std::size_t rank) {
  return shares.col(static_cast<Eigen::Index>(rank));
}

/// Adds the levels of what a screen counts of each weight: of each particle q, q^2, and q times all that is
/// counted of it. `outcomes`: levels of the columns; where only rank 0 was booked, it stands for all of them.
void put_levels(const TransitNodes::WholeLink& whole, const Shares& shares,
                const std::vector<std::vector<int>>& outcomes, double counted, Sum* sums) {
  const LevelLayout levels{outcomes.size()};
  for (std::size_t from = 0; from < levels.levels; ++from) {
    const bool alike = whole.paths[from].size() == 1;
    const std::size_t ranks = alike ? outcomes[from].size() : whole.paths[from].size();
    for (std::size_t a = 0; a < ranks; ++a) {
      const auto level = static_cast<std::size_t>(outcomes[from][a]);
      const std::size_t row = alike ? 0 : a;
      sums[LevelLayout::q(level)] += rounded(counted * whole.paths[from][row].dot(of_rank(shares[from], a)));
      double product = 0;
      for (std::size_t b = 0; b < ranks; ++b) {
        const auto both = of_rank(shares[from], a).cwiseProduct(of_rank(shares[from], b));
        const double pair = counted * counted * quanta * whole.pairs[from][row][alike ? 0 : b].dot(both);
        if (a == b) sums[LevelLayout::squares(level)] += rounded(pair);
        product += pair;
      }
      if (levels.has_products()) sums[levels.products(level)] += rounded(product);
    }
  }
}

/// What ends at one place, and the sums that it goes to.
struct End {
  double weight;  // [quanta]
  std::vector<std::size_t> to;
};

/// The moments of one projection.
class Contraction {
 public:
  Contraction(const PlanTree& tree, const PlanNode& node, Sums& sums)
      : tree_(tree),
        node_(node),
        layout_(*node.transit),
        sums_(sums),
        nodes_(layout_, sums.data() + node.moments) {
    for (const PlanNode* next = &node; !next->next.empty();) {
      next = &next->next.front();
      const bool counts_levels = traits_of(next->stage).counts_levels;
      links_.push_back({next->sums, next->ledger, counts_levels ? reads_catch_of(next->stage) : no_part});
    }
    for (std::size_t k = 0; k < links_.size(); ++k)
      if (layout_.link(k).groups) links_[k].whole = nodes_.whole_link(k);
    for (std::size_t from = 0; from < layout_.levels(); ++from) booked_.push_back(booked(from));
  }

  void run(int threads, std::vector<CountCovariance>& covariances) {
    in_parallel(node_.reweightings.size(), threads, [&](std::size_t i) {
      const PlanNode::Reweighting& reweighting = node_.reweightings[i];
      put_decided(reweighting.shift);
      Shares shares;
      for (std::size_t from = 0; from < layout_.levels(); ++from)
        shares.push_back(nodes_.shares(*path_of(reweighting.stage), tree_.source.key, from));
      put(shares, reweighting.shift);
    });
    for (std::size_t k = 0; k < links_.size(); ++k)
      if (layout_.link(k).groups)
        covariances.push_back(covariance_of(tree_, node_, nodes_, k, *links_[k].whole, counted(k),
                                            stragglers(k), sums_, threads));
  }

 private:
  /// All that was booked of a level: its path of rank 0 ends somewhere.
  Sum booked(std::size_t from) const {
    Sum sum = 0;
    for (std::size_t k = 0; k < links_.size(); ++k) {
      if (!layout_.link(k).ends) continue;
      sum += nodes_.booked(layout_.stop(k, from, 0));
      for (std::size_t bin = 0; bin < layout_.link(k).bins; ++bin)
        sum += nodes_.booked(layout_.share(k, bin, from, 0));
    }
    return sum;
  }

  /// What ends alike in every level.
  void put_decided(std::size_t shift) {
    for (std::size_t k = 0; k < links_.size(); ++k)
      for (std::size_t from = 0; from < layout_.levels(); ++from) {
        const Sum q = sums_[node_.moments + layout_.decided(k, from)];
        if (q == 0) continue;
        sums_[links_[k].sums + shift] += q;
        if (links_[k].ledger != 0) sums_[links_[k].ledger + shift + LedgerSums::ended(from)] += q;
      }
  }

  void put(const Shares& shares, std::size_t shift) {
    for (std::size_t from = 0; from < layout_.levels(); ++from) put_ends(shares[from], from, shift);
    for (std::size_t k = 0; k < links_.size(); ++k) {
      put_squares(shares, k, shift);
      put_places(shares, k, shift);
      if (links_[k].reads == no_part) continue;
      const std::size_t screen = layout_.link(k).whole;
      put_levels(*links_[screen].whole, shares, layout_.all_outcomes(), layout_.link(screen).counted,
                 &sums_[links_[k].sums + shift]);
    }
  }

  /// All that is booked ends; what is seen on the way is divided as what was counted there.
  void put_ends(const Eigen::MatrixXd& shares, std::size_t from, std::size_t shift) {
    const auto whole_at = [&](std::size_t k) { return links_[k].sums + shift + layout_.link(k).whole_sum(); };
    std::vector<Sum> before;
    std::vector<End> ends;
    for (std::size_t k = 0; k < links_.size(); ++k) {
      before.push_back(layout_.link(k).groups ? sums_[whole_at(k)] : 0);
      if (layout_.link(k).ends) list_ends(shares, from, k, shift, ends);
    }
    divide(ends, booked_[from], booked_[from]);
    for (std::size_t k = 0; k < links_.size(); ++k) {
      const TransitLink& kind = layout_.link(k);
      if (kind.ends || kind.bins == 0) continue;
      std::vector<End> seen;
      double uncounted = 0;
      const double sum = list_bins(shares, from, k, shift, seen, uncounted);
      divide(seen, kind.whole == k ? rounded(sum) : sums_[whole_at(kind.whole)] - before[kind.whole],
             booked_[from]);
    }
  }

  void list_ends(const Eigen::MatrixXd& shares, std::size_t from, std::size_t k, std::size_t shift,
                 std::vector<End>& ends) const {
    const Link& link = links_[k];
    double stopped = 0;
    for (std::size_t a = 0; a < layout_.paths(k, from); ++a)
      stopped += nodes_.weights(layout_.stop(k, from, a)).sum_of(of_rank(shares, a));
    list_bins(shares, from, k, shift, ends, stopped);
    std::vector<std::size_t> to{link.sums + shift};
    if (link.ledger != 0) to.push_back(link.ledger + shift + LedgerSums::ended(from));
    if (stopped > 0) ends.push_back({stopped, std::move(to)});
  }

  /// What is counted in the bins of a link; also, what of that is in all of them.
  double list_bins(const Eigen::MatrixXd& shares, std::size_t from, std::size_t k, std::size_t shift,
                   std::vector<End>& ends, double& uncounted) const {
    const Link& link = links_[k];
    const TransitLink& kind = layout_.link(k);
    double sum = 0;
    for (std::size_t bin = 0; bin < kind.bins; ++bin) {
      double caught = 0;
      for (std::size_t a = 0; a < layout_.paths(k, from); ++a)
        caught += nodes_.weights(layout_.share(k, bin, from, a)).sum_of(of_rank(shares, a));
      uncounted += (1 - kind.counted) * caught;
      const double weight = kind.counted * caught;
      sum += weight;
      if (weight <= 0 && !ends.empty()) continue;
      std::vector<std::size_t> to{link.sums + shift + kind.first_bin + 2 * bin};
      if (kind.total) to.push_back(link.sums + shift + *kind.total);
      if (link.ledger != 0) to.push_back(link.ledger + shift + LedgerSums::caught(from));
      ends.push_back({weight, std::move(to)});
    }
    return sum;
  }

  /// As whole numbers that add up to all: rounded down, the largest takes what is missing. `booked`: of which
  /// this is a part.
  void divide(const std::vector<End>& ends, Sum all, Sum booked) {
    if (all == 0) return;
    double sum = 0;
    std::size_t largest = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      sum += ends[i].weight;
      if (ends[i].weight > ends[largest].weight) largest = i;
    }
    if (std::abs(sum - static_cast<double>(all)) > 1e-9 * static_cast<double>(booked))
      throw std::logic_error("the moments of the slowness do not add up to what was booked");
    Sum rest = all;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (i == largest) continue;
      const Sum part = std::min(rest, static_cast<Sum>(std::max(0.0, ends[i].weight)));
      rest -= part;
      for (const std::size_t to : ends[i].to) sums_[to] += part;
    }
    for (const std::size_t to : ends[largest].to) sums_[to] += rest;
  }

  /// (sum of w P)^2 of each particle in each bin; what pairs of bins in a column, in a row and on the whole
  /// screen add to that.
  void put_squares(const Shares& shares, std::size_t k, std::size_t shift) {
    const TransitLink& kind = layout_.link(k);
    const std::size_t sums = links_[k].sums + shift;
    const auto of_pairs = [&](bool with_itself, auto row) {
      double sum = 0;
      for (std::size_t from = 0; from < layout_.levels(); ++from)
        for (std::size_t a = 0; a < layout_.paths(k, from); ++a)
          for (std::size_t b = 0; b < a + (with_itself ? 1 : 0); ++b)
            sum += (a == b ? 1 : 2) *
                   nodes_.weights(row(from, a, b)).sum_of(of_rank(shares[from], a), of_rank(shares[from], b));
      return sum * kind.counted * kind.counted * quanta;
    };
    double all = 0;
    for (std::size_t bin = 0; bin < kind.bins; ++bin) {
      const double squares = of_pairs(true, [&](auto... at) { return layout_.square(k, bin, at...); });
      sums_[sums + kind.first_bin + 2 * bin + 1] += rounded(squares);
      all += squares;
    }
    if (!kind.is_screen()) return;
    const ScreenSums screen{kind.columns, kind.rows};
    if (kind.bins > 1) {
      for (std::size_t x = 0; x < kind.columns; ++x)
        sums_[sums + screen.across_column(x)] +=
            rounded(of_pairs(false, [&](auto... at) { return layout_.column(k, x, at...); }));
      for (std::size_t z = 0; z < kind.rows; ++z)
        sums_[sums + screen.across_row(z)] +=
            rounded(of_pairs(false, [&](auto... at) { return layout_.row(k, z, at...); }));
      all += of_pairs(false, [&](auto... at) { return layout_.screen(k, at...); });
    }
    sums_[sums + *kind.total + 1] += rounded(all);
  }

  /// What is inside the axes of a tally, and where.
  void put_places(const Shares& shares, std::size_t k, std::size_t shift) {
    const TransitLink& kind = layout_.link(k);
    if (kind.axes == 0) return;
    const HistogramSums tally{kind.bins - 1, kind.axes};
    const auto of_paths = [&](auto row) {
      double sum = 0;
      for (std::size_t from = 0; from < layout_.levels(); ++from)
        for (std::size_t a = 0; a < layout_.paths(k, from); ++a)
          sum += nodes_.weights(row(from, a)).sum_of(of_rank(shares[from], a));
      return sum * kind.counted;
    };
    for (std::size_t group = 0; group < moment_groups; ++group) {
      const double inside = of_paths([&](auto... at) { return layout_.inside(k, group, at...); });
      for (std::size_t axis = 0; axis < kind.axes; ++axis) {
        Sum* to = &sums_[links_[k].sums + shift + kind.first_bin + tally.moments(axis, group)];
        const auto place = [&](int power) {
          return of_paths([&](auto... at) { return layout_.place(k, axis, group, power, at...); });
        };
        to[0] += rounded(inside);
        to[1] += rounded(place(1) * moment_steps);
        to[2] += rounded(place(2) * moment_steps * moment_steps);
      }
    }
  }

  /// [particles] that a link counted, of each reweighting.
  Eigen::VectorXd counted(std::size_t k) const {
    Eigen::VectorXd out(static_cast<Eigen::Index>(node_.reweightings.size()));
    for (std::size_t one = 0; one < node_.reweightings.size(); ++one)
      out[static_cast<Eigen::Index>(one)] =
          static_cast<double>(
              sums_[links_[k].sums + node_.reweightings[one].shift + layout_.link(k).whole_sum()]) /
          quanta;
    return out;
  }

  /// [particles] of them that it counted from outside the cells, for each reweighting in each group of
  /// particles.
  Eigen::MatrixXd stragglers(std::size_t k) const {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(node_.reweightings.size()),
                        static_cast<Eigen::Index>(group_count));
    for (Eigen::Index one = 0; one < out.rows(); ++one)
      for (Eigen::Index group = 0; group < out.cols(); ++group)
        out(one, group) = static_cast<double>(
                              sums_[links_[k].sums + node_.reweightings[static_cast<std::size_t>(one)].shift +
                                    *layout_.link(k).groups + static_cast<std::size_t>(group)]) /
                          quanta;
    return out;
  }

  const PlanTree& tree_;
  const PlanNode& node_;
  const TransitLayout& layout_;
  Sums& sums_;
  const TransitNodes nodes_;
  std::vector<Link> links_;
  std::vector<Sum> booked_;  // [from] as moments
};

/// Levels of what a screen caught, for every point: its level before is that of the rows of rank 0.
void contract_levels(const PlanTree& tree, const PlanNode& node, int threads, Sums& sums) {
  const TransitLayout& layout = *node.transit;
  const TransitNodes nodes(layout, sums.data() + node.moments);
  const TransitNodes::WholeLink whole = nodes.whole_link(0);
  std::vector<int> all(layout.levels());
  std::iota(all.begin(), all.end(), 0);
  in_parallel(node.reweightings.size(), threads, [&](std::size_t i) {
    const PlanNode::Reweighting& reweighting = node.reweightings[i];
    Shares shares;
    for (std::size_t from = 0; from < layout.levels(); ++from)
      shares.push_back(nodes.shares(*path_of(reweighting.stage), tree.source.key, from, all));
    put_levels(whole, shares, {layout.levels(), all}, 1, sums.data() + node.sums + reweighting.shift);
  });
}

void contract(const PlanTree& tree, const std::vector<PlanNode>& nodes, int threads, Sums& sums,
              std::vector<CountCovariance>& covariances) {
  for (const PlanNode& node : nodes) {
    if (node.transit && node.next.empty())
      contract_levels(tree, node, threads, sums);
    else if (node.transit)
      Contraction(tree, node, sums).run(threads, covariances);
    contract(tree, node.next, threads, sums, covariances);
  }
}

}  // namespace

std::vector<CountCovariance> contract_moments(const Plan& plan, int threads, Sums& sums) {
  std::vector<CountCovariance> covariances;
  for (const PlanTree& tree : plan.trees) contract(tree, tree.next, threads, sums, covariances);
  return covariances;
}

}  // namespace rabiline
