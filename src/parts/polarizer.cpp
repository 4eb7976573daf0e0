#include "parts/polarizer.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const Polarizer& polarizer, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + polarizer.length;
  const Vector3 axis = turned(Vector3{0, 0, 1}, polarizer.tilt);
  builder.plane(place.at, AlignTerm{(1 + polarizer.alignment) / 2, polarizer.field < 0 ? -1.0 : 1.0, axis});
  if (std::holds_alternative<HardFringe>(polarizer.fringe)) {
    builder.uniform(place.at, end, {polarizer.field * axis});
  } else {
    FringedField fringed(shape_of(polarizer.fringe, RectangularProfile{}), place.at, polarizer.length,
                         polarizer.offset);
    fringed.add(polarizer.field * axis);
    fringed.contribute(builder);
  }
  if (polarizer.bore) builder.bore(place.at, end, polarizer.bore->radius, polarizer.offset);
}

std::vector<Fault> faults_of(const Polarizer& polarizer, const Placement& place) {
  return faults_of_fringe(polarizer.fringe, RectangularProfile{}, place);
}

}  // namespace rabiline
