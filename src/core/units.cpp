#include "core/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <iterator>

#include "core/constants.hpp"
#include "core/diagnostics.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

using constants::two_pi;

struct DimensionRow {
  Dimension dimension;
  std::string_view name, example, si_unit;
};
constexpr std::array dimension_rows{
    DimensionRow{Dimension::number, "pure number", "0.5", ""},
    DimensionRow{Dimension::length, "length", "0.2 mm", "m"},
    DimensionRow{Dimension::time, "time", "10 us", "s"},
    DimensionRow{Dimension::speed, "speed", "1000 m/s", "m/s"},
    DimensionRow{Dimension::mass, "mass", "7.016 u", "kg"},
    DimensionRow{Dimension::charge, "charge", "1 e", "C"},
    DimensionRow{Dimension::magnetic_field, "magnetic field", "10 mT", "T"},
    DimensionRow{Dimension::frequency, "frequency", "291.6 kHz", "Hz"},
    DimensionRow{Dimension::angle, "angle", "30 deg", "rad"},
    DimensionRow{Dimension::gyromagnetic, "gyromagnetic ratio", "16.5 MHz/T", "rad/s/T"},
    DimensionRow{Dimension::temperature, "temperature", "300 K", "K"},
    DimensionRow{Dimension::energy, "energy", "25 meV", "J"},
    DimensionRow{Dimension::rate, "rate", "1e6 1/s", "1/s"},
    DimensionRow{Dimension::field_gradient, "field gradient", "1000 T/m", "T/m"},
    DimensionRow{Dimension::current, "current", "100 A", "A"},
    DimensionRow{Dimension::torque, "torque", "0.5 N m", "N m"},
    DimensionRow{Dimension::electric_field, "electric field", "10 kV/m", "V/m"},
};
const DimensionRow& row_of(Dimension d) { return dimension_rows[static_cast<std::size_t>(d)]; }

/// How far a decimal prefix moves the point, or nothing where the factor is no power of ten.
std::optional<int> power_of_ten(double factor) {
  static constexpr std::array powers{1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4,
                                     1e-3,  1e-2,  1e-1,  1e0,  1e1,  1e2,  1e3,  1e4,  1e5,
                                     1e6,   1e7,   1e8,   1e9,  1e10, 1e11, 1e12};
  for (std::size_t i = 0; i < powers.size(); ++i)
    if (powers[i] == factor) return static_cast<int>(i) - 12;
  return std::nullopt;
}

bool is_digit(char c) { return c >= '0' && c <= '9'; }
bool is_blank(char c) { return c == ' ' || c == '\t'; }

/// A decimal number taken apart; nothing is rounded before the unit is known.
struct Decimal {
  std::string mantissa;  // sign, digits, point
  long exponent = 0;
  bool is_zero = true;
};

/// Takes the decimal number that `text` begins with off its front; nothing where there is none.
std::optional<Decimal> take_decimal(std::string_view& text) {
  Decimal number;
  std::size_t i = 0;
  if (i < text.size() && (text[i] == '+' || text[i] == '-')) {
    if (text[i] == '-') number.mantissa = "-";
    ++i;
  }
  std::size_t digits = 0, points = 0;
  for (; i < text.size() && (is_digit(text[i]) || (text[i] == '.' && points == 0)); ++i) {
    if (text[i] == '.')
      ++points;
    else {
      ++digits;
      if (text[i] != '0') number.is_zero = false;
    }
    number.mantissa += text[i];
  }
  if (digits == 0) return std::nullopt;
  if (i < text.size() && (text[i] == 'e' || text[i] == 'E')) {
    std::size_t j = i + 1;
    const bool negative = j < text.size() && text[j] == '-';
    if (j < text.size() && (text[j] == '-' || text[j] == '+')) ++j;
    if (j < text.size() && is_digit(text[j])) {
      for (; j < text.size() && is_digit(text[j]); ++j)
        if (number.exponent < 100000) number.exponent = 10 * number.exponent + (text[j] - '0');
      if (negative) number.exponent = -number.exponent;
      i = j;
    }
  }
  text.remove_prefix(i);
  return number;
}

