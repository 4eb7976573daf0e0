#pragma once
// A deflecting magnet with a constant force.
#include <limits>

#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// A constant force on the moment's part along z, from one plane to another.
struct Deflection {
  double begin = 0, end = 0;        // [m]
  double acceleration = 0;          // [m/s^2] of a moment that points along +z in full, in units of spin
  double along_x = 0, along_z = 1;  // its direction
  int levels = 0;                   // quantum: how many levels; 0: a vector law
  bool has_gap = false;
  double x0 = 0, z0 = 0, half_x = 0, half_z = 0;             // [m] free between the walls
  double chamber = std::numeric_limits<double>::infinity();  // [m] radius of its wall where it may be met
  double tolerance = 1e-6;                                   // of the law; a parabola keeps any
  int part = 0;
  bool operator==(const Deflection&) const = default;

  static constexpr StageTraits traits{.ends_particles = true, .levels = LevelEffect::separated};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  /// A part of it from one place to another.
  Deflection piece(double from, double to) const;
  /// What has met the chamber before a pole flies on with its mark (WallStop).
  bool marks_walls() const { return chamber < std::numeric_limits<double>::infinity(); }
};
static_assert(StageKind<Deflection>);

/// The batch must be referred to the magnet's begin. Returns the weight that stopped at its walls [quanta].
RABILINE_KERNEL(deflect, std::uint64_t(const Deflection&, BatchView&))

}  // namespace rabiline
