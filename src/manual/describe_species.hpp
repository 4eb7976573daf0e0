#pragma once
// The library of species for people: all in a table, or one with what follows from its constants.
#include <string>

#include "particle/species.hpp"

namespace rabiline {

/// One line for each species, and where the constants come from.
std::string species_table();
std::string describe_species_of_library(const Species&);

/// Those with levels: one line for each; and one with its constants and levels.
std::string table_of_species_with_levels();
std::string describe_species_with_levels(const Species&);

/// Its isotopes and how many atoms of a hundred they are.
std::string describe_mixture(const Mixture&);

/// The pages `species` and `structure`.
std::string describe_species();
std::string describe_structure();

}  // namespace rabiline
