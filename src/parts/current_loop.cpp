#include "parts/current_loop.hpp"

#include "core/constants.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

double reach_of_loop(double radius) {
  return radius * std::sqrt(portable::pow(10.0, 8.0 / 3) - 1);  // (1 + (z/R)^2)^(-3/2) = 1e-4
}

void contribute(const CurrentLoop& part, const Placement& place, SectionBuilder& builder) {
  const auto* wound = std::get_if<CoilCurrent>(&part.strength);
  const double field =
      wound ? constants::vacuum_permeability * wound->turns * wound->current / (2 * part.radius)
            : std::get<CoilField>(part.strength).field;
  const double reach = part.reach.value_or(reach_of_loop(part.radius));
  add_shaped(clock_of(part.oscillates), std::max(0.0, place.at - reach), place.at + reach,
             placed(ShapedTerm(LoopShape{part.radius, field}), place_of(place.at, part.offset),
                    frame_along(part.direction, part.tilt)),
             builder);
}

}  // namespace rabiline
