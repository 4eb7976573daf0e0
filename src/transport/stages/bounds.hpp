#pragma once
// What a straight flight may not leave: the gap of a magnet, or a map of a field.
#include <variant>
#include <vector>

#include "field/shaped_term.hpp"
#include "transport/kernels.hpp"
#include "transport/plane_stage.hpp"
#include "transport/region.hpp"
#include "transport/wall_row.hpp"

namespace rabiline {

/// Where nothing turns a path, as that of an atom whose levels stay coherent, it is looked at in many places
/// between two planes.
struct Bounds : PlaneStage {
  double end = 0;  // [m] up to there
  std::variant<RegionGap, ShapedTerm> space{};
  std::vector<Aperture> rivals{};  // walls all along: what has met one before ends there
  bool operator==(const Bounds&) const = default;

  double cost(double speed) const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  double from() const { return at; }
  double to() const { return end; }
  Bounds until(double y) const;
};
static_assert(StageKind<Bounds>);

/// Part of a flight along the beam [m], and the walls that stand there as well.
struct FlightRange {
  double begin = 0, end = 0;
  WallRow rivals{};
};
/// Both return the weight that was outside somewhere [quanta].
RABILINE_KERNEL(keep_in_gap, std::uint64_t(const RegionGap&, const FlightRange&, BatchView&))
RABILINE_KERNEL(keep_in_map, std::uint64_t(const ShapedTerm&, const FlightRange&, BatchView&))

}  // namespace rabiline
