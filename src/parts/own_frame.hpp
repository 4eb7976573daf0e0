#pragma once
// Where a field that differs from place to place stands, and how it is turned.
#include "field/shaped_term.hpp"
#include "parts/placement.hpp"

namespace rabiline {

/// Three unit vectors in the laboratory, right-handed.
struct OwnFrame {
  Vector3 x, y, z;
};

/// That of the laboratory, turned.
OwnFrame turned_frame(const Tilt&);
/// Its z axis points along a direction that is then turned; the other two are across it.
OwnFrame frame_along(const UnitVector& direction, const Tilt&);
/// The term with its origin there and these axes.
ShapedTerm placed(ShapedTerm, const Vector3& origin, const OwnFrame&);
/// On the beam where `y` says, displaced.
inline Vector3 place_of(double y, const Offset& offset) { return {offset.x, y, offset.z}; }

}  // namespace rabiline
