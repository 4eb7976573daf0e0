// Detectors that cannot stand together, or are not there.
#include <cmath>
#include "core/portable_math.hpp"

#include "rules/room.hpp"

namespace rabiline {
namespace {

/// A screen as an outline in its plane.
struct Outline {
  double x, z, half_x, half_z, radius, cosine, sine;
};
Outline outline_of(const Detector& d) {
  const auto* disc = std::get_if<Disc>(&d.face);
  const Rectangle size = disc ? Rectangle{} : std::get<Rectangle>(d.face);
  return {d.offset.x,
          d.offset.z,
          size.width / 2,
          size.height / 2,
          disc ? disc->radius : 0,
          portable::cos(d.tilt.y),
          portable::sin(d.tilt.y)};
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
    const double length = portable::hypot(x, z);
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

}  // namespace

void check_screens(const Beamline& beamline, Faults& out) {
  const auto& parts = beamline.parts;
  const bool monitors = !names_of_parts(beamline, [](const auto& p) { return monitor_in(p.part); }).empty();
  if (names_of_parts(beamline, [](const auto& p) { return detector_in(p.part); }).empty())
    out.push_back(
        {"", "parts",
         monitors ? "there is no detector among the parts: monitors count beside one, and do not stand for it"
                  : "there is no detector among the parts, so the experiment would measure nothing",
         "add `- {name: screen, kind: detector, at: 1.2 m, width: 4 mm, height: 4 mm, bins: [80, 80]}`"});
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Detector *first = detector_in(parts[k].part), *second = detector_in(parts[i].part);
      if (!first || !second || parts[k].placement.at != parts[i].placement.at) continue;
      if (!are_apart(outline_of(*first), outline_of(*second)))
        out.push_back(
            {parts[i].placement.name, "at",
             fmt::format(
                 "the detectors `{}` and `{}` cover each other at {}: which of them would catch a particle?",
                 parts[k].placement.name, parts[i].placement.name, metres(parts[i].placement.at)),
             "move one of them along the beam, or aside with `offset`"});
    }
}

}  // namespace rabiline
