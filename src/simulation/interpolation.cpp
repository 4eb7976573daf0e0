#include "simulation/interpolation.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/in_parallel.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

/// Sums that add up to one number: to that at another place, or to what every node has alike.
struct Whole {
  std::vector<std::size_t> parts{};
  std::optional<std::size_t> total{};
};

/// All wholes among the sums behind a projection, each behind what it adds up to.
class Wholes : public SumSink {
 public:
  Wholes(const PlanTree& tree, const PlanNode& projection) : all(1 + tree.ledger_levels) {
    for (const PlanNode* node = &projection; !node->next.empty();) {
      node = &node->next.front();
      begin_ = node->sums - projection.sums;
      list_sums(node->stage, *this);
      if (node->ledger == 0) continue;
      for (std::size_t level = 0; level < tree.ledger_levels; ++level)
        for (const std::size_t at : {LedgerSums::caught(level), LedgerSums::ended(level)})
          all[1 + level].parts.push_back(node->ledger - projection.sums + at);
    }
  }
  /// All fates, of each prepared level its ledger, the bins of each screen and of each tally.
  std::vector<Whole> all;

 private:
  void fate(std::string_view, int, std::size_t at) override { all.front().parts.push_back(begin_ + at); }
  void screen(int part, const ScreenSums& layout, std::size_t at) override {
    Whole& bins = all.emplace_back(Whole{{}, begin_ + at + layout.total()});
    for (std::size_t bin = 0; bin < layout.bins(); ++bin)
      bins.parts.push_back(begin_ + at + ScreenSums::bin(bin));
    totals_[{part, 0}] = *bins.total;
  }
  void plane(int part, int plane, std::size_t at) override {
    totals_[{part, plane}] = begin_ + at + CensusSums::total();
  }
  void histogram(int part, int, int plane, const HistogramSums& layout, std::size_t at) override {
    Whole& bins = all.emplace_back(Whole{{}, totals_.at({part, plane})});
    for (std::size_t bin = 0; bin <= layout.bins; ++bin)
      bins.parts.push_back(begin_ + at + HistogramSums::bin(bin));
  }

  std::size_t begin_ = 0;                              // of the stage at hand
  std::map<std::pair<int, int>, std::size_t> totals_;  // of a part and a plane
};

/// The sums behind one projection.
class Interpolation {
 public:
  Interpolation(const PlanTree& tree, const PlanNode& node, Sums& sums)
      : node_(node), size_(sums_of_reweighting(node)), sums_(sums), wholes_(Wholes(tree, node).all) {}

  void run(int threads) {
    for (std::size_t number = 0; number < node_.classes.front().families.size(); ++number) {
      const Family family = family_of(number);
      in_parallel((family.members.size() + at_once - 1) / at_once, threads,
                  [&](std::size_t block) { put(family, block * at_once); });
    }
  }

 private:
  /// Reweightings that are worked out together, so that what nodes have is read once for all of them.
  static constexpr std::size_t at_once = 4;
  /// What nodes have of one family, in every class of particles.
  struct Family {
    const std::vector<std::size_t>& members;
    std::vector<std::size_t> places{};  // where anything is
    struct Known {
      const FrequencyNodes& nodes;
      std::vector<double> sums{};  // [node][place]
    };
    std::vector<Known> known{};
    std::vector<Sum> booked{};  // [whole] of all its parts, at one node of each class
  };

  Family family_of(std::size_t number) const {
    Family family{node_.classes.front().families[number].reweightings};
    family.booked.resize(wholes_.size());
    std::vector<bool> holds(size_);
    for (const SlownessClass& of : node_.classes) {
      const FrequencyNodes& nodes = of.families[number];
      family.known.push_back({nodes});
      for (std::size_t k = 0; k < nodes.nodes.size() * size_; ++k)
        if (sums_[nodes.sums + k] != 0) holds[k % size_] = true;
      for (std::size_t whole = 0; whole < wholes_.size(); ++whole)
        for (const std::size_t place : wholes_[whole].parts)
          family.booked[whole] += sums_[nodes.sums + place];
    }
    for (std::size_t k = 0; k < size_; ++k)
      if (holds[k]) family.places.push_back(k);
    for (Family::Known& known : family.known)
      for (std::size_t j = 0; j < known.nodes.nodes.size(); ++j)
        for (const std::size_t place : family.places)
          known.sums.push_back(static_cast<double>(sums_[known.nodes.sums + j * size_ + place]));
    return family;
  }

  void put(const Family& family, std::size_t first) {
    const std::size_t places = family.places.size(), count = std::min(at_once, family.members.size() - first);
    std::vector<double> found(at_once * places);
    for (const Family::Known& known : family.known) {
      const std::size_t nodes = known.nodes.nodes.size();
      for (std::size_t j = 0; j < nodes; ++j) {
        double weights[at_once] = {};
        for (std::size_t m = 0; m < count; ++m) weights[m] = known.nodes.weights[(first + m) * nodes + j];
        const double* sums = &known.sums[j * places];
        for (std::size_t k = 0; k < places; ++k)
          for (std::size_t m = 0; m < at_once; ++m) found[k * at_once + m] += weights[m] * sums[k];
      }
    }
    for (std::size_t m = 0; m < count; ++m) {
      std::vector<Sum> rounded(size_);
      for (std::size_t k = 0; k < places; ++k)
        rounded[family.places[k]] = static_cast<Sum>(std::max(0.0, found[k * at_once + m]) + 0.5);
      for (std::size_t whole = 0; whole < wholes_.size(); ++whole) {
        const std::optional<std::size_t> total = wholes_[whole].total;
        complete(wholes_[whole].parts, total ? rounded[*total] : family.booked[whole], rounded);
      }
      Sum* to = &sums_[node_.sums + node_.reweightings[family.members[first + m]].shift];
      for (const std::size_t place : family.places) to[place] += rounded[place];
    }
  }

  /// The largest part takes what rounding has left.
  static void complete(const std::vector<std::size_t>& parts, Sum wanted, std::vector<Sum>& rounded) {
    Sum all = 0;
    std::size_t largest = parts.empty() ? 0 : parts.front();
    for (const std::size_t part : parts) {
      all += rounded[part];
      if (rounded[part] > rounded[largest]) largest = part;
    }
    if (all == wanted) return;
    if (static_cast<double>(std::max(all, wanted) - std::min(all, wanted)) >
            1e-9 * static_cast<double>(wanted) + static_cast<double>(parts.size()) ||
        rounded[largest] + wanted < all)
      throw std::logic_error("what was interpolated does not add up to what was booked");
    rounded[largest] += wanted - all;
  }

  const PlanNode& node_;
  const std::size_t size_;
  Sums& sums_;
  const std::vector<Whole> wholes_;
};

void interpolate(const PlanTree& tree, const std::vector<PlanNode>& nodes, int threads, Sums& sums) {
  for (const PlanNode& node : nodes)
    if (!node.classes.empty())
      Interpolation(tree, node, sums).run(threads);
    else if (!node.transit)
      interpolate(tree, node.next, threads, sums);
}

}  // namespace

void interpolate(const Plan& plan, int threads, Sums& sums) {
  for (const PlanTree& tree : plan.trees) interpolate(tree, tree.next, threads, sums);
}

}  // namespace rabiline
