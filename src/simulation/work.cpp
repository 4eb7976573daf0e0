#include "simulation/work.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

namespace rabiline {

std::uint64_t last_of_part(const PlanTree& tree, int halvings) {
  const std::uint64_t particles = tree.last - tree.first;
  return tree.first + (particles >> halvings) + ((particles >> halvings << halvings) != particles ? 1 : 0);
}

Plan part_of(const Plan& plan, int halvings) {
  Plan part = plan;
  for (PlanTree& tree : part.trees) tree.last = last_of_part(tree, halvings);
  return part;
}

int most_halvings(std::uint64_t particles) {
  int halvings = 0;
  while (halvings < 20 && particles >> (halvings + 1) >= 1000) ++halvings;
  return halvings;
}

ParticleRow::ParticleRow(const Plan& plan, int halvings) : plan_(plan), halvings_(halvings), begin_{0} {
  for (std::size_t part = 0; part <= static_cast<std::size_t>(halvings); ++part)
    for (std::size_t tree = 0; tree < plan.trees.size(); ++tree) {
      const auto [first, last] = added(part, tree);
      if (last - first > std::numeric_limits<std::uint64_t>::max() / 2 - begin_.back())
        throw std::invalid_argument(
            "all points of the scan together have more than 9e18 particles\n  help: let the points share "
            "them, with "
            "`particles: shared` of the scan");
      begin_.push_back(begin_.back() + last - first);
    }
}

std::uint64_t ParticleRow::end_of_part(int halvings) const {
  return begin_[static_cast<std::size_t>(halvings_ - halvings + 1) * plan_.trees.size()];
}

std::pair<std::uint64_t, std::uint64_t> ParticleRow::added(std::size_t part, std::size_t tree) const {
  const PlanTree& of = plan_.trees[tree];
  const int left = halvings_ - static_cast<int>(part);
  return {part == 0 ? of.first : last_of_part(of, left + 1), last_of_part(of, left)};
}

ParticleRange ParticleRow::at(std::uint64_t place) const {
  const auto after = std::upper_bound(begin_.begin(), begin_.end(), place);
  const auto at = static_cast<std::size_t>(after - begin_.begin()) - 1;
  const std::size_t tree = at % plan_.trees.size();
  const auto [begin, last] = added(at / plan_.trees.size(), tree);
  return {place, tree, begin + (place - begin_[at]), last};
}

double ParticleRow::cost_before(std::uint64_t place) const {
  double cost = 0;
  for (std::size_t at = 0; at + 1 < begin_.size() && begin_[at] < place; ++at)
    cost += std::max(plan_.trees[at % plan_.trees.size()].cost, 1e-12) *
            static_cast<double>(std::min(begin_[at + 1], place) - begin_[at]);
  return cost;
}

void Intervals::insert(std::uint64_t begin, std::uint64_t end) {
  if (intervals_.empty() || intervals_.back().second < begin)
    intervals_.emplace_back(begin, end);
  else if (intervals_.back().second == begin)
    intervals_.back().second = end;
  else
    insert(Intervals({{begin, end}}));
}

void Intervals::insert(const Intervals& other) {
  List all = intervals_, merged;
  all.insert(all.end(), other.intervals_.begin(), other.intervals_.end());
  std::sort(all.begin(), all.end());
  for (const auto& interval : all) {
    if (!merged.empty() && interval.first <= merged.back().second)
      merged.back().second = std::max(merged.back().second, interval.second);
    else
      merged.push_back(interval);
  }
  intervals_ = std::move(merged);
}

std::pair<std::uint64_t, std::uint64_t> Intervals::gap(std::uint64_t from) const {
  auto next = std::upper_bound(intervals_.begin(), intervals_.end(), from,
                               [](std::uint64_t n, const auto& interval) { return n < interval.second; });
  for (; next != intervals_.end() && next->first <= from; ++next) from = next->second;
  return {from, next == intervals_.end() ? std::numeric_limits<std::uint64_t>::max() : next->first};
}

std::uint64_t Intervals::size() const {
  std::uint64_t sum = 0;
  for (const auto& [begin, end] : intervals_) sum += end - begin;
  return sum;
}

std::uint64_t Pace::particles(double cost) const {
  constexpr double least = 8, most = 1 << 20;
  const double wanted = std::min(seconds_ / per_cost_, 8 * last_) / std::max(cost, 1e-12);
  return static_cast<std::uint64_t>(std::clamp(wanted, least, most)) / 8 * 8;
}

void Pace::took(double cost, double seconds) {
  last_ = std::max(cost, 1e-12);
  per_cost_ = std::max(seconds, 1e-9) / last_;
}

}  // namespace rabiline
