#include "parts/monitor.hpp"

#include <fmt/format.h>
#include <cmath>

#include "section/section_builder.hpp"

namespace rabiline {

double place_of_plane(const Monitor& monitor, const Placement& place, std::size_t plane) {
  if (plane == 0) return place.at;
  return std::lerp(place.at, place.at + monitor.length,
                   static_cast<double>(plane) / static_cast<double>(monitor.planes - 1));
}

void contribute(const Monitor& monitor, const Placement& place, SectionBuilder& builder) {
  for (std::size_t i = 0; i < monitor.planes; ++i)
    builder.plane(place_of_plane(monitor, place, i),
                  MonitorTerm{opening_of(monitor.face), monitor.offset, monitor.tilt, monitor.tallies,
                              static_cast<int>(i)});
}

std::vector<Fault> faults_of(const Monitor& monitor, const Placement& place) {
  std::vector<Fault> out = faults_of_size(monitor.face, place.name, "", fmt::format("`{}`", place.name));
  if (monitor.planes > 1 && monitor.length == 0)
    out.push_back({place.name, "planes",
                   fmt::format("`{}` has {} planes and no length to stand on", place.name, monitor.planes),
                   "write for example `length: 0.2 m`, from the first plane to the last"});
  if (monitor.planes == 1 && monitor.length > 0)
    out.push_back({place.name, "length", fmt::format("`{}` has a length and one plane only", place.name),
                   "write for example `planes: 101`, or omit `length`"});
  for (std::size_t i = 0; monitor.planes > 1 && i < monitor.tallies.size(); ++i)
    for (std::size_t k = 0; k < monitor.tallies[i].axes.size(); ++k)
      if (monitor.tallies[i].axes[k].quantity == Quantity::y)
        out.push_back({place.name, fmt::format("tallies[{}].axes[{}].quantity", i, k),
                       fmt::format("`{}` has {} planes, which are the first axis of its tallies, `y`",
                                   place.name, monitor.planes),
                       "omit this axis"});
  return out;
}

}  // namespace rabiline
