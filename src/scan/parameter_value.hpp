#pragma once
// What a dotted name stands for in a beamline.
#include <optional>
#include <string>

#include "beamline/beamline.hpp"
#include "core/units.hpp"

namespace rabiline {

/// The number called `B.field`, in SI with its dimension; nothing where there is none of that name.
std::optional<ParsedQuantity> number_called(const std::string& name, const Beamline&);

}  // namespace rabiline
