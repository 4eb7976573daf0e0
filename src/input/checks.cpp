#include "input/checks.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

void check_names(const PartNodes& nodes, Reading& reading) {
  for (std::size_t i = 0; i < nodes.all().size(); ++i) {
    const Node& part = *nodes.all()[i];
    const std::string& name = PartNodes::name_of(part);
    const Place& place = place_of(part, "name");
    if (!is_well_formed(name))
      reading.error(
          place,
          fmt::format(
              "`{}` cannot be a part's name: a name is a letter, then letters, digits or `_`, at most 64",
              name),
          "`label` may hold any text for plots");
    else if (is_reserved(name))
      reading.error(
          place,
          fmt::format("a part cannot be called `{}`: the word means something else in files and results",
                      name),
          fmt::format("call it `{}_1`", name));
    for (std::size_t k = 0; k < i; ++k)
      if (PartNodes::name_of(*nodes.all()[k]) == name) {
        const Place& first = place_of(*nodes.all()[k], "name");
        const bool elsewhere = first.text != place.text;
        reading.error(place,
                      fmt::format("the name `{}` is taken by a part in {}line {}", name,
                                  elsewhere ? first.text->name + ", " : "", first.line),
                      "names must differ");
        break;
      }
  }
}

/// How far from the axis the nearest point of a hole or screen is.
double distance_from_axis(const Opening& opening, Offset offset, const Roll& tilt) {
  if (const auto* disc = std::get_if<Disc>(&opening))
    return std::max(0.0, std::hypot(offset.x, offset.z) - disc->radius);
  if (const auto* ring = std::get_if<Ring>(&opening)) {
    const double centre = std::hypot(offset.x, offset.z);
    return std::max({0.0, centre - ring->outer_radius, ring->inner_radius - centre});
  }
  const auto& r = std::get<Rectangle>(opening);
  if (tilt.y != 0)
    offset = {offset.x * std::cos(tilt.y) - offset.z * std::sin(tilt.y),
              offset.x * std::sin(tilt.y) + offset.z * std::cos(tilt.y)};
  return std::hypot(std::max(0.0, std::abs(offset.x) - r.width / 2),
                    std::max(0.0, std::abs(offset.z) - r.height / 2));
}

/// Of a spot without edge: its centre.
double farthest_point(const Source& source) {
  const double x = std::abs(source.offset.x), z = std::abs(source.offset.z);
  if (const auto* r = std::get_if<Rectangle>(&source.opening))
    return std::hypot(x + r->width / 2, z + r->height / 2);
  const auto* disc = std::get_if<Disc>(&source.opening);
  const auto* ring = std::get_if<Ring>(&source.opening);
  return std::hypot(x, z) + (disc ? disc->radius : ring ? ring->outer_radius : 0);
}

template <class Hole>
void check_ring(const Hole& opening, const Place& place, Reading& reading) {
  const auto* ring = std::get_if<Ring>(&opening);
  if (ring && ring->inner_radius > ring->outer_radius)
    reading.error(place,
                  fmt::format("the ring begins at {}, outside of its end at {}", metres(ring->inner_radius),
                              metres(ring->outer_radius)),
                  "`inner_radius` is the smaller one");
}
void check_openings(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const Entry* source = root.find("source");
  if (source && source->value.find("opening"))
    check_ring(beamline.source.opening, place_of(source->value.find("opening")->value, "inner_radius"),
               reading);
  for (const PlacedPart& part : beamline.parts)
    if (const auto* slit = std::get_if<Slit>(&part.part))
      check_ring(slit->opening, place_in(nodes, part, "inner_radius"), reading);
}

void check_chamber(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  if (!beamline.chamber || beamline.chamber->radius == 0) return;
  const double radius = beamline.chamber->radius;
  const double reach = farthest_point(beamline.source);
  if (reach >= radius)
    reading.error(
        root.find("source")->value.find("opening") ? root.find("source")->value.find("opening")->key_place
                                                   : root.find("source")->key_place,
        fmt::format("the source's opening reaches {} from the axis, into the wall of the chamber at {}",
                    metres(reach), metres(radius)),
        beamline.source.offset == Offset{}
            ? "make the opening smaller or the chamber wider"
            : "move the opening nearer to the axis, or make the chamber wider");
  for (const PlacedPart& part : beamline.parts) {
    double nearest = 0;
    if (const auto* slit = std::get_if<Slit>(&part.part))
      nearest = distance_from_axis(slit->opening, slit->offset, slit->tilt);
    if (const auto* screen = std::get_if<Detector>(&part.part))
      nearest = distance_from_axis(opening_of(screen->face), screen->offset, screen->tilt);
    if (const auto* monitor = std::get_if<Monitor>(&part.part))
      nearest = distance_from_axis(opening_of(monitor->face), monitor->offset, monitor->tilt);
    if (nearest >= radius)
      reading.error(
          place_in(nodes, part, "offset"),
          fmt::format("`{}` lies outside the chamber: it begins {} from the axis, and the wall is at {}",
                      part.placement.name, metres(nearest), metres(radius)),
          "reduce its offset or make the chamber wider");
  }
}

}  // namespace

bool is_well_formed(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && name.size() <= 64 && letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

bool is_reserved(std::string_view name) {
  static constexpr std::array words{// keys of the file
                                    "rabiline", "title", "geometry", "species", "law", "source", "chamber",
                                    "parts", "particles", "seed", "scan",
                                    // names in the results
                                    "entry", "fates", "simulation", "instrument", "sample", "user", "data",
                                    "definition", "program_name", "start_time", "end_time", "duration",
                                    "detected", "axes", "signal", "default"};
  return std::find(words.begin(), words.end(), name) != words.end();
}

void check_axis(const Axis& axis, const std::vector<Beamline>& points, Reading& reading) {
  check_scanned_tallies(axis, points, reading);
  for (const Beamline& point : points)
    if (point.source.rate != points.front().source.rate)
      return reading.error(
          axis.place,
          fmt::format("`{}` cannot be scanned: the source's `rate` is a factor of all results",
                      axis.parameter),
          "keep it in the file, and multiply");
  for (const Beamline& point : points)
    for (const PlacedPart& part : point.parts) {
      const auto* now = std::get_if<Detector>(&part.part);
      for (const PlacedPart& other : points.front().parts) {
        const auto* then = std::get_if<Detector>(&other.part);
        if (!now || !then || part.placement.name != other.placement.name || now->bins == then->bins) continue;
        return reading.error(axis.place,
                             fmt::format("`{}` cannot be scanned: all points fill the same histogram of `{}`",
                                         axis.parameter, part.placement.name),
                             "make one run for each number of bins");
      }
    }
}

void check_beamline(const Beamline& beamline, const Node& root, Reading& reading) {
  const PartNodes nodes(root);
  check_names(nodes, reading);
  check_openings(beamline, root, nodes, reading);
  check_detectors(beamline, root, nodes, reading);
  check_tallies(beamline, nodes, reading);
  check_source(beamline, root, nodes, reading);
  check_fields(beamline, nodes, reading);
  check_magnets(beamline, nodes, reading);
  check_atoms(beamline, root, nodes, reading);
  check_chamber(beamline, root, nodes, reading);
}

}  // namespace rabiline
