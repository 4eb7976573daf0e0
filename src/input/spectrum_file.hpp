#pragma once
// Spectra of speeds in CSV files.
#include "input/values.hpp"

namespace rabiline {

/// Reads the file that `node` names, once for a Reading; nothing where something is wrong with it, which the
/// first call reports.
std::shared_ptr<const Spectrum> read_spectrum(const Node& node, const Row&, Reading&);

}  // namespace rabiline
