#include "parts/straight_wire.hpp"

#include "core/constants.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const StraightWire& part, const Placement& place, SectionBuilder& builder) {
  const double strength = constants::vacuum_permeability * part.current / constants::two_pi;
  const WireShape shape{strength, part.radius, part.wire_length.value_or(0) / 2};
  add_shaped(
      clock_of(part.oscillates), std::max(0.0, place.at - part.reach), place.at + part.reach,
      placed(ShapedTerm(shape), place_of(place.at, part.offset), frame_along(part.direction, part.tilt)),
      builder);
}

}  // namespace rabiline
