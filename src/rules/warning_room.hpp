#pragma once
// The warnings by theme.
#include <vector>

#include "rules/room.hpp"

namespace rabiline {

inline Fault warning(std::string subject, std::string key, std::string message, std::string help = {}) {
  return {std::move(subject), std::move(key), std::move(message), std::move(help), Severity::warning};
}

/// What makes one scan point pointless.
Faults blunders_of(const Beamline&);
/// Fields that are far from every resonance, or turn the wrong way, at one scan point.
Faults idle_drives_of(const Beamline&);
/// Where the physics that is left out matters at one scan point.
Faults approximations_of(const Beamline&);

}  // namespace rabiline
