#include "beamline/scan.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace rabiline {

std::string value_at(const ScanAxis& axis, std::size_t i) {
  if (!axis.dimension) return axis.labels[i];
  if (axis.unit.empty()) return fmt::format("{:.12g}", axis.values[i]);
  const auto unit = std::ranges::find(unit_table(), axis.unit, &UnitSymbol::symbol);
  return fmt::format("{:.12g} {}", axis.values[i] / unit->factor, axis.unit);
}

}  // namespace rabiline
