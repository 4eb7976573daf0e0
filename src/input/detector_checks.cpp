// Detectors that cannot stand together.
#include <cmath>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

/// A face that nothing can pass through or hit.
void check_sizes(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const auto check = [&](const Face& face, const Node* node, const std::string& whose) {
    if (!node) return;
    const auto* disc = std::get_if<Disc>(&face);
    const auto refuse = [&](std::string_view key) {
      reading.error(place_of(*node, key),
                    fmt::format("the `{}` of {} must be greater than zero", key, whose));
    };
    if (disc && disc->radius == 0) refuse("radius");
    if (!disc && std::get<Rectangle>(face).width == 0) refuse("width");
    if (!disc && std::get<Rectangle>(face).height == 0) refuse("height");
  };
  for (const PlacedPart& part : beamline.parts) {
    const Node* node = nodes.find(part.placement.name);
    const std::string name = fmt::format("`{}`", part.placement.name);
    if (const auto* monitor = std::get_if<Monitor>(&part.part)) check(monitor->face, node, name);
    const auto* detector = std::get_if<Detector>(&part.part);
    if (!detector || !node) continue;
    check(detector->face, node, name);
    if (detector->dead && node->find("dead"))
      check(detector->dead->face, &node->find("dead")->value, "the dead area of " + name);
  }
}

/// A screen as an outline in its plane.
struct Outline {
  double x, z, half_x, half_z, radius, cosine, sine;
};
Outline outline_of(const Detector& d) {
  const auto* disc = std::get_if<Disc>(&d.face);
  const Rectangle size = disc ? Rectangle{} : std::get<Rectangle>(d.face);
  return {d.offset.x,         d.offset.z,        size.width / 2, size.height / 2, disc ? disc->radius : 0,
          std::cos(d.tilt.y), std::sin(d.tilt.y)};
}
/// How far an outline reaches along a direction (x, z).
double reach(const Outline& o, double x, double z) {
  return o.radius + o.half_x * std::abs(x * o.cosine - z * o.sine) +
         o.half_z * std::abs(x * o.sine + z * o.cosine);
}
/// Whether a straight line lies between them: along one of their sides, or across the line from centre to
/// centre or from a corner to a centre.
bool are_apart(const Outline& a, const Outline& b) {
  const double dx = b.x - a.x, dz = b.z - a.z;
  const auto parts = [&](double x, double z) {
    const double length = std::hypot(x, z);
    return length > 0 &&
           std::abs(dx * x + dz * z) / length >=
               (1 - 1e-12) * (reach(a, x / length, z / length) + reach(b, x / length, z / length));
  };
  for (const Outline* o : {&a, &b})
    if (parts(o->cosine, -o->sine) || parts(o->sine, o->cosine)) return true;
  if (parts(dx, dz)) return true;
  for (const auto& [o, other] : {std::pair{&a, &b}, std::pair{&b, &a}})
    for (const double sx : {-1.0, 1.0})
      for (const double sz : {-1.0, 1.0}) {
        const double across = sx * o->half_x, up = sz * o->half_z;
        if (parts(other->x - o->x - across * o->cosine - up * o->sine,
                  other->z - o->z + across * o->sine - up * o->cosine))
          return true;
      }
  return false;
}

void check_coverage(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const Entry* parts = root.find("parts");
  if (!parts || !parts->value.is_sequence()) return;
  const auto& items = parts->value.items;
  if (std::none_of(items.begin(), items.end(),
                   [](const Node& n) { return PartNodes::kind_of(n) == Detector::kind; }))
    reading.error(
        parts->key_place,
        nodes.names({Monitor::kind}).empty()
            ? "there is no detector among the parts, so the experiment would measure nothing"
            : "there is no detector among the parts: monitors count beside one, and do not stand for it",
        "add `- {name: screen, kind: detector, at: 1.2 m, width: 4 mm, height: 4 mm, bins: [80, 80]}`");
  for (std::size_t i = 0; i < beamline.parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const PlacedPart &a = beamline.parts[k], &b = beamline.parts[i];
      const auto *first = std::get_if<Detector>(&a.part), *second = std::get_if<Detector>(&b.part);
      if (!first || !second || a.placement.at != b.placement.at) continue;
      if (!are_apart(outline_of(*first), outline_of(*second)))
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
  check_sizes(beamline, nodes, reading);
  check_coverage(beamline, root, nodes, reading);
}

}  // namespace rabiline
