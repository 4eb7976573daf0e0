#include "simulation/interpolation.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/in_parallel.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

/// Where fates stand among the sums of a stage.
class FatePlaces : public SumSink {
 public:
  explicit FatePlaces(const Stage& stage) { list_sums(stage, *this); }
  std::vector<std::size_t> places;

 private:
  void fate(std::string_view, int, std::size_t at) override { places.push_back(at); }
};

/// The sums behind one projection.
class Interpolation {
 public:
  Interpolation(const PlanTree& tree, const PlanNode& node, Sums& sums)
      : node_(node), size_(sums_of_reweighting(node)), sums_(sums), wholes_(1 + tree.ledger_levels) {
    for (const PlanNode* next = &node; !next->next.empty();) {
      next = &next->next.front();
      for (const std::size_t at : FatePlaces(next->stage).places)
        wholes_.front().places.push_back(next->sums - node.sums + at);
      for (std::size_t level = 0; next->ledger != 0 && level < tree.ledger_levels; ++level)
        for (const std::size_t at : {LedgerSums::caught(level), LedgerSums::ended(level)})
          wholes_[1 + level].places.push_back(next->ledger - node.sums + at);
    }
    for (const SlownessClass& of : node.classes)
      for (const FrequencyNodes& family : of.families) add(family);
  }

  void run(int threads) {
    in_parallel(node_.reweightings.size(), threads, [&](std::size_t i) { put(i); });
  }

 private:
  /// Sums that are all of some particles together, whatever the frequency.
  struct Whole {
    std::vector<std::size_t> places{};
    std::vector<Sum> of{};  // [reweighting]
  };
  /// What nodes have, as numbers, and which follows from them.
  struct Known {
    const FrequencyNodes& family;
    std::vector<double> sums;  // [node][size]
  };

  void add(const FrequencyNodes& family) {
    Known& known = known_.emplace_back(Known{family, {}});
    for (std::size_t k = 0; k < family.nodes.size() * size_; ++k)
      known.sums.push_back(static_cast<double>(sums_[family.sums + k]));
    for (Whole& whole : wholes_) {
      Sum all = 0;
      for (const std::size_t place : whole.places) all += sums_[family.sums + place];
      whole.of.resize(node_.reweightings.size());
      for (const std::size_t i : family.reweightings) whole.of[i] += all;
    }
  }

  void put(std::size_t i) {
    std::vector<double> found(size_);
    for (const Known& known : known_) {
      const auto& members = known.family.reweightings;
      const auto member = std::ranges::lower_bound(members, i);
      if (member == members.end() || *member != i) continue;
      const std::size_t nodes = known.family.nodes.size();
      const double* weights =
          &known.family.weights[static_cast<std::size_t>(member - members.begin()) * nodes];
      for (std::size_t j = 0; j < nodes; ++j)
        for (std::size_t k = 0; k < size_; ++k) found[k] += weights[j] * known.sums[j * size_ + k];
    }
    std::vector<Sum> rounded(size_);
    for (std::size_t k = 0; k < size_; ++k) rounded[k] = static_cast<Sum>(std::max(0.0, found[k]) + 0.5);
    for (const Whole& whole : wholes_) complete(whole, i, rounded);
    Sum* to = &sums_[node_.sums + node_.reweightings[i].shift];
    for (std::size_t k = 0; k < size_; ++k) to[k] += rounded[k];
  }

  /// The largest of its sums takes what rounding has left.
  static void complete(const Whole& whole, std::size_t i, std::vector<Sum>& rounded) {
    if (whole.places.empty()) return;
    Sum all = 0;
    std::size_t largest = whole.places.front();
    for (const std::size_t place : whole.places) {
      all += rounded[place];
      if (rounded[place] > rounded[largest]) largest = place;
    }
    const Sum wanted = whole.of[i];
    if (static_cast<double>(std::max(all, wanted) - std::min(all, wanted)) >
        1e-9 * static_cast<double>(wanted) + static_cast<double>(whole.places.size()))
      throw std::logic_error("what was interpolated does not add up to what was booked");
    rounded[largest] += wanted - all;
  }

  const PlanNode& node_;
  const std::size_t size_;
  Sums& sums_;
  std::vector<Whole> wholes_;  // all fates; of each level prepared, its ledger
  std::vector<Known> known_;
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
