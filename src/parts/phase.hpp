#pragma once

namespace rabiline {

/// The phase of an alternating field at the moment a particle is emitted: drawn uniformly for each particle
/// (emission at any time of the period), zero for all (`locked`), or an angle.
struct Phase {
  enum class Kind { random, locked, angle } kind = Kind::locked;
  double angle = 0;  // [rad]; 0 unless kind is angle
  bool operator==(const Phase&) const = default;
};

}  // namespace rabiline
