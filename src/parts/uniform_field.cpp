#include "parts/uniform_field.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

bool is_one_way(const UnitVector& d) { return std::abs(d.y) < 1e-9 || std::abs(d.y) > 1 - 1e-9; }

}  // namespace

StaticField static_field(const UniformField& part) {
  return {part.field * turned(part.direction, part.tilt), !(part.tilt == Tilt{})           ? "tilt"
                                                          : part.direction == UnitVector{} ? "field"
                                                                                           : "direction"};
}

void contribute(const UniformField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  const Vector3 field = part.field * turned(part.direction, part.tilt);
  const bool even = part.gradient == FieldGradient{};
  const FieldSlopes slopes = even ? FieldSlopes{} : slopes_of(part.gradient, part.direction, part.tilt);
  if (is_boxed(part.fringe, part.profile)) {
    builder.uniform(place.at, end, {field});
    if (!even) {
      ShapedTerm growth(LinearShape{});
      std::ranges::copy(slopes, growth.linear.slope);
      builder.shaped(place.at, end,
                     placed(growth, place_of(place.at + part.length / 2, part.offset), turned_frame({})));
    }
  } else {
    FringedField fringed(shape_of(part.fringe, part.profile), place.at, part.length, part.offset);
    fringed.add(field, slopes);
    fringed.contribute(builder);
  }
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

std::vector<Fault> faults_of(const UniformField& part, const Placement& place) {
  if (part.gradient != FieldGradient{} && !is_one_way(part.direction))
    return {
        {place.name, "gradient",
         fmt::format("the field of `{}` has a gradient, and must point along or across the beam", place.name),
         "turn it with `tilt`, gradient and all"}};
  return faults_of_fringe(part.fringe, part.profile, place);
}

}  // namespace rabiline
