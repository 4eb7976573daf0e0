#include "core/units.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <utility>

#include "core/constants.hpp"
#include "core/diagnostics.hpp"
#include "core/spelling.hpp"
#include "core/text.hpp"

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
    DimensionRow{Dimension::area, "area", "100 angstrom^2", "m^2"},
    DimensionRow{Dimension::number_density, "number density", "1e12 1/cm^3", "1/m^3"},
    DimensionRow{Dimension::pressure, "pressure", "1 mPa", "Pa"},
    DimensionRow{Dimension::acceleration, "acceleration", "9.81 m/s^2", "m/s^2"},
    DimensionRow{Dimension::angle_per_length, "angle per length", "5 deg/mm", "rad/m"},
    DimensionRow{Dimension::per_length, "growth per length", "0.1 1/mm", "1/m"},
    DimensionRow{Dimension::electric_dipole, "electric dipole moment", "1e-26 e cm", "C m"},
};
const DimensionRow& row_of(Dimension d) { return dimension_rows[static_cast<std::size_t>(d)]; }

constexpr int least_power = 12;  // 1e-12
constexpr std::array powers_of_ten{1e-12, 1e-11, 1e-10, 1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4,
                                   1e-3,  1e-2,  1e-1,  1e0,  1e1,  1e2,  1e3,  1e4,  1e5,
                                   1e6,   1e7,   1e8,   1e9,  1e10, 1e11, 1e12};

/// How far a factor moves the decimal point, or nothing where it is no power of ten.
std::optional<int> power_of_ten(double factor) {
  for (std::size_t i = 0; i < powers_of_ten.size(); ++i)
    if (powers_of_ten[i] == factor) return static_cast<int>(i) - least_power;
  return std::nullopt;
}

constexpr int power_of(char prefix) {
  constexpr std::string_view prefixes = "pnumcd-kMGT";
  constexpr std::array powers{-12, -9, -6, -3, -2, -1, 0, 3, 6, 9, 12};
  return powers[prefixes.find(prefix)];
}

