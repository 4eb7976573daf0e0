#pragma once
// Fields of any direction and shape along a straight path, through which the levels of an atom are carried as
// amplitudes, as kernels see them.
#include "field/shaped_term.hpp"
#include "spin/level_table.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// A part of the way with a field.
struct CourseSection {
  SpinZone field;                        // all that does not differ across the beam: its rates are fields [T]
  int shaped_begin = 0, shaped_end = 0;  // of the course's terms
  double longest = 0;                    // [m] way in one step
  double moment = 0;                     // [s] short against whatever drives there; 0: nothing does
  bool operator==(const CourseSection&) const = default;
};

/// From where levels are known to where they are asked for. At both ends they are those of the field there,
/// or in no field those along +z; between fields they stay as if a weak field kept its direction. Where one
/// field ends and another begins, levels keep their names in the frame of the old direction, as if the size
/// changed slowly; directions change at once.
struct LevelCourse {
  const LevelManifold* manifolds = nullptr;
  const int *manifold_of = nullptr, *place_of = nullptr;  // [level]
  const CourseSection* sections = nullptr;
  int count = 0;
  const ShapedTerm* shaped = nullptr;
  bool begins_in_field = false, ends_in_field = false;
  double tolerance = 1e-6;  // of probabilities
};

}  // namespace rabiline
