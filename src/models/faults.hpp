#pragma once
// What models refuse alike.
#include <optional>
#include <string_view>
#include <vector>

#include "models/motion.hpp"
#include "particle/species.hpp"

namespace rabiline {

/// A model of one particle has one species, and that one moment.
std::optional<Fault> fault_of_species(std::string_view kind, const std::vector<Component>&);

/// Throws std::invalid_argument with the first fault.
void refuse(const std::vector<Fault>&);

}  // namespace rabiline
