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

Sum rounded(double x) { return static_cast<Sum>(std::floor(std::max(0.0, x) + 0.5)); }

/// One stage behind the projection: where its sums begin.
struct Link {
  std::size_t sums, ledger;
  int catches, reads;
  std::optional<TransitNodes::WholeScreen> whole{};  // of a screen
};

/// For each level before: of each level behind, a column over the nodes.
using Shares = std::vector<Eigen::MatrixXd>;
auto of_rank(const Eigen::MatrixXd& shares, std::size_t rank) {
  return shares.col(static_cast<Eigen::Index>(rank));
}

/// Adds the levels of what a screen counts of each weight: of each particle q, q^2, and q times all that is
/// counted of it. `outcomes`: levels of the columns; where only rank 0 was booked, it stands for all of them.
void put_levels(const TransitNodes::WholeScreen& whole, const Shares& shares,
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
      links_.push_back({next->sums, next->ledger, catches(next->stage), reads_catch_of(next->stage)});
    }
    for (std::size_t k = 0; k < links_.size(); ++k)
      if (layout_.link(k).is_screen) links_[k].whole = nodes_.whole_screen(k);
    for (std::size_t from = 0; from < layout_.levels(); ++from) inside_.push_back(inside(from));
  }

  void run(int threads, std::vector<ScreenCovariance>& covariances) {
    in_parallel(node_.ways.size(), threads, [&](std::size_t i) {
      const PlanNode::Way& way = node_.ways[i];
      put_decided(way.shift);
      Shares shares;
      for (std::size_t from = 0; from < layout_.levels(); ++from)
        shares.push_back(nodes_.shares(*path_of(way.stage), tree_.source.key, from));
      put(shares, way.shift);
    });
    for (std::size_t k = 0; k < links_.size(); ++k)
      if (layout_.link(k).is_screen)
        covariances.push_back(covariance_of(tree_, node_, nodes_, *links_[k].whole, layout_.link(k).counted,
                                            links_[k].catches, counted(k), stragglers(k), sums_, threads));
  }

 private:
  /// All that was booked of a level: its path of rank 0 ends somewhere.
  Sum inside(std::size_t from) const {
    Sum sum = 0;
    for (std::size_t k = 0; k < links_.size(); ++k) {
      sum += nodes_.booked(layout_.stop(k, from, 0));
      for (std::size_t bin = 0; layout_.link(k).is_screen && bin < layout_.link(k).screen.bins(); ++bin)
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
    for (std::size_t from = 0; from < layout_.levels(); ++from) {
      std::vector<End> ends;
      for (std::size_t k = 0; k < links_.size(); ++k) list_ends(shares[from], from, k, shift, ends);
      put_ends(ends, inside_[from]);
    }
    for (std::size_t k = 0; k < links_.size(); ++k) {
      if (layout_.link(k).is_screen) put_squares(shares, k, shift);
      if (links_[k].reads == no_part) continue;
      std::size_t screen = 0;
      while (links_[screen].catches != links_[k].reads) ++screen;
      put_levels(*links_[screen].whole, shares, layout_.all_outcomes(), layout_.link(screen).counted,
                 &sums_[links_[k].sums + shift]);
    }
  }

  void list_ends(const Eigen::MatrixXd& shares, std::size_t from, std::size_t k, std::size_t shift,
                 std::vector<End>& ends) const {
    const Link& link = links_[k];
    const std::size_t ranks = layout_.outcomes(from).size(), sums = link.sums + shift;
    const auto end_at = [&](double weight, std::vector<std::size_t> to, std::size_t ledger) {
      if (link.ledger != 0) to.push_back(link.ledger + shift + ledger);
      if (weight > 0) ends.push_back({weight, std::move(to)});
    };
    double stopped = 0;
    for (std::size_t a = 0; a < ranks; ++a)
      stopped += nodes_.weights(layout_.stop(k, from, a)).sum_of(of_rank(shares, a));
    const TransitLink& kind = layout_.link(k);
    for (std::size_t bin = 0; kind.is_screen && bin < kind.screen.bins(); ++bin) {
      double caught = 0;
      for (std::size_t a = 0; a < layout_.caught(from); ++a)
        caught += nodes_.weights(layout_.share(k, bin, from, a)).sum_of(of_rank(shares, a));
      stopped += (1 - kind.counted) * caught;
      end_at(kind.counted * caught, {sums + ScreenSums::bin(bin), sums + kind.screen.total()},
             LedgerSums::caught(from));
    }
    end_at(stopped, {sums}, LedgerSums::ended(from));
  }

  /// As whole numbers that add up to all: rounded down, the largest takes what is missing.
  void put_ends(const std::vector<End>& ends, Sum all) {
    if (all == 0) return;
    double sum = 0;
    std::size_t largest = 0;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      sum += ends[i].weight;
      if (ends[i].weight > ends[largest].weight) largest = i;
    }
    if (std::abs(sum / static_cast<double>(all) - 1) > 1e-9)
      throw std::logic_error("the moments of the slowness do not add up to what was booked");
    Sum rest = all;
    for (std::size_t i = 0; i < ends.size(); ++i) {
      if (i == largest) continue;
      const Sum part = static_cast<Sum>(std::floor(ends[i].weight));
      rest -= part;
      for (const std::size_t to : ends[i].to) sums_[to] += part;
    }
    for (const std::size_t to : ends[largest].to) sums_[to] += rest;
  }

  /// (sum of w P)^2 of each particle in each bin; what pairs of bins in a column, in a row and on the whole
  /// screen add to that.
  void put_squares(const Shares& shares, std::size_t k, std::size_t shift) {
    const TransitLink& kind = layout_.link(k);
    const ScreenSums& screen = kind.screen;
    const std::size_t sums = links_[k].sums + shift;
    const auto of_pairs = [&](bool with_itself, auto row) {
      double sum = 0;
      for (std::size_t from = 0; from < layout_.levels(); ++from)
        for (std::size_t a = 0; a < layout_.caught(from); ++a)
          for (std::size_t b = 0; b < a + (with_itself ? 1 : 0); ++b)
            sum += (a == b ? 1 : 2) *
                   nodes_.weights(row(from, a, b)).sum_of(of_rank(shares[from], a), of_rank(shares[from], b));
      return sum * kind.counted * kind.counted * quanta;
    };
    double all = 0;
    for (std::size_t bin = 0; bin < screen.bins(); ++bin) {
      const double squares = of_pairs(true, [&](auto... at) { return layout_.square(k, bin, at...); });
      sums_[sums + ScreenSums::bin(bin) + 1] += rounded(squares);
      all += squares;
    }
    if (screen.bins() > 1) {
      for (std::size_t x = 0; x < screen.columns; ++x)
        sums_[sums + screen.across_column(x)] +=
            rounded(of_pairs(false, [&](auto... at) { return layout_.column(k, x, at...); }));
      for (std::size_t z = 0; z < screen.rows; ++z)
        sums_[sums + screen.across_row(z)] +=
            rounded(of_pairs(false, [&](auto... at) { return layout_.row(k, z, at...); }));
      all += of_pairs(false, [&](auto... at) { return layout_.screen(k, at...); });
    }
    sums_[sums + screen.total() + 1] += rounded(all);
  }

  /// [particles] that a screen counted, of each way.
  Eigen::VectorXd counted(std::size_t k) const {
    Eigen::VectorXd out(static_cast<Eigen::Index>(node_.ways.size()));
    for (std::size_t way = 0; way < node_.ways.size(); ++way)
      out[static_cast<Eigen::Index>(way)] =
          static_cast<double>(
              sums_[links_[k].sums + node_.ways[way].shift + layout_.link(k).screen.total()]) /
          quanta;
    return out;
  }

  /// [particles] of them that it counted from outside the cells, for each way in each group of particles.
  Eigen::MatrixXd stragglers(std::size_t k) const {
    Eigen::MatrixXd out(static_cast<Eigen::Index>(node_.ways.size()), static_cast<Eigen::Index>(group_count));
    for (Eigen::Index way = 0; way < out.rows(); ++way)
      for (Eigen::Index group = 0; group < out.cols(); ++group)
        out(way, group) =
            static_cast<double>(sums_[links_[k].sums + node_.ways[static_cast<std::size_t>(way)].shift +
                                      layout_.link(k).screen.group(static_cast<std::size_t>(group))]) /
            quanta;
    return out;
  }

  const PlanTree& tree_;
  const PlanNode& node_;
  const TransitLayout& layout_;
  Sums& sums_;
  const TransitNodes nodes_;
  std::vector<Link> links_;
  std::vector<Sum> inside_;  // [from] what was booked as moments
};

