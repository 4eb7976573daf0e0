#include "beamline/scan.hpp"

#include <fmt/format.h>

namespace rabiline {

std::string value_at(const ScanAxis& axis, std::size_t i) {
  if (!axis.dimension) return axis.labels[i];
  const auto shown = [&](double value) { return pretty_quantity(value, *axis.dimension); };
  return shown(axis.values.front()) != shown(axis.values.back())
             ? shown(axis.values[i])
             : fmt::format("{:.12g} {}", axis.values[i], si_unit_of(*axis.dimension));
}

}  // namespace rabiline
