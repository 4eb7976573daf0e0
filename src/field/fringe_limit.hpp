#pragma once
// How far from its axis a fringed field can be known from its curve.
#include "field/shaped_field.hpp"

namespace rabiline {

/// [m] from the plane through the axis across B, or from the axis where B is along it. Farther out
///  - the field of an edge without end (tanh, enge, gaussian) is more than half as large again as the whole
///  field somewhere across B, as nowhere near a magnet, and has a pole not much farther out;
///  - the flux that turns aside where a sine begins and ends is off by more than 1 %, since the field jumps
///  there: of B across it is sinh(u)/u - 1 = u^2/6 too much with u = pi r/length, of B along u^2/8;
///  - the series of two wires is off by more than 1 %, which alone is what `series_good_up_to` says.
double good_up_to(const FringeShape&);
double series_good_up_to(const FringeShape&);

/// [m] how far from there a place is, of such a term.
double distance_from_axis(const ShapedTerm& fringed, double x, double y, double z);

}  // namespace rabiline
