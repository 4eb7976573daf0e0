// Deflecting magnets that cannot be as they are written.
#include <cmath>
#include <optional>

#include "input/check_nodes.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// What a part contributes as a magnet, if it is one.
std::optional<MagnetTerm> magnet_of(const PlacedPart& part) {
  if (!is_magnet(part.part)) return std::nullopt;
  SectionBuilder builder(Wall{});
  std::visit([&](const auto& any) { contribute(any, part.placement, builder); }, part.part);
  return std::get<MagnetTerm>(builder.build().planes.front().term);
}

/// Whether a particle on the beam's axis hits no wall.
bool axis_is_free(const MagnetTerm& magnet) {
  const double c = std::cos(magnet.tilt.y), s = std::sin(magnet.tilt.y);
  const Offset o = magnet.offset;
  return is_free<bool>(magnet.walls, s * o.z - c * o.x, magnet.shape.height - s * o.x - c * o.z);
}

void check_axis_in(const PlacedPart& part, const MagnetTerm& magnet, std::string_view walls,
                   std::string_view key, const PartNodes& nodes, Reading& reading) {
  if (axis_is_free(magnet)) return;
  reading.error(place_in(nodes, part, magnet.offset == Offset{} ? key : "offset"),
                fmt::format("the beam's axis meets the {} of `{}`", walls, part.placement.name),
                magnet.offset == Offset{} ? fmt::format("change `{}`, or make room for the beam", key)
                                          : std::string("make its offset smaller"));
}

void check_shape(const PlacedPart& part, const MagnetTerm& magnet, const PartNodes& nodes, Reading& reading) {
  const std::string& name = part.placement.name;
  if (const auto* gradient = std::get_if<GradientMagnet>(&part.part)) {
    if (std::abs(gradient->along.y) > 1e-9)
      reading.error(place_in(nodes, part, "along"),
                    fmt::format("the gradient of `{}` has a part along the beam", name),
                    "write `x` or `z`, or `[1, 0, 1]` for one between");
  } else if (const auto* wires = std::get_if<TwoWireMagnet>(&part.part)) {
    if (wires->wire_radius >= wires->half_distance)
      reading.error(place_in(nodes, part, "wire_radius"),
                    fmt::format("the wires of `{}` touch each other: their radius is {} and half of their "
                                "distance {}",
                                name, metres(wires->wire_radius), metres(wires->half_distance)),
                    "make them thinner, or `half_distance` larger");
    else
      check_axis_in(part, magnet, "wires", "beam_height", nodes, reading);
  } else if (const auto* iron = std::get_if<IronMagnet>(&part.part)) {
    if (iron->convex >= iron->concave)
      reading.error(
          place_in(nodes, part, "convex"),
          fmt::format("`{}` has no gap: its convex pole reaches up to {}, its concave one down to {}", name,
                      metres(iron->convex), metres(iron->concave)),
          "`convex` is the smaller height");
    else
      check_axis_in(part, magnet, "poles", "beam_height", nodes, reading);
  } else if (const auto* multipole = std::get_if<MultipoleMagnet>(&part.part)) {
    if (multipole->poles % 2 != 0)
      reading.error(
          place_in(nodes, part, "poles"),
          fmt::format("`{}` cannot have {} poles: north and south alternate", name, multipole->poles),
          "write an even number: 4 for a quadrupole, 6 for a sextupole");
    check_axis_in(part, magnet, "wall", "radius", nodes, reading);
  }
}

void check_charges(const Beamline& beamline, const PlacedPart& magnet, const PartNodes& nodes,
                   Reading& reading) {
  for (const Component& c : beamline.species)
    if (c.species.charge != 0)
      reading.error(
          place_in(nodes, magnet, "kind"),
          fmt::format(
              "`{}` cannot deflect `{}`, which has a charge: the Lorentz force would be larger by far",
              magnet.placement.name, c.species.name),
          "deflecting magnets are for neutral particles");
}

/// Parts may touch a magnet: 0.1 m + 0.2 m is more than 0.3 m, in binary digits.
void check_overlaps(const Beamline& beamline, const PlacedPart& magnet, const PartNodes& nodes,
                    Reading& reading) {
  constexpr double rounding = 1e-12;  // [m]
  for (const PlacedPart& part : beamline.parts) {
    const bool is_static = std::holds_alternative<UniformField>(part.part);
    const double begin = part.placement.at, end = end_of(part);
    const double magnet_begin = magnet.placement.at + rounding, magnet_end = end_of(magnet) - rounding;
    const bool overlaps =
        begin < end ? begin < magnet_end && end > magnet_begin : begin > magnet_begin && begin < magnet_end;
    if (&part == &magnet || is_static || !overlaps) continue;
    reading.error(place_in(nodes, part, "at"),
                  fmt::format("`{}` stands in the deflecting magnet `{}` ({} to {})", part.placement.name,
                              magnet.placement.name, metres(magnet.placement.at), metres(end_of(magnet))),
                  "move it out of the magnet");
  }
}

}  // namespace

/// Where a particle is deflected in one level, nothing else may act or ask about it.
void check_magnets(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const bool deflects = !std::holds_alternative<DoradoLaw>(beamline.law);
  for (const PlacedPart& part : beamline.parts) {
    const std::optional<MagnetTerm> magnet = magnet_of(part);
    if (!magnet) continue;
    check_shape(part, *magnet, nodes, reading);
    if (!deflects) continue;
    check_charges(beamline, part, nodes, reading);
    check_overlaps(beamline, part, nodes, reading);
  }
}

}  // namespace rabiline
