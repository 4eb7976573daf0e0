#include "parts/mapped_field.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// Where along the beam a box of the map's frame begins and ends, seen from its origin.
std::pair<double, double> extent_along_beam(const FieldMap& map, const OwnFrame& frame) {
  double begin = 0, end = 0;
  const auto add = [&](const Vector3& axis, double low, double high) {
    begin += std::min(axis.y * low, axis.y * high);
    end += std::max(axis.y * low, axis.y * high);
  };
  const std::vector<MapAxis>& axes = map.axes();
  if (map.is_round()) {
    const double across = axes[0].end() * std::sqrt(std::max(0.0, 1 - frame.z.y * frame.z.y));
    begin -= across;
    end += across;
  } else {
    add(frame.x, axes[0].begin, axes[0].end());
    add(frame.y, axes[1].begin, axes[1].end());
  }
  add(frame.z, axes.back().begin, axes.back().end());
  return {begin, end};
}

}  // namespace

void contribute_map(const FieldMap& map, double scale, MapOutside outside, const MapMotion& motion,
                    const OwnFrame& frame, const Offset& offset, const Placement& place,
                    SectionBuilder& builder) {
  const auto [begin, end] = extent_along_beam(map, frame);
  if (place.at + end <= 0) return;
  ShapedTerm term =
      map.is_round() ? ShapedTerm(map.round_shape(scale, outside)) : ShapedTerm(map.shape(scale, outside));
  term.course = motion.course;
  const ShapedTerm here = placed(term, place_of(place.at, offset), frame);
  if (map.is_electric()) return builder.electric(std::max(0.0, place.at + begin), place.at + end, here);
  add_shaped(motion.clock, std::max(0.0, place.at + begin), place.at + end, here, builder);
}

void contribute(const MappedField& part, const Placement& place, SectionBuilder& builder) {
  const FieldMap& map = *part.map.map;
  builder.keep(part.map.map);
  contribute_map(map, part.scale, part.outside, {clock_of(part.oscillates)},
                 map.is_round() ? frame_along(part.direction, part.tilt) : turned_frame(part.tilt),
                 part.offset, place, builder);
}

std::vector<Fault> faults_of(const MappedField& part, const Placement& place) {
  if (!part.is_electric() || !part.oscillates) return {};
  return {{place.name, "oscillates",
           fmt::format("`{}` is the map of an electric field, and these stand still", place.name),
           "omit `oscillates`"}};
}

}  // namespace rabiline