std::string lower(std::string_view s) {
  std::string out(s);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

std::string suggest_unit(std::string_view symbol, std::optional<Dimension> wanted) {
  const bool dimension_known = wanted && *wanted != Dimension::number;
  if (symbol.starts_with("\u00b0C") || symbol.starts_with("\u00b0F") || symbol == "degC" || symbol == "degF")
    return "temperatures are absolute: write them in kelvin, like `300 K`";
  std::string same_letters;
  std::vector<std::string> candidates;
  for (const UnitSymbol& unit : unit_table()) {
    if (dimension_known && unit.dimension != *wanted) continue;
    candidates.emplace_back(unit.symbol);
    if (lower(unit.symbol) == lower(symbol))
      same_letters += fmt::format("{}`{}`", same_letters.empty() ? "" : " or ", unit.symbol);
  }
  if (!same_letters.empty())
    return fmt::format("upper and lower case differ in units: write {}", same_letters);
  const std::string near = closest(symbol, candidates);
  if (!near.empty()) return fmt::format("did you mean `{}`?", near);
  if (!dimension_known) return {};
  return fmt::format("write it like `{}`", example_of(*wanted));
}

const UnitSymbol* find_unit(std::string_view symbol) {
  for (const UnitSymbol& unit : unit_table())
    if (unit.symbol == symbol) return &unit;
  return nullptr;
}

/// Rounds once, to the nearest double of the decimal number with its prefix applied.
double evaluate(Decimal number, double factor) {
  const std::optional<int> shift = power_of_ten(factor);
  const std::string digits = fmt::format("{}e{}", number.mantissa, number.exponent + shift.value_or(0));
  double value = 0;
  const auto end = digits.data() + digits.size();
  const auto [stop, error] = std::from_chars(digits.data(), end, value);
  if (error == std::errc::result_out_of_range) value = number.exponent > 0 ? HUGE_VAL : 0.0;
  return shift ? value : value * factor;
}

ParsedQuantity failure(std::string error, std::string suggestion = {}) {
  return {0, Dimension::number, std::move(error), std::move(suggestion)};
}

}  // namespace

std::string_view name_of(Dimension d) { return row_of(d).name; }
std::string_view example_of(Dimension d) { return row_of(d).example; }
std::string_view si_unit_of(Dimension d) { return row_of(d).si_unit; }

const std::vector<UnitSymbol>& unit_table() {
  using enum Dimension;
  static const std::vector<UnitSymbol> table{
      {"m", length, 1},
      {"km", length, 1e3},
      {"dm", length, 1e-1},
      {"cm", length, 1e-2},
      {"mm", length, 1e-3},
      {"um", length, 1e-6},
      {"\u00b5m", length, 1e-6},
      {"\u03bcm", length, 1e-6},
      {"nm", length, 1e-9},
      {"pm", length, 1e-12},
      {"angstrom", length, 1e-10},
      {"\u00c5", length, 1e-10},  // the letter
      {"\u212b", length, 1e-10},  // the sign of the unit
      {"s", time, 1},
      {"ms", time, 1e-3},
      {"us", time, 1e-6},
      {"\u00b5s", time, 1e-6},
      {"\u03bcs", time, 1e-6},
      {"ns", time, 1e-9},
      {"min", time, 60},
      {"h", time, 3600},
      {"m/s", speed, 1},
      {"km/s", speed, 1e3},
      {"cm/s", speed, 1e-2},
      {"mm/s", speed, 1e-3},
      {"kg", mass, 1},
      {"g", mass, 1e-3},
      {"u", mass, constants::atomic_mass},
      {"C", charge, 1},
      {"e", charge, constants::elementary_charge},
      {"T", magnetic_field, 1},
      {"mT", magnetic_field, 1e-3},
      {"uT", magnetic_field, 1e-6},
      {"\u00b5T", magnetic_field, 1e-6},
      {"\u03bcT", magnetic_field, 1e-6},
      {"nT", magnetic_field, 1e-9},
      {"pT", magnetic_field, 1e-12},
      {"G", magnetic_field, 1e-4},
      {"kG", magnetic_field, 1e-1},
      {"mG", magnetic_field, 1e-7},
      {"Hz", frequency, 1},
      {"mHz", frequency, 1e-3},
      {"kHz", frequency, 1e3},
      {"MHz", frequency, 1e6},
      {"GHz", frequency, 1e9},
      {"THz", frequency, 1e12},
      {"rad", angle, 1},
      {"mrad", angle, 1e-3},
      {"urad", angle, 1e-6},
      {"\u00b5rad", angle, 1e-6},
      {"\u03bcrad", angle, 1e-6},
      {"nrad", angle, 1e-9},
      {"deg", angle, two_pi / 360},
      {"\u00b0", angle, two_pi / 360},
      {"rad/s/T", gyromagnetic, 1},
      {"Hz/T", gyromagnetic, two_pi},
      {"kHz/T", gyromagnetic, two_pi * 1e3},
      {"MHz/T", gyromagnetic, two_pi * 1e6},
      {"GHz/T", gyromagnetic, two_pi * 1e9},
      {"Hz/G", gyromagnetic, two_pi * 1e4},
      {"kHz/G", gyromagnetic, two_pi * 1e7},
      {"MHz/G", gyromagnetic, two_pi * 1e10},
      {"K", temperature, 1},
      {"mK", temperature, 1e-3},
      {"uK", temperature, 1e-6},
      {"\u00b5K", temperature, 1e-6},
      {"\u03bcK", temperature, 1e-6},
      {"kK", temperature, 1e3},
      {"J", energy, 1},
      {"eV", energy, constants::elementary_charge},
      {"meV", energy, constants::elementary_charge * 1e-3},
      {"ueV", energy, constants::elementary_charge * 1e-6},
      {"\u00b5eV", energy, constants::elementary_charge * 1e-6},
      {"\u03bceV", energy, constants::elementary_charge * 1e-6},
      {"neV", energy, constants::elementary_charge * 1e-9},
      {"keV", energy, constants::elementary_charge * 1e3},
      {"MeV", energy, constants::elementary_charge * 1e6},
      {"1/s", rate, 1},
      {"/s", rate, 1},
      {"1/min", rate, 1.0 / 60},
      {"/min", rate, 1.0 / 60},
      {"1/h", rate, 1.0 / 3600},
      {"/h", rate, 1.0 / 3600},
      {"T/m", field_gradient, 1},
      {"T/cm", field_gradient, 1e2},
      {"T/mm", field_gradient, 1e3},
      {"mT/m", field_gradient, 1e-3},
      {"G/cm", field_gradient, 1e-2},
      {"kG/cm", field_gradient, 1e1},
      {"A", current, 1},
      {"mA", current, 1e-3},
      {"kA", current, 1e3},
      {"N m", torque, 1},
      {"Nm", torque, 1},
      {"kN m", torque, 1e3},
      {"mN m", torque, 1e-3},
      {"uN m", torque, 1e-6},
      {"V/m", electric_field, 1},
      {"kV/m", electric_field, 1e3},
      {"MV/m", electric_field, 1e6},
      {"V/cm", electric_field, 1e2},
      {"kV/cm", electric_field, 1e5},
  };
  return table;
}

