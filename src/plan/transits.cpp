#include "plan/transits.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "plan/spin_turning.hpp"
#include "plan/transit_links.hpp"
#include "transport/cost.hpp"

namespace rabiline {
namespace {

/// Of the fastest cosine in a probability, across one cell: a polynomial through 8 Chebyshev points is then
/// off by (1/2)^8/(8! 2^7) = 7.6e-10 of its amplitude.
constexpr double radians_per_cell = 1;
/// To keep the moments of a cell from the flight to the result [s].
constexpr double cost_of_cell = 4e-8;
/// Moments of one projection, at most.
constexpr std::size_t most_moments = std::size_t{1} << 21;
/// How far cells reach beyond the speeds of nearly all particles; what is still outside is shared point by
/// point.
constexpr double beyond = 2;

constexpr std::string_view turns_too_fast = "spins turn faster than the moments that were kept resolve",
                           mixed_by_particle = "levels of atoms are mixed for each particle",
                           shorter_by_particle = "that is shorter here";

class TransitMaker {
 public:
  TransitMaker(const PlanTree& tree, const SpeedRange& speeds, const MomentsOf& of, std::size_t& sums)
      : particles_(static_cast<double>(tree.last - tree.first)),
        speeds_(speeds),
        mean_(tree.source.speed.mean),
        points_(static_cast<std::size_t>(of.points)),
        weights_differ_(sums_of(tree.source).weights_differ),
        has_ledger_(tree.ledger_levels > 0),
        pulsed_(tree.source.pulse.kind != PulseKind::none),
        everywhere_(of.wanted.everywhere || of.wanted.cells != nullptr),
        given_(of.wanted.cells),
        place_(of.place),
        sums_(sums) {}

  /// `as_emitted`: particles still are in the level that the ledger has them in, or there is no ledger.
  /// `full`: nothing has taken a part of their weights.
  void visit(std::vector<PlanNode>& nodes, bool as_emitted, bool full) {
    gather_readers(nodes);
    for (PlanNode& node : nodes)
      if (node.reweightings.empty())
        visit(node.next, as_emitted && (!has_ledger_ || traits_of(node.stage).spins != SpinEffect::set),
              full && (follows_paths(node.stage) || traits_of(node.stage).only_reads));
      else if (as_emitted && !node.transit)
        lay_out(node, full);
  }

 private:
  /// Points that stand side by side because they read levels of one catch behind different fields become one
  /// node where moments serve them all.
  void gather_readers(std::vector<PlanNode>& nodes) {
    std::vector<std::vector<std::size_t>> groups;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!traits_of(nodes[i].stage).counts_levels || !nodes[i].next.empty()) continue;
      const auto group = std::find_if(groups.begin(), groups.end(), [&](const std::vector<std::size_t>& g) {
        const Stage& first = nodes[g.front()].stage;
        return with_path(nodes[i].stage, *path_of(first)) == first;
      });
      if (group == groups.end())
        groups.push_back({i});
      else
        group->push_back(i);
    }
    std::vector<bool> gone(nodes.size());
    for (const std::vector<std::size_t>& group : groups) {
      if (group.size() < 2 && !everywhere_) continue;
      PlanNode one = nodes[group.front()];
      one.points.clear();
      for (const std::size_t i : group) {
        one.reweightings.push_back({nodes[i].stage, nodes[i].points, nodes[i].sums - one.sums});
        one.points.insert(one.points.end(), nodes[i].points.begin(), nodes[i].points.end());
      }
      std::string_view why_not = mixed_by_particle;
      const auto turning =
          path_of(one.stage)->transitions == nullptr ? angle_along(one, why_not) : std::nullopt;
      const auto cells = turning ? cells_for(*turning) : std::nullopt;
      if (!cells) {
        nodes[group.front()].why_one_by_one = turning ? turns_too_fast : why_not;
        continue;
      }
      const auto levels = static_cast<std::size_t>(path_of(one.stage)->levels);
      const TransitLink whole_catch{.outcomes = 1, .bins = 1, .columns = 1, .rows = 1};
      const auto layout = std::make_shared<TransitLayout>(*cells, std::vector<std::uint64_t>(levels, 1),
                                                          std::vector<TransitLink>{whole_catch}, false);
      const double entries = 2 * particles_;
      if (!is_shorter(*layout, group.size(),
                      cost::closed_form * static_cast<double>(levels) + cost_of_steps(one.stage), entries)) {
        nodes[group.front()].why_one_by_one = shorter_by_particle;
        continue;
      }
      keep(one, layout);
      nodes[group.front()] = std::move(one);
      for (std::size_t i = 1; i < group.size(); ++i) gone[group[i]] = true;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (gone[i]) continue;
      if (kept != i) nodes[kept] = std::move(nodes[i]);
      ++kept;
    }
    nodes.resize(kept);
  }

