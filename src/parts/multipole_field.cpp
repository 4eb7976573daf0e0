#include "parts/multipole_field.hpp"

#include "core/portable_math.hpp"
#include "parts/magnet_rules.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const MultipoleField& part, const Placement& place, SectionBuilder& builder) {
  const MultipoleShape poles{static_cast<int>(part.poles) / 2 - 1, part.field, part.radius};
  const OwnFrame frame = turned_frame(part.tilt);
  if (is_boxed(part.fringe, part.profile))
    return add_shaped(clock_of(part.oscillates), place.at, place.at + part.length,
                      placed(ShapedTerm(poles), place_of(place.at + part.length / 2, part.offset), frame),
                      builder);
  const double beside = part.radius * portable::hypot(frame.y.x, frame.y.z, 0);
  FringedField fringed(shape_of(part.fringe, part.profile), place.at, part.length, part.offset, beside);
  fringed.add_poles(poles, {frame.z, frame.x, frame.y});
  fringed.contribute(builder, clock_of(part.oscillates));
}

std::vector<Fault> faults_of(const MultipoleField& part, const Placement& place) {
  std::vector<Fault> out = faults_of_poles(part.poles, place);
  for (Fault& fault : faults_of_fringe(part.fringe, part.profile, place)) out.push_back(std::move(fault));
  return out;
}

}  // namespace rabiline
