#pragma once
// The library of species for people: all in a table, or one with what follows from its constants.
#include <string>

#include "particle/species.hpp"

namespace rabiline {

/// One line for each species, and where the constants come from.
std::string species_table();
std::string describe_species_of_library(const Species&);

}  // namespace rabiline
