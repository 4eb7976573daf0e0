#pragma once
// What became of a particle. Every one has exactly one fate, and the fates add up to what was emitted.
#include <string_view>

namespace rabiline {

enum class Fate : int {
  flying = 0,      // not decided yet
  stopped,         // by a part, a bore or the chamber
  detected,        // by a detector
  passed,          // flew past the last part
  left_backwards,  // left a field against the beam
  gave_up          // was still circling in a field when its flight was cut off
};

}  // namespace rabiline
