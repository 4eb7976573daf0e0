#pragma once
// Maps of fields in files, CSV or HDF5.
#include "input/values.hpp"

namespace rabiline {

/// Reads the map that `node` names, once for a Reading; nothing where something is wrong with it, which is
/// reported.
std::shared_ptr<const FieldMap> read_map(const Node& node, const Row&, Reading&);

}  // namespace rabiline
