#pragma once
// What samples of stages are made of: openings, a detector, and zones of every kind.
#include <vector>

#include "transport/kernels.hpp"

namespace rabiline::test::sample {

inline constexpr int part = 3;

Aperture rectangle(double half_x, double half_z, double angle = 0);
Aperture disc(double radius);
Screen screen();
/// Turned, with a dead area, and blind for a part of what hits it.
Screen poor_screen();

SpinZone zone(ZoneKind);
/// Of the same in other axes, and along a turning field.
SpinZone turned(SpinZone);
SpinZone twisted(SpinZone);

struct NamedZones {
  const char* what;
  std::vector<SpinZone> zones;
};
std::vector<NamedZones> all_zones();

}  // namespace rabiline::test::sample
