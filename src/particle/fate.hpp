#pragma once
// What became of a particle, in the words of results. Every one has exactly one fate, and the fates add up to
// what was emitted. A stage may have a fate of its own.
#include <string_view>

namespace rabiline::fate {

inline constexpr std::string_view stopped = "stopped",  // by a part, a bore or the chamber
    detected = "detected",                              // by a detector
    passed = "passed",                                  // flew past the last part
    left_backwards = "left_backwards",                  // left a field against the beam
    gave_up = "gave_up",        // was still circling in a field when its flight was cut off
    left_map = "left_map",      // flew out of a map of a field that nothing may leave
    overflowed = "overflowed";  // its place, velocity or spin became too large for a number, or none at all

}  // namespace rabiline::fate
