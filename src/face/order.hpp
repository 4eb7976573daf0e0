#pragma once
// What the leader of several ranks tells the others to fly.
#include "rabiline.hpp"

namespace rabiline {

/// By the leader, when everything about its run is known to be right. Where it stands, without sums: they
/// stay with the leader.
void give_order(const Snapshot&, const RunSettings&);

}  // namespace rabiline
