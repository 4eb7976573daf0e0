#pragma once
// What a result shows of its scan.
#include <string>
#include <vector>

#include "simulation/result.hpp"

namespace rabiline {

/// One text, with its help in a further line, for each axis whose points agree to the bit in everything that
/// detectors, monitors and tallies saw: what is scanned there had no effect.
std::vector<std::string> warnings_of(const Result&);

}  // namespace rabiline
