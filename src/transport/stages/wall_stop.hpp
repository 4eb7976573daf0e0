#pragma once
// Where paths end that met a wall in the stage before, which was not that stage's own, or left a map there.
#include "particle/fate.hpp"
#include "transport/plane_stage.hpp"

namespace rabiline {

/// What a magnet leaves in the scratch column of what has met a wall that is not its own, or left a map that
/// nothing may leave, and flies on to the stage that ends it; 0 for all others.
namespace wall_mark {
inline constexpr std::uint64_t of_chamber = 1;
/// The chamber is part -1.
constexpr std::uint64_t of(int part) { return of_chamber + 1 + static_cast<std::uint64_t>(part); }
inline constexpr std::uint64_t of_map = std::uint64_t{1} << 32;
}  // namespace wall_mark

/// Stands behind a magnet in which paths may meet walls of several parts, once for each of them but the
/// magnet, and once where they may leave a map: a stage ends paths at one part, by one fate.
struct WallStop : PlaneStage {
  std::string_view ending = fate::stopped;  // or left_map, of no part
  bool operator==(const WallStop&) const = default;

  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<WallStop>);

}  // namespace rabiline