  void lay_out(PlanNode& node, bool full) {
    // Their covariance with the other points would be missing.
    if (node.points.size() != points_) return by_particle(node, "other scan points fly apart from these");
    if (const SpinPath& path = *path_of(node.reweightings.front().stage);
        path.transitions != nullptr || path.way != nullptr)
      return by_particle(node, mixed_by_particle);
    // Their covariance would need products of the weights before and behind.
    if (!full && weights_differ_)
      return by_particle(node, "the weights of an aimed source are changed on the way");
    std::string_view why_not;
    const auto links = links_behind(node, why_not);
    if (!links) return by_particle(node, why_not);
    const auto turning = angle_along(node, why_not);
    if (!turning) return by_particle(node, why_not);
    const auto cells = cells_for(*turning);
    if (!cells) return by_particle(node, turns_too_fast);
    const auto layout =
        std::make_shared<TransitLayout>(*cells, node.reachable_levels, *links, full && !weights_differ_);
    if (layout->size() > most_moments)
      return by_particle(node, "the moments of so many bins would need much memory");
    const double levels = static_cast<double>(layout->levels());
    double shared = cost::share * levels, entries = levels * (levels + 1);
    for (const TransitLink& link : *links) {
      if (link.ends || link.bins == 0) continue;
      shared += cost::tally * levels;
      entries += levels * (levels + 2 + 2 * static_cast<double>(link.axes));
    }
    if (!is_shorter(*layout, node.reweightings.size(),
                    shared + cost_of_steps(node.reweightings.front().stage) + cost_behind_filters(node),
                    particles_ * entries))
      return by_particle(node, shorter_by_particle);
    keep(node, layout);
  }
  static void by_particle(PlanNode& node, std::string_view why) { node.why_one_by_one = why; }

  void keep(PlanNode& node, const std::shared_ptr<const TransitLayout>& layout) {
    node.transit = layout;
    node.moments = sums_;
    sums_ += layout->sums();
    ++place_;
  }

  /// Of the fastest cosine of all ways [rad m/s]; nothing where these are no closed form of the slowness.
  std::optional<double> angle_along(const PlanNode& node, std::string_view& why_not) const {
    double angle = 0;
    for (const PlanNode::Reweighting& reweighting : node.reweightings) {
      const SpinPath& path = *path_of(reweighting.stage);
      const std::optional<double> turning = turning_along(path, pulsed_, why_not);
      if (!turning) return {};
      angle = std::max(angle, *turning * (path.levels - 1));
    }
    return angle;
  }

  /// Nothing where the given ones are too wide.
  std::optional<SlownessCells> cells_for(double angle) const {
    if (given_ != nullptr) {
      if (place_ >= given_->size() || (*given_)[place_].width * angle > radians_per_cell * (1 + 1e-12))
        return {};
      return (*given_)[place_];
    }
    const double first = 1 / (beyond * speeds_.fastest), last = beyond / speeds_.slowest;
    const double count = std::clamp(std::ceil((last - first) * angle / radians_per_cell), 1.0,
                                    static_cast<double>(most_moments) + 1);
    return SlownessCells{first, (last - first) / count, static_cast<int>(count)};
  }

  /// [s] for each particle, through zones without a closed form.
  double cost_of_steps(const Stage& stage) const {
    std::vector<SpinZone> stepped;
    path_of(stage)->each_zone([&](const SpinZone& zone) {
      if (zone.step != 0) stepped.push_back(zone);
    });
    return cost_of(stepped, mean_);
  }
  /// [s] for each particle that flies on behind a filter for one way alone.
  double cost_behind_filters(const PlanNode& node) const {
    double sum = 0;
    if (path_of(node.stage)->filters.empty()) return sum;
    for (const PlanNode* next = &node; !next->next.empty();) {
      next = &next->next.front();
      sum += cost_of(next->stage, mean_);
    }
    return sum;
  }
  /// Against asking every particle for each way, at a cost [s]. `entries`: what is booked at most.
  bool is_shorter(const TransitLayout& layout, std::size_t ways, double one_by_one, double entries) const {
    const double kept = static_cast<double>(layout.size()) * cost_of_cell, booked = entries * cost::moment,
                 contracted = static_cast<double>(ways) *
                              std::min(static_cast<double>(layout.size()), entries) * transit_powers *
                              cost::multiply;
    return layout.size() <= most_moments &&
           (everywhere_ ||
            (ways > 1 && particles_ * static_cast<double>(ways) * one_by_one > kept + booked + contracted));
  }

  const double particles_;
  const SpeedRange speeds_;
  const double mean_;  // [m/s]
  const std::size_t points_;
  const bool weights_differ_, has_ledger_, pulsed_, everywhere_;
  const std::vector<SlownessCells>* const given_;
  std::size_t& place_;
  std::size_t& sums_;
};

bool is_one_flight(const std::vector<PlanNode>& nodes, std::size_t points, std::string_view& why) {
  for (const PlanNode& node : nodes) {
    const bool tells = node.points.size() == points || traits_of(node.stage).counts_levels;
    if (tells && !node.why_one_by_one.empty()) why = node.why_one_by_one;
    if (node.points.size() != points || (!node.reweightings.empty() && !node.transit)) return false;
    if (!node.transit && traits_of(node.stage).counts_levels && path_of(node.stage) != nullptr) return false;
    if (!node.transit && !is_one_flight(node.next, points, why)) return false;
  }
  return true;
}

}  // namespace

bool is_one_flight(const PlanTree& tree, int points, std::string_view& why) {
  return is_one_flight(tree.next, static_cast<std::size_t>(points), why);
}

void lay_out_moments(PlanTree& tree, const SpeedRange& speeds, const MomentsOf& of, std::size_t& sums) {
  TransitMaker maker(tree, speeds, of, sums);
  maker.visit(tree.next, true, true);
}

}  // namespace rabiline
