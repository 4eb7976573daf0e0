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

Blocks::Blocks(const Plan& plan, std::vector<std::uint64_t> sizes)
    : plan_(plan), sizes_(std::move(sizes)), begin_{0} {
  for (std::size_t i = 0; i < sizes_.size(); ++i) {
    const std::uint64_t particles = plan.trees[i].last - plan.trees[i].first;
    begin_.push_back(begin_.back() + particles / sizes_[i] + (particles % sizes_[i] != 0 ? 1 : 0));
  }
}

Block Blocks::block(std::uint64_t number) const {
  const auto after = std::upper_bound(begin_.begin(), begin_.end(), number);
  const auto tree = static_cast<std::size_t>(after - begin_.begin()) - 1;
  const std::uint64_t first = plan_.trees[tree].first + (number - begin_[tree]) * sizes_[tree];
  return {tree, first, std::min(first + sizes_[tree], plan_.trees[tree].last)};
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
