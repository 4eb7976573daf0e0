#pragma once
// What the magnets with the field of two wires have in common.
#include "parts/fringe.hpp"
#include "parts/placement.hpp"
#include "section/section.hpp"

namespace rabiline {

class SectionBuilder;

/// The field of two wires along the beam with opposite currents, (0, height) of its frame at `offset`.
MagnetShape two_wire_shape(double field, double half_distance, double height);
/// [T] in the laboratory on the beam's axis: (B_0 (a^2 + h^2)/2a) (z/r1^2 - z/r2^2, (x+a)/r2^2 - (x-a)/r1^2)
/// in the magnet's frame, r1 from the wire at +a.
Vector3 two_wire_field_on_axis(const MagnetShape&, Offset, Roll);
/// A magnet of that field, which is that on the beam's axis where the law replaces its force.
void contribute_two_wire(const MagnetTerm&, const Fringe&, const Placement&, SectionBuilder&);

}  // namespace rabiline
