// Walls that cannot stand together, and what lies outside of them.
#include <algorithm>
#include <cmath>
#include <optional>

#include "core/portable_math.hpp"
#include "plan/beam.hpp"
#include "rules/room.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

struct Tube {
  const PlacedPart* part;
  double begin, end, radius;
  Offset offset;
};
std::vector<Tube> tubes_of(const Beamline& beamline) {
  std::vector<Tube> tubes;
  for (const PlacedPart& part : beamline.parts)
    std::visit(
        [&](const auto& p) {
          const double begin = part.placement.at, end = end_of(part);
          if constexpr (requires { p.bore; })
            if (p.bore) tubes.push_back({&part, begin, end, p.bore->radius, p.offset});
          if constexpr (requires { Face{p.opening}; })
            if (const auto* disc = std::get_if<Disc>(&p.opening))
              tubes.push_back({&part, begin, end, disc->radius, p.offset});
        },
        part.part);
  return tubes;
}

/// The wall at one place is the narrowest; two of them with different centres would need both.
void check_bores(const Beamline& beamline, Faults& out) {
  const std::vector<Tube> tubes = tubes_of(beamline);
  for (std::size_t i = 0; i < tubes.size(); ++i) {
    const Tube& b = tubes[i];
    const std::string& name = b.part->placement.name;
    for (std::size_t k = 0; k < i; ++k) {
      const Tube& a = tubes[k];
      if (a.begin < b.end && b.begin < a.end && a.offset != b.offset)
        out.push_back(
            {name, "offset",
             fmt::format("the walls of `{}` and `{}` overlap along the beam and have different centres",
                         a.part->placement.name, name),
             "give both the same `offset`, or move one of them"});
    }
    if (beamline.chamber && b.offset != Offset{} &&
        portable::hypot(b.offset.x, b.offset.z) + b.radius > beamline.chamber->radius)
      out.push_back({name, "offset",
                     fmt::format("the wall of `{}` reaches out of the chamber, whose radius is {}", name,
                                 metres(beamline.chamber->radius)),
                     "make its bore narrower, or its offset smaller"});
  }
}

/// Of a spot without edge: its centre.
double farthest_point(const Source& source) {
  const double x = std::abs(source.offset.x), z = std::abs(source.offset.z);
  if (const auto* r = std::get_if<Rectangle>(&source.opening))
    return portable::hypot(x + r->width / 2, z + r->height / 2);
  const auto* disc = std::get_if<Disc>(&source.opening);
  const auto* ring = std::get_if<Ring>(&source.opening);
  return portable::hypot(x, z) + (disc ? disc->radius : ring ? ring->outer_radius : 0);
}

void check_chamber(const Beamline& beamline, Faults& out) {
  if (!beamline.chamber) return;
  const double radius = beamline.chamber->radius;
  const double reach = farthest_point(beamline.source);
  if (reach >= radius)
    out.push_back(
        {"source", "opening",
         fmt::format("the source's opening reaches {} from the axis, into the wall of the chamber at {}",
                     metres(reach), metres(radius)),
         beamline.source.offset == Offset{}
             ? "make the opening smaller or the chamber wider"
             : "move the opening nearer to the axis, or make the chamber wider"});
  for (const PlacedPart& part : beamline.parts) {
    const std::optional<Across> across = across_of(part.part);
    const double nearest = across ? distance_from_axis(across->opening, across->offset, across->tilt.y) : 0;
    if (nearest >= radius)
      out.push_back(
          {part.placement.name, "offset",
           fmt::format("`{}` lies outside the chamber: it begins {} from the axis, and the wall is at {}",
                       part.placement.name, metres(nearest), metres(radius)),
           "reduce its offset or make the chamber wider"});
  }
}

/// What of a magnet stands around its gap, and the key that moves it; nothing of other parts.
struct PoleWalls {
  std::string_view walls, key;
};
PoleWalls walls_of(const Part& part) {
  if (std::holds_alternative<TwoWireMagnet>(part)) return {"wires", "beam_height"};
  if (std::holds_alternative<IronMagnet>(part)) return {"poles", "beam_height"};
  if (std::holds_alternative<MultipoleMagnet>(part)) return {"wall", "radius"};
  return {};
}

/// A magnet whose walls stand where the source looks.
void check_poles(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const PoleWalls own = walls_of(part.part);
    if (own.walls.empty() || !faults_of(part).empty()) continue;
    SectionBuilder builder(Wall{});
    std::visit(
        [&](auto any) {
          if constexpr (requires { any.fringe; }) any.fringe = {};
          contribute(any, part.placement, builder);
        },
        part.part);
    const Sections sections = builder.build();
    const auto magnet = std::get<MagnetTerm>(sections.planes.front().term);
    const Offset beam = axis_of_beam(beamline.source, (part.placement.at + magnet.end) / 2);
    const double c = portable::cos(magnet.tilt.y), s = portable::sin(magnet.tilt.y);
    const double x = beam.x - magnet.offset.x, z = beam.z - magnet.offset.z;
    if (is_free<bool>(magnet.walls, c * x - s * z, magnet.shape.height + s * x + c * z)) continue;
    const bool centred = x == 0 && z == 0;
    out.push_back({part.placement.name, centred ? std::string(own.key) : "offset",
                   fmt::format("the beam's axis meets the {} of `{}`", own.walls, part.placement.name),
                   centred            ? fmt::format("change `{}`, or make room for the beam", own.key)
                   : beam == Offset{} ? "make its offset smaller"
                                      : "bring it nearer to the beam by its offset"});
  }
}

}  // namespace

void check_walls(const Beamline& beamline, Faults& out) {
  check_bores(beamline, out);
  check_chamber(beamline, out);
  check_poles(beamline, out);
}

}  // namespace rabiline
