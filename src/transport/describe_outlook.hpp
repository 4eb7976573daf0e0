#pragma once
#include <string>

#include "transport/region.hpp"

namespace rabiline {

/// "the field splits the paths of the levels by ...: too far apart for one path, ...", where that is so.
std::string describe_between(const StretchOutlook&);
/// "levels are sorted: their paths come apart by ..., their phases by ... turns"; `flies_straight`: the paths
/// of what stays coherent are not bent.
std::string describe_levels(const StretchOutlook&, bool flies_straight);

}  // namespace rabiline
