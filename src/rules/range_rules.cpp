// Numbers outside of the range that their table states: a file's are refused where they are read.
#include <algorithm>

#include "rules/each_number.hpp"

namespace rabiline {

void check_ranges(const Beamline& beamline, Faults& out) {
  each_number(
      beamline, [&](std::string_view subject, double value, const NumberKey& key, const NumberRow& row) {
        if (row.range.contains(value)) return;
        const std::string name = key.text();
        out.push_back({std::string(subject),
                       name,
                       fmt::format("`{}` must be {}, but is {:.6g}", name, row.range.wanted_of(value), value),
                       {}});
      });
  if (beamline.until && std::ranges::none_of(beamline.parts, [](const PlacedPart& part) {
        return detector_in(part.part) != nullptr;
      }))
    out.push_back({"until", "", "`until` asks for the error of what is detected, and there is no detector",
                   "add a detector, or omit `until`"});
  if (const auto* tabulated = std::get_if<TabulatedSpeed>(&beamline.source.speed);
      tabulated && !tabulated->file.spectrum)
    out.push_back({"source", "speed.file", "there is no spectrum to draw speeds from", ""});
  for (std::size_t i = 0; i < beamline.species.size(); ++i)
    if (const Species& species = beamline.species[i].species; !(species.mass > 0) || species.spin.twice < 1)
      out.push_back({"species", key_of_species(i, species.mass > 0 ? "spin" : "mass"),
                     fmt::format("the {} of `{}` must be greater than zero",
                                 species.mass > 0 ? "spin" : "mass", species.name),
                     ""});
  if (beamline.particles < 1)
    out.push_back({"", "particles", "`particles` must be from 1 to 1e14, but is 0", ""});
}

}  // namespace rabiline
