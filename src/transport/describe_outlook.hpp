#pragma once
#include <string>

#include "transport/region.hpp"

namespace rabiline {

/// "the field splits the paths of the levels by ...: neither one path nor no phase", where that is so.
std::string describe_between(const StretchOutlook&);

}  // namespace rabiline
