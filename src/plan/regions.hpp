#pragma once
// Touching fields that turn the velocity or differ from place to place, put together as a region.
#include "plan/zones.hpp"
#include "transport/stages/turning_region.hpp"

namespace rabiline {

/// How far spins may stand from the field on their way.
struct SpinOutlook {
  Vector3 aligned{0, 0, 1};  // what they stand along where `tip` is 0
  double tip = 1;            // largest sine of their angle with it; 1 for a beam that nothing has aligned
};

/// A channel along the beam [m], of a part.
struct ChannelStretch {
  double begin = 0, end = 0;
  RegionChannel channel;
  Aperture opening(double y) const;
};
std::vector<ChannelStretch> channels_of(const Sections&);

/// The gap of a magnet, as kernels see it.
RegionGap gap_of(const GapTerm&);

/// A region under construction, from its begin to its end: sections, cut at the planes that stand inside.
class RegionMaker {
 public:
  /// All must outlive it; `speed` [m/s] is what steps are reckoned with, `slowness` how many times slower the
  /// slowest particles are. `channels` are those along the whole beam: planes stand at both ends of each.
  RegionMaker(const Turning& turning, const ZoneMaker& zones, double speed, double slowness,
              SpinOutlook& spins, const FieldCoupling& feels, std::vector<ChannelStretch> channels)
      : turning_(turning),
        zones_(zones),
        speed_(speed),
        slowness_(slowness),
        spins_(spins),
        channels_(std::move(channels)) {
    region_.feels = feels;
  }

  void begin(const Section&);
  /// Something stands there that may stop, catch or align; several at one place get zones of no length
  /// between them.
  void edge(double y, RegionEdge);
  /// Something looks there, in the order in which it was placed among the edges. It cuts nothing, so that
  /// the flight is the same to the bit with and without it.
  void look(Sight);
  void end();
  TurningRegion finish(const StretchOutlook&);

 private:
  void close_zone(double end);
  double tip_in(const SpinZone&, double stay) const;
  RegionZone zone_up_to(double end);
  void fly_through_field(RegionZone&);
  void keep_in_channels(RegionZone&);

  const Turning& turning_;
  const ZoneMaker& zones_;
  const double speed_, slowness_;
  SpinOutlook& spins_;
  const std::vector<ChannelStretch> channels_;
  const Section* section_ = nullptr;
  double begin_ = 0;
  RegionEdge pending_;  // stands before the zone that comes next
  TurningRegion region_;
};

}  // namespace rabiline