/// A unit with the prefixes that it is written with; '-': with none, 'u': also with both characters for
/// micro. One of it is factor 10^exponent in SI.
struct UnitRow {
  Dimension dimension;
  std::string_view symbol, prefixes;
  double factor = 1;
  int exponent = 0;
};
constexpr std::array unit_rows{
    UnitRow{Dimension::number, "%", "-", 1, -2},
    UnitRow{Dimension::length, "m", "-kdcmunp"},
    UnitRow{Dimension::length, "angstrom", "-", 1, -10},
    UnitRow{Dimension::length, "\u00c5", "-", 1, -10},  // the letter
    UnitRow{Dimension::length, "\u212b", "-", 1, -10},  // the sign of the unit
    UnitRow{Dimension::time, "s", "-mun"},
    UnitRow{Dimension::time, "min", "-", 60},
    UnitRow{Dimension::time, "h", "-", 3600},
    UnitRow{Dimension::speed, "m/s", "-kcmun"},
    UnitRow{Dimension::mass, "g", "k-", 1, -3},
    UnitRow{Dimension::mass, "u", "-", constants::atomic_mass},
    UnitRow{Dimension::charge, "C", "-"},
    UnitRow{Dimension::charge, "e", "-", constants::elementary_charge},
    UnitRow{Dimension::magnetic_field, "T", "-munp"},
    UnitRow{Dimension::magnetic_field, "G", "-km", 1, -4},
    UnitRow{Dimension::frequency, "Hz", "-mkMGT"},
    UnitRow{Dimension::angle, "rad", "-mun"},
    UnitRow{Dimension::angle, "deg", "-", two_pi / 360},
    UnitRow{Dimension::angle, "\u00b0", "-", two_pi / 360},
    UnitRow{Dimension::gyromagnetic, "rad/s/T", "-"},
    UnitRow{Dimension::gyromagnetic, "Hz/T", "-kMG", two_pi},
    UnitRow{Dimension::gyromagnetic, "Hz/G", "-kM", two_pi, 4},
    UnitRow{Dimension::temperature, "K", "-muk"},
    UnitRow{Dimension::energy, "J", "-"},
    UnitRow{Dimension::energy, "eV", "-munkM", constants::elementary_charge},
    UnitRow{Dimension::rate, "1/s", "-"},
    UnitRow{Dimension::rate, "/s", "-"},
    UnitRow{Dimension::rate, "1/min", "-", 1.0 / 60},
    UnitRow{Dimension::rate, "/min", "-", 1.0 / 60},
    UnitRow{Dimension::rate, "1/h", "-", 1.0 / 3600},
    UnitRow{Dimension::rate, "/h", "-", 1.0 / 3600},
    UnitRow{Dimension::field_gradient, "T/m", "-munk"},
    UnitRow{Dimension::field_gradient, "T/cm", "-mu", 1, 2},
    UnitRow{Dimension::field_gradient, "T/mm", "-mu", 1, 3},
    UnitRow{Dimension::field_gradient, "G/cm", "-kmu", 1, -2},
    UnitRow{Dimension::current, "A", "-munk"},
    UnitRow{Dimension::torque, "N m", "-kmu"},
    UnitRow{Dimension::torque, "Nm", "-"},
    UnitRow{Dimension::electric_field, "V/m", "-mkM"},
    UnitRow{Dimension::electric_field, "V/cm", "-k", 1, 2},
    UnitRow{Dimension::area, "m^2", "-"},
    UnitRow{Dimension::area, "cm^2", "-", 1, -4},
    UnitRow{Dimension::area, "mm^2", "-", 1, -6},
    UnitRow{Dimension::area, "um^2", "-", 1, -12},
    UnitRow{Dimension::area, "nm^2", "-", 1e-18},
    UnitRow{Dimension::area, "angstrom^2", "-", 1e-20},
    UnitRow{Dimension::area, "barn", "-", 1e-28},
    UnitRow{Dimension::number_density, "1/m^3", "-"},
    UnitRow{Dimension::number_density, "/m^3", "-"},
    UnitRow{Dimension::number_density, "1/cm^3", "-", 1, 6},
    UnitRow{Dimension::number_density, "/cm^3", "-", 1, 6},
    UnitRow{Dimension::pressure, "Pa", "-umk"},
    UnitRow{Dimension::pressure, "hPa", "-", 1, 2},
    UnitRow{Dimension::pressure, "bar", "-", 1, 5},
    UnitRow{Dimension::pressure, "mbar", "-", 1, 2},
    UnitRow{Dimension::acceleration, "m/s^2", "-"},
    UnitRow{Dimension::acceleration, "cm/s^2", "-", 1, -2},
    UnitRow{Dimension::pressure, "Torr", "-m", 101325.0 / 760},
    UnitRow{Dimension::angle_per_length, "rad/m", "-mu"},
    UnitRow{Dimension::angle_per_length, "rad/mm", "-mu", 1, 3},
    UnitRow{Dimension::angle_per_length, "deg/m", "-", two_pi / 360},
    UnitRow{Dimension::angle_per_length, "deg/cm", "-", 100 * (two_pi / 360)},
    UnitRow{Dimension::angle_per_length, "deg/mm", "-", 1000 * (two_pi / 360)},
    UnitRow{Dimension::per_length, "1/m", "-"},
    UnitRow{Dimension::per_length, "1/cm", "-", 1, 2},
    UnitRow{Dimension::per_length, "1/mm", "-", 1, 3},
    UnitRow{Dimension::per_length, "%/m", "-", 1, -2},
    UnitRow{Dimension::per_length, "%/cm", "-"},
    UnitRow{Dimension::per_length, "%/mm", "-", 1, 1},
    UnitRow{Dimension::electric_dipole, "C m", "-"},
    UnitRow{Dimension::electric_dipole, "e cm", "-", 0.01 * constants::elementary_charge},
};

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

const UnitSymbol* find_unit(std::string_view symbol) {
  for (const UnitSymbol& unit : unit_table())
    if (unit.symbol == symbol) return &unit;
  return nullptr;
}

/// A prefix before a unit that does not take it is a power of ten: "1e-6 T/m" for 1 uT/m.
std::string without_prefix(const Decimal& number, std::string_view symbol, std::optional<Dimension> wanted) {
  static constexpr std::string_view sign_micro = "\u00b5", prefixes = "pnumckMGT";
  const bool has_sign = symbol.starts_with(sign_micro);
  const char prefix = has_sign ? 'u' : symbol.front();
  if (prefixes.find(prefix) == prefixes.npos) return {};
  const UnitSymbol* unit = find_unit(symbol.substr(has_sign ? sign_micro.size() : 1));
  if (!unit || unit->symbol != row_of(unit->dimension).si_unit ||
      unit->dimension != wanted.value_or(unit->dimension))
    return {};
  return fmt::format("`{}e{} {}`", number.mantissa, number.exponent + power_of(prefix), unit->symbol);
}

