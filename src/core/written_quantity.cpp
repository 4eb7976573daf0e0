// Quantities as they are written for people.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/portable_math.hpp"
#include "core/units.hpp"

namespace rabiline {

std::string write_quantity(double si_value, Dimension d) {
  const std::string_view unit = si_unit_of(d);
  return unit.empty() ? fmt::format("{}", si_value) : fmt::format("{} {}", si_value, unit);
}

std::string pretty_quantity(double si_value, Dimension d) {
  // The symbols a physicist would choose from, largest first; the first that leaves one digit before the
  // point.
  static constexpr std::string_view choices_of[] = {"",
                                                    "km|m|mm|um|nm",
                                                    "s|ms|us|ns",
                                                    "km/s|m/s|mm/s",
                                                    "kg|g|u",
                                                    "C|e",
                                                    "T|mT|uT|nT|pT",
                                                    "THz|GHz|MHz|kHz|Hz|mHz",
                                                    "rad|mrad|urad|nrad",
                                                    "GHz/T|MHz/T|kHz/T|Hz/T",
                                                    "K|mK|uK",
                                                    "MeV|keV|eV|meV|ueV|neV",
                                                    "1/s",
                                                    "T/m|mT/m",
                                                    "kA|A|mA",
                                                    "kN m|N m|mN m|uN m",
                                                    "MV/m|kV/m|V/m",
                                                    "m^2|cm^2|mm^2|nm^2|angstrom^2",
                                                    "1/cm^3|1/m^3",
                                                    "kPa|Pa|mPa|uPa",
                                                    "m/s^2|cm/s^2",
                                                    "rad/mm|rad/m|mrad/m",
                                                    "1/mm|1/m",
                                                    "e cm"};
  static_assert(std::size(choices_of) == static_cast<std::size_t>(last_dimension) + 1);
  std::string_view list = choices_of[static_cast<std::size_t>(d)];
  const auto is_a_choice = [choices = fmt::format("|{}|", list)](std::string_view symbol) {
    return choices.find(fmt::format("|{}|", symbol)) != std::string::npos;
  };
  if (list.empty() || !std::isfinite(si_value)) return fmt::format("{:.4g}", si_value);
  if (si_value == 0) return fmt::format("0 {}", si_unit_of(d));
  const UnitSymbol* unit = nullptr;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find('|'), list.size());
    unit = &*std::ranges::find(unit_table(), list.substr(0, end), &UnitSymbol::symbol);
    list.remove_prefix(std::min(end + 1, list.size()));
    // 0.99995 is what four digits round up to one.
    if (std::abs(si_value) >= 0.99995 * unit->factor) break;
  }
  // What would need an exponent beside the smallest prefix has it beside the unit itself.
  if (std::abs(si_value) < 0.99995e-3 * unit->factor && is_a_choice(si_unit_of(d)))
    return fmt::format("{:.4g} {}", si_value, si_unit_of(d));
  return fmt::format("{:.4g} {}", si_value / unit->factor, unit->symbol);
}

std::string write_measured(double value, double uncertainty) {
  if (!(uncertainty > 0)) return fmt::format("{:.9g}", value);
  // 0.0995 has the two digits 10: the exponent is that of the rounded number.
  const std::string rounded = fmt::format("{:.1e}", uncertainty);
  const int decimals = std::max(0, 1 - std::stoi(rounded.substr(rounded.find('e') + 1)));
  return fmt::format("{:.{}f}({:.0f})", value, decimals, uncertainty * portable::pow(10, decimals));
}

}  // namespace rabiline
