#pragma once
// Fields with a fringe, held against how far from the axis particles come.
#include <vector>

#include "beamline/beamline.hpp"
#include "core/fault.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// Flies the first particles of each species through the first scan point, and warns of fringes that they
/// pass farther from the axis than the curve tells what the field is (field/fringe_limit.hpp): at both ends
/// of straight flights, and at every step of those through fields.
std::vector<Fault> warnings_of_fringes(const Beamline& first, const Plan&);

/// Of curves by Enge that do not fall all the way outwards, and of fringes that leave nothing whole or reach
/// the source.
std::vector<Fault> odd_fringes_of(const Beamline&);

}  // namespace rabiline