/// Units, and prefixes, that people write out, and how they are written here; empty where it is none.
std::string written_out(std::string_view symbol) {
  static constexpr std::array<std::string_view, 14> names{"gauss",  "tesla",  "kelvin", "hertz",  "metre",
                                                          "meter",  "second", "ampere", "degree", "radian",
                                                          "micron", "amu",    "da",     "dalton"};
  static constexpr std::array<std::string_view, 14> units{"G", "T",   "K",   "Hz", "m", "m", "s",
                                                          "A", "deg", "rad", "um", "u", "u", "u"};
  static constexpr std::array<std::string_view, 7> words{"nano",  "micro", "mu",  "milli",
                                                         "centi", "kilo",  "mega"};
  static constexpr std::string_view prefixes = "nuumckM";
  const std::string word = lower(symbol);
  for (std::size_t i = 0; i < names.size(); ++i)
    if (word == names[i] || word == fmt::format("{}s", names[i])) return std::string(units[i]);
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (!word.starts_with(words[i]) || word.size() == words[i].size()) continue;
    const std::string_view rest = symbol.substr(words[i].size());
    const std::string unit = find_unit(rest) ? std::string(rest) : written_out(rest);
    if (find_unit(prefixes[i] + unit)) return prefixes[i] + unit;
  }
  return {};
}

/// "25.4 mm" for what is known under a name that has no place here; empty where it is none.
std::string converted(double number, std::string_view symbol) {
  if (symbol == "inch" || symbol == "inches" || symbol == "in")
    return fmt::format("{:.9g} mm", 25.4 * number);
  if (symbol == "Oe") return fmt::format("{:.9g} G", number);
  if (symbol == "c") return fmt::format("{:.9g} m/s", constants::speed_of_light * number);
  return {};
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

/// "6 T/m" for 60 G/mm: a quotient of known units that is none itself; empty where it is not of that
/// dimension.
std::string as_quotient(const Decimal& number, std::string_view symbol, Dimension wanted) {
  const std::size_t slash = symbol.find('/');
  if (slash == std::string_view::npos) return {};
  const UnitSymbol *above = find_unit(symbol.substr(0, slash)), *below = find_unit(symbol.substr(slash + 1));
  if (!above || !below) return {};
  const std::string_view unit = row_of(wanted).si_unit;
  if (unit != fmt::format("{}/{}", row_of(above->dimension).si_unit, row_of(below->dimension).si_unit))
    return {};
  return fmt::format("write `{:.9g} {}`", evaluate(number, 1) * above->factor / below->factor, unit);
}

/// The unit that was meant; empty where none is near.
std::string suggest_unit(const Decimal& number, std::string_view symbol, std::optional<Dimension> wanted) {
  const bool dimension_known = wanted && *wanted != Dimension::number;
  if (symbol == "\u00b0C" || symbol == "degC" || symbol == "\u00b0F" || symbol == "degF") {
    const double degrees = evaluate(number, 1), zero = 273.15;
    return fmt::format("temperatures are absolute: write `{:.6g} K`",
                       symbol.ends_with('C') ? degrees + zero : (degrees - 32) * 5 / 9 + zero);
  }
  if (const std::string other = converted(evaluate(number, 1), symbol);
      !other.empty() &&
      (!dimension_known || find_unit(other.substr(other.find(' ') + 1))->dimension == *wanted))
    return fmt::format("write `{}`", other);
  const UnitSymbol* whole = find_unit(written_out(symbol));
  if (whole && (!dimension_known || whole->dimension == *wanted))
    return fmt::format("write `{:.9g} {}`", evaluate(number, 1), whole->symbol);
  if (wanted == Dimension::frequency && symbol == "rad/s")
    return fmt::format("a frequency counts cycles: write `{:.9g} Hz`, which is this over 2 pi",
                       evaluate(number, 1) / two_pi);
  std::string same_letters;
  std::vector<std::string> candidates;
  for (const UnitSymbol& unit : unit_table()) {
    if (dimension_known && unit.dimension != *wanted) continue;
    candidates.push_back(unit.symbol);
    if (lower(unit.symbol) == lower(symbol))
      same_letters += fmt::format("{}`{}`", same_letters.empty() ? "" : " or ", unit.symbol);
  }
  const std::string plain = without_prefix(number, symbol, dimension_known ? wanted : std::nullopt);
  if (!same_letters.empty())
    return fmt::format("upper and lower case differ in units: write {}{}{}", same_letters,
                       plain.empty() ? "" : ", or ", plain);
  if (!plain.empty()) return fmt::format("write {}", plain);
  if (dimension_known)
    if (std::string quotient = as_quotient(number, symbol, *wanted); !quotient.empty()) return quotient;
  if (symbol.ends_with("/h")) return "hours are no unit here: write it per second";
  const std::string near = closest(symbol, candidates);
  return near.empty() ? std::string{} : fmt::format("did you mean `{}`?", near);
}

/// The help for a number that goes on as none does: `9,81 m/s^2`, `1_000 uT`.
std::string as_numbers_are_written(std::string_view text, std::string_view rest,
                                   std::optional<Dimension> wanted) {
  const std::size_t at = text.size() - rest.size();
  const std::string before(text.substr(0, at)), behind(rest.substr(1));
  const auto is_quantity = [&](const std::string& changed) {
    return parse_quantity(changed, wanted).error.empty();
  };
  if (rest.front() == ',' && behind.find(',') == behind.npos && is_quantity(before + behind)) {
    const std::size_t digits = std::min(behind.find_first_not_of("0123456789"), behind.size());
    return digits == 3 ? fmt::format(
                             "numbers have a decimal point, and no commas between thousands: write "
                             "`{0}.{1}` or `{0}{1}`",
                             before, behind)
                       : fmt::format("numbers have a decimal point: write `{}.{}`", before, behind);
  }
  if (const std::string plain = without_thousands(text); plain != text && is_quantity(plain))
    return fmt::format("{}write `{}`",
                       rest.front() == '_' ? "" : "nothing stands between thousands: ", plain);
  if (wanted == Dimension::number) return "write digits with a point, such as `0.5`";
  return fmt::format("write digits with a point and a power of ten, then the unit: `1.5e-3 {}`",
                     si_unit_of(wanted.value_or(Dimension::length)));
}

ParsedQuantity failure(Misread misread, std::string error, std::string suggestion = {}) {
  return {0, Dimension::number, std::move(error), std::move(suggestion), misread};
}

}  // namespace

