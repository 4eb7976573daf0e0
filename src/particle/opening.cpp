#include "particle/opening.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/portable_math.hpp"

namespace rabiline {

std::vector<Fault> faults_of(const Opening& opening, const std::string& subject, const std::string& key) {
  const auto* ring = std::get_if<Ring>(&opening);
  if (!ring || ring->inner_radius <= ring->outer_radius) return {};
  return {{subject, dotted_name(key, "inner_radius"),
           fmt::format("the ring begins at {}, outside of its end at {}",
                       pretty_quantity(ring->inner_radius, Dimension::length),
                       pretty_quantity(ring->outer_radius, Dimension::length)),
           "`inner_radius` is the smaller one"}};
}

std::vector<Fault> faults_of_size(const Face& face, const std::string& subject, const std::string& key,
                                  const std::string& whose) {
  std::vector<Fault> out;
  const auto check = [&](const char* side, double size) {
    if (!(size > 0))
      out.push_back({subject,
                     dotted_name(key, side),
                     fmt::format("the `{}` of {} must be greater than zero", side, whose),
                     {}});
  };
  if (const auto* disc = std::get_if<Disc>(&face)) {
    check("radius", disc->radius);
  } else {
    check("width", std::get<Rectangle>(face).width);
    check("height", std::get<Rectangle>(face).height);
  }
  return out;
}

double distance_from_axis(const Opening& opening, Offset offset, double roll) {
  if (const auto* disc = std::get_if<Disc>(&opening))
    return std::max(0.0, portable::hypot(offset.x, offset.z) - disc->radius);
  if (const auto* ring = std::get_if<Ring>(&opening)) {
    const double centre = portable::hypot(offset.x, offset.z);
    return std::max({0.0, centre - ring->outer_radius, ring->inner_radius - centre});
  }
  const auto& r = std::get<Rectangle>(opening);
  if (roll != 0)
    offset = {offset.x * portable::cos(roll) - offset.z * portable::sin(roll),
              offset.x * portable::sin(roll) + offset.z * portable::cos(roll)};
  return portable::hypot(std::max(0.0, std::abs(offset.x) - r.width / 2),
                         std::max(0.0, std::abs(offset.z) - r.height / 2));
}

}  // namespace rabiline
