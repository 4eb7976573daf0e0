#pragma once
// Ways through fields in which an atom's levels have no closed form: of any direction, differing from place
// to place, or with drives that no frame makes stand still.
#include <optional>
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/sampled_tables.hpp"
#include "section/section.hpp"

namespace rabiline {

/// [m] Where parts touch, rounding may leave a section of this length between them.
inline constexpr double no_length = 1e-12;

/// Whether a field needs one, however weak.
bool needs_way(const Section&);
/// Between two places, where any field on the way needs it, or fields along +z and against it meet.
bool needs_way(const std::vector<Section>&, double from, double to);

/// The fields between two places as the levels of an atom see them; only where needs_way(). F whose
/// zero-field energies are more than `apart` [Hz] from each other exchange nothing: the amplitudes that they
/// would exchange are about moment |dB/dt|/(2 pi apart^2), at most two fifths of the root of the tolerance
/// where the field changes along the beam, and a tenth where something drives. `behind` [T]: of a field along
/// +z that begins where they are asked for.
LevelFields level_fields(const Beamline&, const Species&, const std::vector<Section>&, double from, double to,
                         double behind = 0);
/// Periods of the fastest of the drives in a section that are followed in steps as whole fields, at a speed
/// [m/s].
double cycles_in(const CourseSection&, double speed);

/// With more than this in all, fields that turn are taken in the rotating-wave approximation, those of the
/// highest frequencies first; what must be whole is refused.
inline constexpr double most_cycles = 1e4;

}  // namespace rabiline
