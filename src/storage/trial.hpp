#pragma once
// Work on files of others that may end the process, tried in one of its own.
#include <functional>

namespace rabiline {

/// Whether a process of its own comes to the end of it, returning true, within some seconds. Where there can
/// be no other process it counts as if it had.
bool ends_well(const std::function<bool()>&);

}  // namespace rabiline
