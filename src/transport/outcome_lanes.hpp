#pragma once
// In which level a state is found, for kernels only.
#include "transport/majorana_lanes.hpp"
#include "transport/plane_lanes.hpp"
#include "transport/spin_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Flip probability of a spin 1/2 from what its image of one axis has along another.
RABILINE_LANES real flip_probability(real along) { return fma(along, broadcast(-0.5), broadcast(0.5)); }

/// From a level along z: the flip probability needs no vector.
inline bool has_closed_form(const SpinZone& zone) {
  return zone.kind == ZoneKind::rotating && !zone.turned && zone.drive[0].twist == 0;
}

/// The rotating field's closed form, Rabi 1937: P = (w1/Omega)^2 sin^2(Omega t/2), Omega^2 = (w0 - w)^2 +
/// w1^2.
struct RabiFlop {
  double most = 0, half_turn_per_slowness = 0;  // [m/s]
  RabiFlop() = default;
  explicit RabiFlop(const SpinZone& zone) {
    const double w1 = zone.drive[0].spin_rate, detuned = zone.spin_rate - zone.drive[0].omega;
    const double rate = __builtin_sqrt(detuned * detuned + w1 * w1);
    most = rate > 0 ? w1 * w1 / (rate * rate) : 0;
    half_turn_per_slowness = 0.5 * rate * (zone.end - zone.begin);
  }
  RABILINE_LANES real probability(real slowness) const {
    return broadcast(most) * sin_squared(broadcast(half_turn_per_slowness) * slowness);
  }
};

/// A weight shared between two outcomes: the smaller share is floored, the larger takes the rest.
struct Shares {
  real first, second;
};
RABILINE_LANES Shares share(real weight, real first_fraction) {
  const real floored = floor(weight * min(first_fraction, 1.0 - first_fraction)), rest = weight - floored;
  const mask minor = first_fraction <= broadcast(0.5);
  return {select(minor, floored, rest), select(minor, rest, floored)};
}

/// Shares of lanes in real numbers: all are floored, the largest takes what is missing.
RABILINE_LANES void give_rest_to_largest(real* shares, int levels, real weight) {
  real rest = weight, largest = broadcast(-1);
  words largest_level = words{};
  for (int to = 0; to < levels; ++to) {
    const mask larger = shares[to] > largest;
    largest = select(larger, shares[to], largest);
    largest_level = select(larger, broadcast_word(static_cast<unsigned long long>(to)), largest_level);
    rest = rest - shares[to];
  }
  for (int to = 0; to < levels; ++to) {
    const mask takes = largest_level == broadcast_word(static_cast<unsigned long long>(to));
    shares[to] = shares[to] + select(takes, rest, broadcast(0));
  }
}

}  // namespace rabiline::RABILINE_ISA
