#pragma once
// The text of `rabiline check` about speeds that the program's mechanics does not know.
#include <optional>
#include <string>

#include "plan/plan.hpp"

namespace rabiline {

/// A warning where a species of any scan point flies so fast, in the mean, that (v/c)^2 exceeds 1e-3: the
/// program knows no relativity, under no law.
std::optional<std::string> warning_of_relativity(const Experiment&);

}  // namespace rabiline
