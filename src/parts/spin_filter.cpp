#include "parts/spin_filter.hpp"

#include <fmt/format.h>

#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const SpinFilter& part, const Placement& place, SectionBuilder& builder) {
  builder.plane(place.at, FilterTerm{turned(part.axis.value_or(UnitVector{}), part.tilt), part.up, part.down,
                                     part.levels});
}

std::vector<Fault> faults_of(const SpinFilter& part, const Placement& place) {
  if (part.axis && !part.levels.empty())
    return {{place.name, "levels",
             fmt::format("`{}` filters either spins along an axis or levels, not both", place.name),
             "omit `axis` for an atom with levels, else `levels`"}};
  if (!part.levels.empty() && part.tilt != Tilt{})
    return {{place.name, "tilt",
             fmt::format("`{}` filters levels, which are those of the field where it stands", place.name),
             "omit `tilt`, or turn the field"}};
  if (!part.axis && part.levels.empty())
    return {{place.name, "kind", fmt::format("the spin_filter `{}` needs `axis` or `levels`", place.name),
             "add `axis: z`, or for an atom `levels` and the names of those that pass"}};
  return {};
}

}  // namespace rabiline
