// From parts to sections: each part contributes its terms.
#include <algorithm>
#include <utility>
#include <variant>

#include "plan/plan.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

Sections sections_of(const Beamline& beamline) {
  Wall chamber;
  if (beamline.chamber) chamber.radius = beamline.chamber->radius;
  SectionBuilder builder(chamber, std::ranges::any_of(beamline.species, [](const Component& component) {
                           return component.species.structure.has_value();
                         }));
  for (std::size_t i = 0; i < beamline.parts.size(); ++i) {
    builder.begin_part(static_cast<int>(i));
    std::visit([&](const auto& part) { contribute(part, beamline.parts[i].placement, builder); },
               beamline.parts[i].part);
  }
  if (beamline.gravity && beamline.gravity->direction.y != 0) {
    double end = 0;
    for (const PlacedPart& part : beamline.parts) end = std::max(end, end_of(part));
    builder.fall_along(end);
  }
  const LawTraits law = law_traits(beamline.law);
  Sections out = builder.build(law.has_forces ? Magnets::deflect : Magnets::uniform);
  const Species& first = beamline.species.front().species;
  if (!law.has_levels || !first.structure) return out;
  // To levels a coil's field is one as any other.
  for (Section& section : out.sections)
    for (const CoilTerm& coil : std::exchange(section.coils, {}))
      section.field = section.field + coil.field(first);
  return out;
}

}  // namespace rabiline
