#pragma once
// What the library says of a model, and its solution.
#include <string>

#include "models/solved_model.hpp"
#include "scan/model_file.hpp"

namespace rabiline {

/// The model, its scan and the numbers that follow from its values alone.
std::string explain(const LoadedModel&);

/// All but its provenance. Throws std::runtime_error where a motion cannot be integrated, with the scan
/// point.
/// Calls `between` before each point.
SolvedModel solve_all(const LoadedModel&, const std::function<void()>& between);

}  // namespace rabiline
