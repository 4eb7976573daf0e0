#pragma once
// From what a user wants tallied to the stages that do it.
#include "beamline/beamline.hpp"
#include "particle/species.hpp"
#include "section/section.hpp"
#include "transport/stages/histogram.hpp"

namespace rabiline {

/// Whether a tally asks what the fields have done to spins.
bool asks_for_spin(const Tally&);

/// The tally with that number as a stage, for one species; `levels`: of `quantum`, 0 under a vector law.
/// Face, part and zones are left to the compiler.
Histogram histogram_of(const Tally&, int number, const Species&, int levels);

/// How many bins a tally has in all, for a spin with that many levels.
std::uint64_t bins_of(const Tally&, int levels);

}  // namespace rabiline
