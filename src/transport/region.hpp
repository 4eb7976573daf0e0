#pragma once
// Touching fields that turn the velocity, as the kernel sees them.
#include "transport/kernels.hpp"
#include "transport/stages/alignment.hpp"

namespace rabiline {

enum class EdgeKind { open, plate, screen, align };
/// A plane inside a region, between two zones.
struct RegionEdge {
  EdgeKind kind = EdgeKind::open;
  Aperture plate;
  Screen screen;
  Alignment align;
  int part = 0;
  bool operator==(const RegionEdge&) const = default;
};
/// One zone of a region with its wall and step.
struct RegionZone {
  SpinZone field;
  double wall_radius = 0;         // [m]
  double wall_x = 0, wall_z = 0;  // [m] its centre
  int wall_part = 0;
  double step = 0;        // [s]
  int sights_passed = 0;  // of the region, up to its end
  bool operator==(const RegionZone&) const = default;
};
/// Touching fields that turn the velocity: dv/dt = W x v, W = turn - (turn . S) S where `along_spin` is taken
/// off.
struct Region {
  RandomKey key;
  const RegionZone* zones = nullptr;
  const RegionEdge* edges = nullptr;  // edges[i] is crossed between zones i and i+1; zone_count - 1 of them
  int zone_count = 0;
  bool take_off_spin_component = false;  // closure torque
  double most_way = 0;            // [m] flown in one zone at one visit; what goes on for longer gives up
  std::uint64_t most_visits = 0;  // of zones
  // Planes that are looked at, ascending. Nothing happens there: steps go on across them. `seen` takes for
  // each of them, where it is crossed forward for the first time, a particle's state in its own row.
  BatchView* seen = nullptr;
  int sight_count = 0;
};
/// How a particle's flight through a region ended, in the batch's scratch column: an end, or base + zone or
/// edge.
namespace region_end {
inline constexpr std::uint64_t forward = 0, backwards = 1, gave_up = 2;
inline constexpr std::uint64_t wall_of_zone = 16, stopped_at_edge = 1 << 16, caught_at_edge = 1 << 17;
}  // namespace region_end

RABILINE_KERNEL(turn, void(const Region&, BatchView&, const StepRecorder*))

}  // namespace rabiline
