// Values to show in help, where one is missing or misread.
#include <utility>

#include "input/values.hpp"

namespace rabiline {

std::string_view value_in(std::string_view example, std::string_view key) {
  int depth = 0;
  for (std::size_t i = 0, begin = 0; i <= example.size(); ++i) {
    const char c = i < example.size() ? example[i] : ',';
    depth += c == '{' || c == '[' ? 1 : c == '}' || c == ']' ? -1 : 0;
    if (c != ',' || depth > 0) continue;
    const std::string_view item = example.substr(begin, i - begin);
    if (item.starts_with(key) && item.substr(key.size()).starts_with(": "))
      return item.substr(key.size() + 2);
    begin = i + 2;
  }
  return {};
}

std::string with_a_unit(const std::string& number, Dimension dimension) {
  switch (dimension) {
    case Dimension::angle:
      return fmt::format("write `{0} deg` or `{0} rad`", number);
    case Dimension::length:
      return fmt::format("write `{0} m`, `{0} cm` or `{0} mm`", number);
    case Dimension::magnetic_field:
      return fmt::format("write `{0} T`, `{0} mT` or `{0} uT`", number);
    case Dimension::frequency:
      return fmt::format("write `{0} Hz`, `{0} kHz` or `{0} MHz`", number);
    default:
      return fmt::format("write `{0} {1}` if {1} is meant", number, si_unit_of(dimension));
  }
}

std::string example_for(const Row& row) {
  if (!row.example.empty()) return std::string(row.example);
  // Sizes that a bench has, where the type alone would give an odd one or none.
  static constexpr std::pair<std::string_view, std::string_view> familiar[] = {
      {"at", "0.25 m"},
      {"length", "0.25 m"},
      {"radius", "20 mm"},
      {"amplitude", "0.3 uT"},
      {"alignment", "1"},
      {"sigma", "10 m/s"},
      {"charge", "0 e"},
      {"half_angle", "5 mrad"},
      {"name", "my_name"},
      {"target", "my_slit"},
      {"kappa", "1"},
      {"coupling", "2298.158 MHz"},
      {"g_J", "2.0023"},
      {"g_I", "-0.0004"},
      {"gyromagnetic_ratio", "16.5 MHz/T"},
      {"g_factor", "2"},
      {"weight", "1"},
      {"temperature", "300 K"},
      {"adiabatic_exponent", "1.6667"},
      {"speed_ratio", "10"},
      {"axis", "z"},
      {"degree", "0.9"},
      {"rate", "1e6 1/s"},
      {"values", "0.5"},
      {"background", "10 1/s"},
      {"species", "neutron"},
      {"parts", "[...]"},
      {"seed", "1"},
      {"detected_error", "0.1 %"},
      {"particles", "10000"},
      {"points", "21"},
      {"duration", "10 s"},
      {"turns", "5"},
      {"poles", "6"},
      {"pole_field", "1 T"},
      {"half_distance", "2 mm"},
      {"wire_radius", "1.5 mm"},
      {"beam_height", "2.4 mm"},
      {"convex", "2 mm"},
      {"concave", "3 mm"},
      {"parameter", "H0.frequency"}};
  for (const auto& [key, example] : familiar)
    if (row.key == key &&
        (row.dimension == Dimension::number || parse_quantity(example).dimension == row.dimension))
      return std::string(example);
  return std::string(example_of(row.dimension));
}

}  // namespace rabiline