ParsedQuantity parse_quantity(std::string_view text, std::optional<Dimension> wanted) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  std::string_view rest = text;
  const std::optional<Decimal> number = take_decimal(rest);
  if (!number) return failure("is not a number");
  if (number->mantissa.size() > 60) return failure("has too many digits");
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);

  const UnitSymbol* unit = rest.empty() ? nullptr : find_unit(rest);
  if (!rest.empty() && !unit) {
    const bool number_goes_on = rest.find_first_of("0123456789._,+-") != rest.npos;
    if (number_goes_on || rest.size() > 16)
      return failure("is not a number",
                     wanted == Dimension::number
                         ? "write digits with a point, such as `0.5`"
                         : "write digits with a point and a power of ten, then the unit: `1.5e-3 m`");
    return failure(fmt::format("has the unknown unit `{}`", rest), suggest_unit(rest, wanted));
  }

  ParsedQuantity result{
      evaluate(*number, unit ? unit->factor : 1), unit ? unit->dimension : Dimension::number, {}, {}};
  if (!std::isfinite(result.value)) return failure("is too large for a number");
  if (result.value == 0 && !number->is_zero)
    return failure("is too small for a number", "write `0` if zero is meant");
  return result;
}

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
                                                    "MV/m|kV/m|V/m"};
  static_assert(std::size(choices_of) == static_cast<std::size_t>(last_dimension) + 1);
  std::string_view list = choices_of[static_cast<std::size_t>(d)];
  if (list.empty() || !std::isfinite(si_value)) return fmt::format("{:.4g}", si_value);
  if (si_value == 0) return fmt::format("0 {}", si_unit_of(d));
  const UnitSymbol* unit = nullptr;
  while (!list.empty()) {
    const std::size_t end = std::min(list.find('|'), list.size());
    unit = find_unit(list.substr(0, end));
    list.remove_prefix(std::min(end + 1, list.size()));
    // 0.99995 is what four digits round up to one.
    if (std::abs(si_value) >= 0.99995 * unit->factor) break;
  }
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
