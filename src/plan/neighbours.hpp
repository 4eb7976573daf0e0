#pragma once
// Finds scan points that are alike without comparing each with all others.
#include <algorithm>
#include <cstddef>
#include <vector>

#include "beamline/experiment.hpp"

namespace rabiline {

/// What depends on some axes only is alike along every other one. So a point is compared with those before it
/// along each axis: the nearest, and some more, since the values of a list may repeat.
class Neighbours {
 public:
  explicit Neighbours(const Experiment& experiment) : groups_(experiment.points.size(), none) {
    std::size_t stride = 1;
    for (auto axis = experiment.axes.rbegin(); axis != experiment.axes.rend(); ++axis) {
      axes_.push_back({stride, axis->values.size()});
      stride *= axis->values.size();
    }
    if (stride != groups_.size()) axes_ = {{1, groups_.size()}};
  }

  /// Forgets the groups of all points, at the cost of those that have one.
  void clear() {
    for (const std::size_t point : grouped_) groups_[point] = none;
    grouped_.clear();
  }
  void put(std::size_t point, std::size_t group) {
    groups_[point] = group;
    grouped_.push_back(point);
  }
  /// The group that the point belongs to: one that `alike(group)` says yes to, or `none`.
  template <class Alike>
  std::size_t find(std::size_t point, Alike alike) const {
    std::size_t refused = none;
    for (const auto& [stride, length] : axes_) {
      const std::size_t before = std::min(most_looked_at, point / stride % length);
      for (std::size_t k = 1; k <= before; ++k) {
        const std::size_t group = groups_[point - k * stride];
        if (group == none || group == refused) continue;
        if (alike(group)) return group;
        refused = group;
      }
    }
    return none;
  }
  static constexpr std::size_t none = static_cast<std::size_t>(-1);

 private:
  static constexpr std::size_t most_looked_at = 16;
  struct Axis {
    std::size_t stride, length;
  };
  std::vector<Axis> axes_;  // the innermost first
  std::vector<std::size_t> groups_, grouped_;
};

}  // namespace rabiline
