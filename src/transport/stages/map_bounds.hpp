#pragma once
// A map of a field that nothing may leave, on a straight flight.
#include "field/shaped_term.hpp"
#include "transport/kernels.hpp"
#include "transport/plane_stage.hpp"

namespace rabiline {

/// Where nothing turns a path, as that of an atom whose levels stay coherent, it is looked at in many places.
struct MapBounds : PlaneStage {
  double end = 0;  // [m] up to there
  ShapedTerm map{};
  bool operator==(const MapBounds&) const = default;

  double cost(double speed) const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<MapBounds>);

/// Returns the weight that left the map [quanta].
RABILINE_KERNEL(keep_in_map, std::uint64_t(const MapBounds&, BatchView&))

}  // namespace rabiline
