#include "simulation/blocks.hpp"

#include <algorithm>

namespace rabiline {

std::vector<std::uint64_t> block_sizes(const Plan& plan, double most_cost) {
  std::vector<std::uint64_t> sizes;
  for (const PlanTree& tree : plan.trees) {
    std::uint64_t size = 8;
    while (size < 65536 && 2 * static_cast<double>(size) * tree.cost <= most_cost) size *= 2;
    sizes.push_back(size);
  }
  return sizes;
}

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

Blocks::Blocks(const Plan& plan, std::vector<std::uint64_t> sizes, int halvings)
    : plan_(plan), sizes_(std::move(sizes)), halvings_(halvings), begin_{0} {
  for (std::size_t part = 0; part <= static_cast<std::size_t>(halvings); ++part)
    for (std::size_t tree = 0; tree < sizes_.size(); ++tree) {
      const auto [first, last] = added(part, tree);
      const std::uint64_t particles = last - first;
      begin_.push_back(begin_.back() + particles / sizes_[tree] + (particles % sizes_[tree] != 0 ? 1 : 0));
    }
}

std::uint64_t Blocks::end_of_part(int halvings) const {
  return begin_[static_cast<std::size_t>(halvings_ - halvings + 1) * sizes_.size()];
}

std::pair<std::uint64_t, std::uint64_t> Blocks::added(std::size_t part, std::size_t tree) const {
  const PlanTree& of = plan_.trees[tree];
  const int left = halvings_ - static_cast<int>(part);
  return {part == 0 ? of.first : last_of_part(of, left + 1), last_of_part(of, left)};
}

Block Blocks::block(std::uint64_t number) const {
  const auto after = std::upper_bound(begin_.begin(), begin_.end(), number);
  const auto at = static_cast<std::size_t>(after - begin_.begin()) - 1;
  const std::size_t tree = at % sizes_.size();
  const auto [begin, last] = added(at / sizes_.size(), tree);
  const std::uint64_t first = begin + (number - begin_[at]) * sizes_[tree];
  return {tree, first, std::min(first + sizes_[tree], last)};
}

void Intervals::insert(std::uint64_t number) {
  const auto next =
      std::upper_bound(intervals_.begin(), intervals_.end(), number,
                       [](std::uint64_t n, const auto& interval) { return n < interval.first; });
  const bool joins_next = next != intervals_.end() && next->first == number + 1;
  if (next != intervals_.begin()) {
    const auto previous = next - 1;
    if (previous->second > number) return;
    if (previous->second == number) {
      previous->second = joins_next ? next->second : number + 1;
      if (joins_next) intervals_.erase(next);
      return;
    }
  }
  if (joins_next)
    next->first = number;
  else
    intervals_.insert(next, {number, number + 1});
}

void Intervals::insert(const Intervals& other) {
  std::vector<std::pair<std::uint64_t, std::uint64_t>> all = intervals_, merged;
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

bool Intervals::contains(std::uint64_t number) const {
  const auto next =
      std::upper_bound(intervals_.begin(), intervals_.end(), number,
                       [](std::uint64_t n, const auto& interval) { return n < interval.first; });
  return next != intervals_.begin() && (next - 1)->second > number;
}

std::uint64_t Intervals::size() const {
  std::uint64_t sum = 0;
  for (const auto& [begin, end] : intervals_) sum += end - begin;
  return sum;
}

}  // namespace rabiline
