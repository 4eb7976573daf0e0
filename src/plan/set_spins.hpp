#pragma once
// What polarizers and filters are to one species.
#include "section/section.hpp"
#include "transport/stages/alignment.hpp"
#include "transport/stages/filter.hpp"
#include "transport/stages/level_filter.hpp"

namespace rabiline {

/// `quantum`: particles are in levels.
Alignment alignment_of(const AlignTerm&, const Plane&, const Species&, bool quantum);
/// Of spins without levels of two spins: of spin 1/2 under `quantum`.
Filter filter_of(const FilterTerm&, const Plane&, const Species&, bool quantum);
/// Of an atom, which has the levels that are named.
LevelFilter level_filter_of(const FilterTerm&, const Plane&, const Species& atom);

}  // namespace rabiline
