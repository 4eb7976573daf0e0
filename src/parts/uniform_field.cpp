#include "parts/uniform_field.hpp"

#include <fmt/format.h>
#include <cmath>

#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// Across and along the beam, each as Maxwell's equations have it.
void contribute_fringed(const UniformField& part, const Placement& place, SectionBuilder& builder) {
  FringeShape shape = shape_of(part.fringe, part.profile);
  const double reach = reach_of(shape).value_or(0), end = place.at + part.length + reach;
  const Vector3 field = part.field * turned(part.direction, part.tilt), across{field.x, 0, field.z};
  const Vector3 middle = place_of(place.at + part.length / 2, part.offset), beam{0, 1, 0};
  shape.half_length = part.length / 2;
  const auto add = [&](bool along, double size, const Vector3& x) {
    shape.along = along;
    shape.size = size;
    const Vector3 u = (1 / length_of(x)) * x;
    builder.shaped(std::max(0.0, place.at - reach), end,
                   placed(ShapedTerm(shape), middle, {u, cross(beam, u), beam}));
  };
  if (shape.curve == FringeCurve::sine && part.length > 2 * reach) {
    builder.kink(place.at + reach);
    builder.kink(place.at + part.length - reach);
  }
  if (length_of(across) > 0) add(false, length_of(across), across);
  if (field.y != 0) add(true, field.y, {1, 0, 0});
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
  if (!hard && !reach_of(shape_of(part.fringe, part.profile)))
    return {{place.name, "fringe",
             fmt::format("the fringe of `{}` does not fall from the full field to none", place.name),
             "omit the coefficients for those of a common dipole"}};
  return {};
}

}  // namespace rabiline
