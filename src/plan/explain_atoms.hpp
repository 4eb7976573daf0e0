#pragma once
// What a plan does to the levels of atoms, in words.
#include <string>
#include <vector>

#include "beamline/beamline.hpp"

namespace rabiline {

/// "Cs-133 atom: I = 7/2, J = 1/2, 16 levels, F=4 above F=3 by 9192.6318 MHz".
std::string headline_of(const Species& atom);

/// Where no field is between two that are, and an atom's levels keep their labels; empty where there is none.
std::string field_free_gaps(const Beamline&);

std::vector<int> all_levels(const Species&);
/// The levels that a source prepares, where its beam begins on the axis and along it; else none. None under
/// a vector law.
std::vector<int> levels_on_axis(const Source&, const Species&, const Law&);

}  // namespace rabiline
