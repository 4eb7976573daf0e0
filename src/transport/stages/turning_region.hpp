#pragma once
// Fields that turn the velocity, or that differ from place to place.
#include <vector>

#include "transport/region.hpp"
#include "transport/stages/census.hpp"
#include "transport/stages/histogram.hpp"

namespace rabiline {

/// A monitor's plane inside a region: it sees each particle once, where it comes there for the first time,
/// and changes nothing.
struct Sight {
  Census census;
  std::vector<Histogram> tallies;
  bool operator==(const Sight&) const = default;
};
/// Touching fields that are flown through in steps; the particle may leave backwards.
struct TurningRegion {
  std::vector<RegionZone> zones;
  std::vector<RegionEdge> edges;  // between neighbouring zones
  std::vector<Sight> sights;      // in the order in which they are passed
  bool take_off_spin_component = false;
  double most_way = 0;  // [m] in one zone at one visit
  std::vector<ShapedTerm> shaped{};
  std::vector<RegionGap> gaps{};
  std::vector<RegionChannel> channels{};
  FieldCoupling feels{};
  StretchOutlook outlook{};
  bool operator==(const TurningRegion&) const = default;

  static constexpr StageTraits traits{
      .ends_particles = true, .spins = SpinEffect::carried, .levels = LevelEffect::replaced};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  std::size_t own_memory() const;
};
static_assert(StageKind<TurningRegion>);

/// Whose wall that is, by its number (region_end).
int part_of_wall(const TurningRegion&, std::size_t wall);
/// As the kernel sees it, which it must outlive.
Region view_of(const TurningRegion&, const RandomKey&);
/// What the electric field in one of its zones does to a spin and a charge at the mean speed.
void explain_electric(const TurningRegion&, const RegionZone&, PlanReport&);
/// What becomes of levels, and a warning where that is in doubt.
void explain_levels(const TurningRegion&, PlanReport&);

}  // namespace rabiline
