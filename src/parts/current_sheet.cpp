#include "parts/current_sheet.hpp"

#include "core/constants.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const CurrentSheet& part, const Placement& place, SectionBuilder& builder) {
  const double strength = constants::vacuum_permeability * part.current / part.width / constants::two_pi;
  // Its own z along the current, its own y along the beam, its own x along the width: z of the laboratory,
  // since x = y cross z.
  const OwnFrame frame{turned({0, 0, -1}, part.tilt), turned({0, 1, 0}, part.tilt),
                       turned({1, 0, 0}, part.tilt)};
  add_shaped(
      clock_of(part.oscillates), std::max(0.0, place.at - part.reach), place.at + part.reach,
      placed(ShapedTerm(FlatSheetShape{part.width / 2, strength}), place_of(place.at, part.offset), frame),
      builder);
}

}  // namespace rabiline
