#include "simulation/interpolation.hpp"

#include <algorithm>
#include <map>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "core/in_parallel.hpp"
#include "simulation/counting.hpp"
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
    std::vector<Sum> booked{};  // [whole] what its parts add up to at nodes, the most of each class
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
      for (std::size_t whole = 0; whole < wholes_.size(); ++whole) {
        Sum most = 0;
        for (std::size_t j = 0; j < nodes.nodes.size(); ++j) {
          Sum all = 0;
          for (const std::size_t part : wholes_[whole].parts) all += sums_[nodes.sums + j * size_ + part];
          most = std::max(most, all);
        }
        family.booked[whole] += most;
      }
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
      std::vector<Sum> sums(size_);
      for (std::size_t k = 0; k < places; ++k) sums[family.places[k]] = rounded(found[k * at_once + m]);
      for (std::size_t whole = 0; whole < wholes_.size(); ++whole) {
        const std::optional<std::size_t> total = wholes_[whole].total;
        complete(wholes_[whole].parts, total ? sums[*total] : family.booked[whole],
                 static_cast<double>(family.booked[whole]), sums);
      }
      Sum* to = &sums_[node_.sums + node_.reweightings[family.members[first + m]].shift];
      for (std::size_t k = 0; k < size_; ++k) to[k] += sums[k];
    }
  }

  /// Parts add up to `wanted`: the largest takes what rounding has left, and what was below nothing.
  /// `scale`: the most that they add up to at any node, of which interpolation is some 1e-11 off.
  static void complete(const std::vector<std::size_t>& parts, Sum wanted, double scale,
                       std::vector<Sum>& sums) {
    if (parts.empty()) return;
    Sum all = 0;
    std::size_t largest = parts.front();
    for (const std::size_t part : parts) {
      all += sums[part];
      if (sums[part] > sums[largest]) largest = part;
    }
    Sum excess = all > wanted ? all - wanted : 0;
    const Sum missing = all > wanted ? 0 : wanted - all;
    if (static_cast<double>(excess + missing) > 1e-9 * scale + static_cast<double>(parts.size()))
      throw std::logic_error("what was interpolated does not add up to what was booked");
    sums[largest] += missing;
    const auto take = [&](std::size_t part) {
      const Sum taken = std::min(excess, sums[part]);
      sums[part] -= taken;
      excess -= taken;
    };
    take(largest);
    for (const std::size_t part : parts) take(part);
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
