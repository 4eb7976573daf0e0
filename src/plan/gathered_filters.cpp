#include "plan/gathered_filters.hpp"

#include <algorithm>
#include <optional>
#include <utility>

namespace rabiline {
namespace {

using Stages = std::vector<Stage>;

/// The axis of the levels that particles are in behind these stages, where all have the same one.
std::optional<UnitVector> axis_behind(Stages::const_iterator begin, Stages::const_iterator end,
                                      const SpinDraw& source) {
  std::optional<UnitVector> axis = UnitVector{source.axis[0], source.axis[1], source.axis[2]};
  for (; begin != end; ++begin) {
    if (const auto* align = std::get_if<Alignment>(&*begin))
      axis = UnitVector{align->axis[0], align->axis[1], align->axis[2]};
    else if (const auto* magnet = std::get_if<LevelProjection>(&*begin))
      axis = magnet->spins.axis;
    else if (traits_of(*begin).spins != SpinEffect::none)
      axis.reset();
  }
  return axis;
}

template <class Is>
bool tallies(const Stage& stage, Is is) {
  const auto* tally = std::get_if<Histogram>(&stage);
  return tally != nullptr && std::any_of(tally->axes.begin(), tally->axes.end(),
                                         [&](const HistogramAxis& axis) { return is(axis.quantity); });
}
bool asks_for_levels(const Stage& stage) {
  return std::holds_alternative<SpinStretch>(stage) ||
         tallies(stage, [](Quantity quantity) { return asks_for_spin(quantity); });
}
/// Behind the projection particles weigh what they did in front of it.
bool asks_for_weights(const Stage& stage) {
  return tallies(stage, [](Quantity quantity) { return quantity == Quantity::weight; });
}

/// Takes stages in their order into one projection and what follows it.
class FilterGatherer {
 public:
  FilterGatherer(const Filter& first, const UnitVector& start) {
    asked_.part = first.part;
    asked_.at = first.at;
    asked_.split = true;
    asked_.spins.levels = 2;
    asked_.spins.start = start;
  }

  /// False where the stage would not do the same behind the projection.
  bool take(const Stage& stage) {
    if (const auto* fields = std::get_if<Precession>(&stage)) {
      since_filter_ = fields->zones;
      return !levels_known_;
    }
    if (const auto* filter = std::get_if<Filter>(&stage)) {
      behind_.push_back(FilterStop{filter->part, filter->at});
      asked_.spins.filters.push_back({std::exchange(since_filter_, {}), *filter});
      return !levels_known_ && !has_screen_ && asked_.spins.outcomes() <= most_levels;
    }
    if (const auto* magnet = std::get_if<LevelProjection>(&stage); magnet != nullptr && !levels_known_) {
      levels_known_ = behind_magnet_ = true;
      asked_.spins.axis = magnet->spins.axis;
      asked_.spins.zones = magnet->spins.zones;
      return magnet->split && !has_screen_;
    }
    if (asks_for_levels(stage) && !behind_magnet_) {
      SpinPath found = *path_of(stage);
      if (!std::exchange(levels_known_, true)) asked_.spins.zones = found.zones;
      const bool as_asked = std::exchange(found.zones, {}) == asked_.spins.zones;
      behind_.push_back(with_path(stage, found));
      return as_asked && follows_paths(behind_.back());
    }
    has_screen_ = has_screen_ || catches(stage) != no_part;
    behind_.push_back(stage);
    return follows_paths(stage) && !asks_for_weights(stage);
  }

  /// The last filter's outcome comes first.
  void put(Stages& chain) {
    int outcome = asked_.spins.outcomes();
    for (Stage& stage : behind_)
      if (auto* stop = std::get_if<FilterStop>(&stage)) stop->outcome = --outcome;
    chain.push_back(std::move(asked_));
    std::move(behind_.begin(), behind_.end(), std::back_inserter(chain));
  }

 private:
  LevelProjection asked_;
  Stages behind_;
  SpinZones since_filter_;
  bool levels_known_ = false, behind_magnet_ = false;
  bool has_screen_ = false;  // whose levels are asked for behind everything
};

}  // namespace

Stages with_gathered_filters(const Stages& chain, const SpinDraw& source, std::string_view& why_not) {
  const auto first = std::find_if(chain.begin(), chain.end(),
                                  [](const Stage& stage) { return std::holds_alternative<Filter>(stage); });
  if (first == chain.end()) return {};
  const auto& filter = std::get<Filter>(*first);
  const auto begin =
      first != chain.begin() && std::holds_alternative<Precession>(*(first - 1)) ? first - 1 : first;
  const std::optional<UnitVector> start = axis_behind(chain.begin(), begin, source);
  why_not = "each particle comes to the first filter with a spin of its own";
  if (!filter.quantum || !start) return {};
  FilterGatherer gatherer(filter, *start);
  why_not =
      "what follows the first filter, a field flown through in steps or a tally, asks for more than the "
      "share of a particle that passes";
  if (!std::all_of(begin, chain.end(), [&](const Stage& stage) { return gatherer.take(stage); })) return {};
  Stages gathered(chain.begin(), begin);
  gatherer.put(gathered);
  return gathered;
}

}  // namespace rabiline
