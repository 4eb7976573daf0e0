#pragma once
// Stretches of the beam with fields that differ from place to place, and whether a species' levels stay
// coherent there.
#include <optional>
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/sampled_tables.hpp"
#include "section/section.hpp"
#include "transport/region.hpp"

namespace rabiline {

/// Touching sections with fields that differ from place to place.
struct Stretch {
  double begin = 0, end = 0;  // [m]
  StretchOutlook outlook{};
  // Of levels of one moment that it sorts: the axes at both ends, along the field on the beam's axis, or
  // against it where it points downwards at the entrance.
  UnitVector entrance{}, exit{};
  bool against_axis = false;
};
/// [T] The largest static field on the beam's axis, in the middles of a stretch's sections.
double largest_on_axis(const Sections&, const Source&, const Stretch&);
/// Of that field at y; none where it is below a hundredth of the largest, as at the end of a fringe.
std::optional<Vector3> direction_on_axis(const Sections&, const Source&, double y, double largest);
/// Whether a tally has an axis of it.
bool asks_for_adiabaticity(const Beamline&);
/// Whatever flies.
std::vector<Stretch> stretches_of(const Sections&);
/// As a species finds them.
std::vector<Stretch> stretches_of(const Beamline&, const Species&, const Sections&);

/// Those through which particles go in steps: all, but for atoms only those that sort their levels.
std::vector<Stretch> flown_in_steps(std::vector<Stretch>, const Law&, const Species&);

/// How a species feels fields that differ from place to place; and where each particle stays in its level.
FieldCoupling coupling_of(const Beamline&, const Species&);
FieldCoupling level_coupling_of(const Beamline&, const Species&, const Stretch&, SampledTables&);

}  // namespace rabiline
