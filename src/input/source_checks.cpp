// A source that cannot be as it is written.
#include <cmath>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

double area_of(const Opening& opening) {
  if (const auto* r = std::get_if<Rectangle>(&opening)) return r->width * r->height;
  if (const auto* ring = std::get_if<Ring>(&opening)) return ring->outer_radius - ring->inner_radius;
  return std::get<Disc>(opening).radius;
}

void check_aim(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const auto* aimed = std::get_if<AimedDirection>(&beamline.source.direction);
  if (!aimed || aimed->target.empty()) return;
  const Place& place = place_of(root.find("source")->value.find("direction")->value, "target");
  const Node* target = nodes.find(aimed->target);
  if (!target ||
      (PartNodes::kind_of(*target) != Slit::kind && PartNodes::kind_of(*target) != Detector::kind)) {
    const std::string known = suggest_name(aimed->target, nodes.names({Slit::kind, Detector::kind}));
    reading.error(place,
                  target
                      ? fmt::format("`{}` is a {}, but a source is aimed at a slit or a detector",
                                    aimed->target, PartNodes::kind_of(*target))
                      : fmt::format("there is no slit or detector `{}` to aim the source at", aimed->target),
                  known);
    return;
  }
  for (const PlacedPart& part : beamline.parts) {
    if (part.placement.name != aimed->target) continue;
    if (!(part.placement.at > 0))
      reading.error(place_of(*target, "at"),
                    fmt::format("the source is aimed at `{}`, which must stand behind it, not in its plane",
                                aimed->target),
                    "give it an `at` greater than zero");
    if (const auto* slit = std::get_if<Slit>(&part.part); slit && area_of(slit->opening) == 0)
      reading.error(place,
                    fmt::format("the source is aimed at `{}`, whose opening has no area", aimed->target),
                    "open the slit");
    const auto field = std::find_if(beamline.parts.begin(), beamline.parts.end(), [&](const PlacedPart& p) {
      return is_field(p.part) && p.placement.at < part.placement.at;
    });
    if (field != beamline.parts.end())
      reading.error(place,
                    fmt::format("the field `{}` begins at {}, before `{}` at {}: nothing may act before the "
                                "opening that the source is aimed at",
                                field->placement.name, metres(field->placement.at), aimed->target,
                                metres(part.placement.at)),
                    "aim at an opening before the first field, or use `direction: {kind: cone, ...}`");
  }
}

}  // namespace

void check_source(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  check_aim(beamline, root, nodes, reading);
}

}  // namespace rabiline