std::string_view name_of(Dimension d) { return row_of(d).name; }
std::string with_article(std::string_view noun) {
  const bool vowel = !noun.empty() && std::string_view{"aeio"}.find(noun.front()) != std::string_view::npos;
  return fmt::format("{} {}", vowel ? "an" : "a", noun);
}
std::string_view example_of(Dimension d) { return row_of(d).example; }
std::string_view si_unit_of(Dimension d) { return row_of(d).si_unit; }

const std::vector<UnitSymbol>& unit_table() {
  static const std::vector<UnitSymbol> table = [] {
    std::vector<UnitSymbol> all;
    for (const UnitRow& row : unit_rows)
      for (const char prefix : row.prefixes) {
        const double factor = row.factor * powers_of_ten[power_of(prefix) + row.exponent + least_power];
        const std::string symbol(row.symbol);
        if (prefix == '-')
          all.push_back({symbol, row.dimension, factor});
        else
          all.push_back({prefix + symbol, row.dimension, factor});
        if (prefix != 'u') continue;
        all.push_back({"\u00b5" + symbol, row.dimension, factor});  // the sign micro
        all.push_back({"\u03bc" + symbol, row.dimension, factor});  // the letter mu
      }
    return all;
  }();
  return table;
}

ParsedQuantity parse_quantity(std::string_view written, std::optional<Dimension> wanted) {
  const std::string plain = with_plain_minus(written);
  std::string_view text = plain;
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
  while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
  std::string_view rest = text;
  const std::optional<Decimal> number = take_decimal(rest);
  const std::string degrees = wanted == Dimension::angle ? degrees_of_pi(text) : std::string{};
  if (!degrees.empty())
    return failure(Misread::not_a_number, "is not a number", fmt::format("write `{}`", degrees));
  if (!number) return failure(Misread::not_a_number, "is not a number");
  if (number->mantissa.size() > 60) return failure(Misread::too_many_digits, "has too many digits");
  const bool is_apart = !rest.empty() && is_blank(rest.front());
  while (!rest.empty() && is_blank(rest.front())) rest.remove_prefix(1);

  const UnitSymbol* unit = rest.empty() ? nullptr : find_unit(rest);
  if (!rest.empty() && !unit) {
    const std::size_t digit = rest.find_first_of("0123456789._,+-");
    if (digit == 0 || (digit != rest.npos && !is_apart) || rest.size() > 16)
      return failure(Misread::not_a_number, "is not a number", as_numbers_are_written(text, rest, wanted));
    return failure(Misread::unknown_unit, fmt::format("has the unknown unit `{}`", rest),
                   suggest_unit(*number, rest, wanted));
  }

  ParsedQuantity result{
      evaluate(*number, unit ? unit->factor : 1), unit ? unit->dimension : Dimension::number, {}, {}};
  if (!std::isfinite(result.value)) return failure(Misread::too_large, "is too large for a number");
  if (result.value == 0 && !number->is_zero)
    return failure(Misread::too_small, "is too small for a number", "write `0` if zero is meant");
  return result;
}

}  // namespace rabiline
