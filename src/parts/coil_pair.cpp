#include "parts/coil_pair.hpp"

#include <fmt/format.h>

#include "core/constants.hpp"
#include "parts/current_loop.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// [T] of each ring in its own middle. On the axis a ring at h has B (1 + ((z - h)/R)^2)^(-3/2).
double field_of_ring(const CoilPair& part, double half_distance) {
  const double radius = part.radius, ratio = half_distance / radius, widened = std::sqrt(1 + ratio * ratio);
  if (const auto* wound = std::get_if<CoilCurrent>(&part.strength))
    return constants::vacuum_permeability * wound->turns * wound->current / (2 * radius);
  if (const auto* middle = std::get_if<CoilField>(&part.strength))
    return middle->field / 2 * portable::pow(widened, 3);
  return std::get<CoilGradient>(part.strength).gradient * radius / (6 * ratio) * portable::pow(widened, 5);
}

}  // namespace

void contribute(const CoilPair& part, const Placement& place, SectionBuilder& builder) {
  const double half = part.distance.value_or(part.radius) / 2, field = field_of_ring(part, half);
  const double reach = part.reach.value_or(half + reach_of_loop(part.radius));
  const bool opposed = part.opposed || std::holds_alternative<CoilGradient>(part.strength);
  const OwnFrame frame = frame_along(part.direction, part.tilt);
  for (const double side : {-1.0, 1.0})
    add_shaped(clock_of(part.oscillates), std::max(0.0, place.at - reach), place.at + reach,
               placed(ShapedTerm(LoopShape{part.radius, opposed ? side * field : field}),
                      place_of(place.at, part.offset) + (side * half) * frame.z, frame),
               builder);
}

std::vector<Fault> faults_of(const CoilPair& part, const Placement& place) {
  if (!part.opposed || !std::holds_alternative<CoilField>(part.strength)) return {};
  return {{place.name, "field",
           fmt::format("the field in the middle of `{}` is zero, since its currents are opposed", place.name),
           "state `gradient` or `current` instead"}};
}

}  // namespace rabiline
