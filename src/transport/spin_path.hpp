#pragma once
// How the spins of a straight flight are carried from where they were last known to where they are asked for.
#include <cstdint>
#include <optional>
#include <vector>

#include "core/unit_vector.hpp"
#include "spin/driven_levels.hpp"
#include "transport/kernels.hpp"
#include "transport/level_way.hpp"
#include "transport/spin_zones.hpp"
#include "transport/stages/filter.hpp"

namespace rabiline {

/// A filter on the way, and the fields in front of it since the last one.
struct FilteredZones {
  SpinZones zones;
  Filter filter;
  bool operator==(const FilteredZones&) const = default;
};

struct SpinPath {
  int levels = 0;  // that are told apart at its end; 0: a vector law, whose spin has a projection
  /// The axis of the levels that particles are in at its beginning, under `quantum`; nothing where it differs
  /// from particle to particle. A spin image along z has a closed form through one zone.
  std::optional<UnitVector> start{};
  UnitVector axis{};  // of the levels that are asked for
  SpinZones zones{};
  std::vector<double> polynomials{};          // MajoranaTable::coefficients
  bool of_atom = false;                       // whose levels no field turns
  const DrivenLevels* transitions = nullptr;  // of an atom that fields drive; a plan makes each once
  const LevelWay* way = nullptr;              // of an atom, instead, through fields without a closed form
  /// Where filters stand on the way, `zones` are behind the last one. What each of them stops is an outcome
  /// of its own behind the levels, that of the last one first: so those that come to a place are the first
  /// ones.
  std::vector<FilteredZones> filters{};
  bool operator==(const SpinPath&) const = default;

  bool from_level() const { return start == UnitVector{} && axis == UnitVector{}; }
  int outcomes() const { return levels + static_cast<int>(filters.size()); }
  /// Nothing on the way acts on spins.
  bool is_idle() const {
    return zones.empty() && transitions == nullptr && way == nullptr && filters.empty();
  }
  /// Nor are other levels asked for than those that particles are known to be in.
  bool keeps_levels() const { return is_idle() && (of_atom || !start || *start == axis); }
  /// Calls f with each zone on the way.
  template <class F>
  void each_zone(F f) const {
    for (const FilteredZones& before : filters)
      for (const SpinZone& zone : before.zones) f(zone);
    for (const SpinZone& zone : zones) f(zone);
  }
  /// What kernels see of it, which it must outlive.
  SpinPathView view(const RandomKey&) const;
  double cost(double speed) const;
};

/// Time for the turning of spins in zones [s].
double cost_of(const SpinZones&, double speed);

/// Throws std::invalid_argument where kernels name a particle whose levels could not be followed: shares
/// would be wrong.
void require_followed(std::uint64_t particle);

/// Weights shared out over the outcomes, a column for each, whose sum is the weight: by what acts on the way,
/// or of atoms where nothing does by the level that each is in.
void share_levels(const SpinPath&, const RandomKey&, Isa, const BatchView&, const std::uint64_t* weights,
                  std::uint64_t* shares);

}  // namespace rabiline
