#include "face/part_names.hpp"

#include <cmath>
#include <type_traits>

#include "core/portable_math.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

struct Stretch {
  double begin, end;  // [m]
};

/// Turns about an axis, up to a distance from the middle.
Stretch around(double middle, const Vector3& axis, double half_length, double radius) {
  const double half = half_length * std::abs(axis.y) + radius * portable::hypot(axis.x, axis.z, 0);
  return {middle - half, middle + half};
}

/// Where a part stands along the beam: the turns of a coil, however far their field reaches, and all of a
/// map.
Stretch stretch_of(const PlacedPart& placed) {
  const double at = placed.placement.at;
  return std::visit(
      [&](const auto& part) -> Stretch {
        using Kind = std::decay_t<decltype(part)>;
        if constexpr (std::is_same_v<Kind, Solenoid>)
          return around(at, turned(part.direction, part.tilt), part.winding / 2, part.radius);
        else if constexpr (std::is_same_v<Kind, CoilPair>)
          return around(at, turned(part.direction, part.tilt), part.distance.value_or(part.radius) / 2,
                        part.radius);
        else if constexpr (std::is_same_v<Kind, CurrentLoop>)
          return around(at, turned(part.direction, part.tilt), 0, part.radius);
        else if constexpr (std::is_same_v<Kind, MappedField>) {
          SectionBuilder builder(Wall{});
          contribute(part, placed.placement, builder);
          const std::vector<Section> sections = builder.build().sections;
          return {sections.front().begin, sections.back().end};
        } else
          return {at, end_of(placed)};
      },
      placed.part);
}

}  // namespace

std::vector<PartName> names_of(const std::vector<PlacedPart>& parts) {
  std::vector<PartName> out;
  for (const PlacedPart& part : parts) {
    const Placement& place = part.placement;
    const PartTraits traits = traits_of(part.part);
    const auto [begin, end] = stretch_of(part);
    out.push_back({place.name, std::string(kind_of(part.part)), place.label.value_or(place.name), begin, end,
                   traits.field, traits.drives});
  }
  return out;
}

}  // namespace rabiline
