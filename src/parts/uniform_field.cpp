#include "parts/uniform_field.hpp"

#include <fmt/format.h>
#include <cmath>

#include "section/section_builder.hpp"

namespace rabiline {
namespace {

void contribute_fringed(const UniformField& part, const Placement& place, SectionBuilder& builder) {
  const FringedField fringed =
      fringed_field(shape_of(part.fringe, part.profile), part.field * turned(part.direction, part.tilt),
                    place.at, part.length, part.offset);
  for (const ShapedTerm& term : fringed.terms) builder.shaped(fringed.begin, fringed.end, term);
  for (const double y : fringed.kinks) builder.kink(y);
}

bool is_one_way(const UnitVector& d) { return std::abs(d.y) < 1e-9 || std::abs(d.y) > 1 - 1e-9; }

}  // namespace

StaticField static_field(const UniformField& part) {
  return {part.field * turned(part.direction, part.tilt), !(part.tilt == Tilt{})           ? "tilt"
                                                          : part.direction == UnitVector{} ? "field"
                                                                                           : "direction"};
}

void contribute(const UniformField& part, const Placement& place, SectionBuilder& builder) {
  const double end = place.at + part.length;
  if (std::holds_alternative<HardFringe>(part.fringe) &&
      std::holds_alternative<RectangularProfile>(part.profile))
    builder.uniform(place.at, end, {part.field * turned(part.direction, part.tilt)});
  else
    contribute_fringed(part, place, builder);
  if (part.gradient != FieldGradient{})
    builder.shaped(place.at, end,
                   gradient_term(part.gradient, part.direction, part.tilt,
                                 place_of(place.at + part.length / 2, part.offset)));
  if (part.bore) builder.bore(place.at, end, part.bore->radius, part.offset);
}

std::vector<Fault> faults_of(const UniformField& part, const Placement& place) {
  const bool hard = std::holds_alternative<HardFringe>(part.fringe), even = part.gradient == FieldGradient{};
  const bool has_profile = !std::holds_alternative<RectangularProfile>(part.profile);
  if (has_profile && (!hard || !even))
    return {{place.name, "profile",
             fmt::format("`{}` has a profile and a {}, whose fields do not go together", place.name,
                         hard ? "gradient" : "fringe"),
             "omit one of them, or make two fields that overlap"}};
  if (!hard && !even)
    return {{place.name, "gradient",
             fmt::format("`{}` has a gradient and a fringe, whose fields do not go together", place.name),
             "omit one of them, or make two fields that overlap"}};
  if (!even && !is_one_way(part.direction))
    return {{place.name, "gradient",
             fmt::format("the field of `{}` with a gradient points along or across the beam", place.name),
             "turn it with `tilt`, gradient and all"}};
  return faults_of_fringe(part.fringe, part.profile, place);
}

}  // namespace rabiline