/// Levels of what a screen caught, for every point: its level before is that of the rows of rank 0.
void contract_levels(const PlanTree& tree, const PlanNode& node, int threads, Sums& sums) {
  const TransitLayout& layout = *node.transit;
  const TransitNodes nodes(layout, sums.data() + node.moments);
  const TransitNodes::WholeScreen whole = nodes.whole_screen(0);
  std::vector<int> all(layout.levels());
  std::iota(all.begin(), all.end(), 0);
  in_parallel(node.ways.size(), threads, [&](std::size_t i) {
    const PlanNode::Way& way = node.ways[i];
    Shares shares;
    for (std::size_t from = 0; from < layout.levels(); ++from)
      shares.push_back(nodes.shares(*path_of(way.stage), tree.source.key, from, all));
    put_levels(whole, shares, {layout.levels(), all}, 1, sums.data() + node.sums + way.shift);
  });
}

void contract(const PlanTree& tree, const std::vector<PlanNode>& nodes, int threads, Sums& sums,
              std::vector<ScreenCovariance>& covariances) {
  for (const PlanNode& node : nodes) {
    if (node.transit && node.next.empty())
      contract_levels(tree, node, threads, sums);
    else if (node.transit)
      Contraction(tree, node, sums).run(threads, covariances);
    contract(tree, node.next, threads, sums, covariances);
  }
}

}  // namespace

std::vector<ScreenCovariance> contract_moments(const Plan& plan, int threads, Sums& sums) {
  std::vector<ScreenCovariance> covariances;
  for (const PlanTree& tree : plan.trees) contract(tree, tree.next, threads, sums, covariances);
  return covariances;
}

}  // namespace rabiline
