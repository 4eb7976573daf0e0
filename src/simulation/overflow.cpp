#include "simulation/overflow.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "particle/fate.hpp"
#include "simulation/finish.hpp"
#include "simulation/tree_runner.hpp"

namespace rabiline {
namespace {

double overflowed_at(const Result& result, std::size_t point) {
  double particles = 0;
  for (const FateResult& line : result.fates)
    if (line.fate == fate::overflowed) particles += line.particles[point];
  return particles;
}

/// Flies stretches of a tree once more.
class Search {
 public:
  Search(const Experiment& experiment, const Plan& plan, std::size_t point, Isa isa)
      : experiment_(experiment), plan_(plan), point_(point), runner_(isa, Batch::capacity) {}

  std::optional<std::uint64_t> first_in(const PlanTree& tree) {
    constexpr std::uint64_t most = 1 << 20, at_once = 1 << 14;
    const std::uint64_t last = std::min(tree.last, tree.first + most);
    for (std::uint64_t begin = tree.first; begin < last; begin += at_once) {
      std::uint64_t low = begin, high = std::min(last, begin + at_once);
      if (!some_in(tree, low, high)) continue;
      while (high - low > 1) {
        const std::uint64_t middle = low + (high - low) / 2;
        (some_in(tree, low, middle) ? high : low) = middle;
      }
      return low;
    }
    return {};
  }

 private:
  bool some_in(const PlanTree& tree, std::uint64_t first, std::uint64_t last) {
    Sums sums(plan_.sums);
    runner_.fly(tree, first, last, sums);
    return overflowed_at(finish(experiment_, plan_, std::move(sums)), point_) > 0;
  }

  const Experiment& experiment_;
  const Plan& plan_;
  std::size_t point_;
  TreeRunner runner_;
};

}  // namespace

std::string warning_of_overflow(const Experiment& experiment, const Plan& plan, const Result& result,
                                Isa isa) {
  for (std::size_t point = 0; point < result.emitted.size(); ++point) {
    const double particles = overflowed_at(result, point);
    if (!(particles > 0)) continue;
    Search search(experiment, plan, point, isa);
    std::optional<std::uint64_t> example;
    for (const PlanTree& tree : plan.trees)
      if (!example && std::ranges::find(tree.points, static_cast<int>(point)) != tree.points.end())
        example = search.first_in(tree);
    return fmt::format(
        "{:.4g} of the {:.4g} particles of scan point {} got places, velocities or spins that no number can "
        "hold, "
        "and are counted as `{}`\n  help: look for a field that is too strong{}",
        particles, result.emitted[point], point, fate::overflowed,
        example ? fmt::format("; `rabiline trace FILE --particle {}` shows one of them", *example) : "");
  }
  return {};
}

}  // namespace rabiline
