#include "face/part_names.hpp"

namespace rabiline {

std::vector<PartName> names_of(const std::vector<PlacedPart>& parts) {
  std::vector<PartName> out;
  for (const PlacedPart& part : parts) {
    const Placement& place = part.placement;
    const PartTraits traits = traits_of(part.part);
    out.push_back({place.name, std::string(kind_of(part.part)), place.label.value_or(place.name), place.at,
                   end_of(part), traits.field, traits.drives});
  }
  return out;
}

}  // namespace rabiline
