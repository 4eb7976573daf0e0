#include "parts/solenoid.hpp"

#include "core/constants.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// On the axis, over the field of an endless one; h half of its length and R its radius.
double share_on_axis(double z, double h, double R) {
  return ((z + h) / std::sqrt((z + h) * (z + h) + R * R) - (z - h) / std::sqrt((z - h) * (z - h) + R * R)) /
         2;
}

/// Where that is 1e-4 of what it is in the middle.
double reach_of(double h, double R) {
  double inside = h, outside = h + 100 * R;
  for (int i = 0; i < 60; ++i) {
    const double middle = (inside + outside) / 2;
    (share_on_axis(middle, h, R) > 1e-4 * share_on_axis(0, h, R) ? inside : outside) = middle;
  }
  return outside;
}

}  // namespace

void contribute(const Solenoid& part, const Placement& place, SectionBuilder& builder) {
  const double half = part.winding / 2;
  const auto* wound = std::get_if<CoilCurrent>(&part.strength);
  const double endless = wound
                             ? constants::vacuum_permeability * wound->turns * wound->current / part.winding
                             : std::get<CoilField>(part.strength).field / share_on_axis(0, half, part.radius);
  const double reach = part.reach.value_or(reach_of(half, part.radius));
  add_shaped(clock_of(part.oscillates), std::max(0.0, place.at - reach), place.at + reach,
             placed(ShapedTerm(SheetShape{part.radius, half, endless}), place_of(place.at, part.offset),
                    frame_along(part.direction, part.tilt)),
             builder);
}

}  // namespace rabiline
