#include "parts/gradient_magnet.hpp"

#include <fmt/format.h>
#include <cmath>

#include "section/magnet_field.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

namespace {

/// [T] along +z: moving the magnet takes the slope along.
double field_on_axis(const GradientMagnet& part) {
  return part.field - part.gradient * (part.along.x * part.offset.x + part.along.z * part.offset.z);
}

}  // namespace

StaticField static_field(const GradientMagnet& part) { return {{0, 0, field_on_axis(part)}, "field"}; }

void contribute(const GradientMagnet& part, const Placement& place, SectionBuilder& builder) {
  MagnetTerm term{place.at + part.length, {}, {}, part.offset, {}};
  term.shape.field = part.field;
  term.shape.gradient = part.gradient;
  term.shape.along_x = part.along.x;
  term.shape.along_z = part.along.z;
  if (part.gap) {
    term.walls.rectangle = true;
    term.walls.half_x = part.gap->width / 2;
    term.walls.half_z = part.gap->height / 2;
  }
  contribute_magnet(
      term, part.fringe, place, {0, 0, field_on_axis(part)},
      [&](FringedField& whole) {
        whole.add({0, 0, part.field}, slopes_of(term.shape));
      },
      builder);
}

std::vector<Fault> faults_of(const GradientMagnet& part, const Placement& place) {
  std::vector<Fault> out = faults_of_fringe(part.fringe, RectangularProfile{}, place);
  if (std::abs(part.along.y) <= 1e-9) return out;
  out.push_back({place.name, "along",
                 fmt::format("the gradient of `{}` has a component along the beam", place.name),
                 "write `x` or `z`, or `[1, 0, 1]` for one between"});
  return out;
}

}  // namespace rabiline
