#include "parts/gradient_magnet.hpp"

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const GradientMagnet& part, const Placement& place, SectionBuilder& builder) {
  MagnetTerm term{place.at + part.length, {}, {}, {}, {}};
  term.shape.field = part.field;
  term.shape.gradient = part.gradient;
  term.shape.along_x = part.along.x;
  term.shape.along_z = part.along.z;
  if (part.gap) {
    term.walls.rectangle = true;
    term.walls.x = part.offset.x;
    term.walls.z = part.offset.z;
    term.walls.half_x = part.gap->width / 2;
    term.walls.half_z = part.gap->height / 2;
  }
  builder.plane(place.at, term);
  builder.uniform(place.at, term.end, {{0, 0, part.field}});
}

}  // namespace rabiline
