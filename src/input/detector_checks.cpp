// Detectors that cannot stand together.
#include <cmath>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

/// A detector's results stand beside each other under its name with an ending.
void check_result_names(const PartNodes& nodes, Reading& reading) {
  const std::vector<std::string> detectors = nodes.names({Detector::kind});
  for (const std::string& name : detectors)
    for (const std::string_view ending : {"_x", "_z", "_levels"})
      if (std::find(detectors.begin(), detectors.end(), name + std::string(ending)) != detectors.end())
        reading.error(
            place_of(*nodes.find(name + std::string(ending)), "name"),
            fmt::format("the detector `{}` keeps results under the name `{}{}`", name, name, ending),
            "choose another name");
}

void check_coverage(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const Entry* parts = root.find("parts");
  if (!parts || !parts->value.is_sequence()) return;
  const auto& items = parts->value.items;
  if (std::none_of(items.begin(), items.end(),
                   [](const Node& n) { return PartNodes::kind_of(n) == Detector::kind; }))
    reading.error(
        parts->key_place, "there is no detector among the parts, so the experiment would measure nothing",
        "add `- {name: screen, kind: detector, at: 1.2 m, width: 4 mm, height: 4 mm, bins: [80, 80]}`");
  for (std::size_t i = 0; i < beamline.parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const PlacedPart &a = beamline.parts[k], &b = beamline.parts[i];
      const auto *first = std::get_if<Detector>(&a.part), *second = std::get_if<Detector>(&b.part);
      if (!first || !second || a.placement.at != b.placement.at) continue;
      if (std::abs(first->offset.x - second->offset.x) < (first->width + second->width) / 2 &&
          std::abs(first->offset.z - second->offset.z) < (first->height + second->height) / 2)
        reading.error(
            place_in(nodes, b, "at"),
            fmt::format(
                "the detectors `{}` and `{}` cover each other at {}: which of them would catch a particle?",
                a.placement.name, b.placement.name, metres(b.placement.at)),
            "move one of them along the beam, or aside with `offset`");
    }
}

}  // namespace

void check_detectors(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  check_result_names(nodes, reading);
  check_coverage(beamline, root, nodes, reading);
}

}  // namespace rabiline
