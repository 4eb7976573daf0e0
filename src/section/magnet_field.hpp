#pragma once
// The fields of deflecting magnets as fields among others, with all components and slopes.
#include <array>
#include <vector>

#include "section/section.hpp"

namespace rabiline {

/// [T/m] dB_i/dx_k at [3 i + k] of an even gradient, which takes a component across the field with it, as
/// Maxwell's equations have it.
std::array<double, 9> slopes_of(const MagnetShape&);
/// The terms that add up to the field of a magnet which begins there, in the laboratory: wires along the
/// beam, poles, or an even gradient.
std::vector<ShapedTerm> field_terms_of(const MagnetTerm&, double begin);

/// The axis of the levels that a magnet finds: of its field where the beam is, taken upwards, so that a
/// magnet along z keeps the levels along +z whichever way its field points. One whose field turns about the
/// beam's axis, of poles that alternate, takes the levels along +z along with it; so does an even gradient,
/// whose field changes its sign beside the beam and is along z everywhere.
UnitVector spin_axis(const MagnetTerm&);
/// Whether its field points against that axis.
bool is_against_axis(const MagnetTerm&);

}  // namespace rabiline
