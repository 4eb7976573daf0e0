#pragma once
// Quantities are written with their unit ("0.3 uT"); inside the program everything is SI and radians.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/dimension.hpp"

namespace rabiline {

/// "length" and "0.2 mm": how messages name a dimension and show one way to write it.
std::string_view name_of(Dimension);
std::string_view example_of(Dimension);
/// "a length", "an angle".
std::string with_article(std::string_view noun);
/// The SI unit in which results are written, e.g. "m".
std::string_view si_unit_of(Dimension);

/// A known unit: its symbol and its factor to SI.
struct UnitSymbol {
  std::string symbol;
  Dimension dimension;
  double factor;  // [SI per unit]
};
/// The whole table, prefixes written out; `describe units` and the messages come from it.
const std::vector<UnitSymbol>& unit_table();

/// Why a text is no quantity.
enum class Misread { nothing, not_a_number, too_many_digits, unknown_unit, too_large, too_small };

/// Result of reading "12.5 mT": the value in SI and its dimension, or why it is none.
struct ParsedQuantity {
  double value = 0;  // [SI]
  Dimension dimension = Dimension::number;
  std::string error;       // empty when the text was understood
  std::string suggestion;  // e.g. the closest unit; may be empty
  Misread misread = Misread::nothing;
};
/// Decimal prefixes are applied to the digits, so that "250 mm" and "0.25 m" are the same bits. `wanted` only
/// chooses among suggestions.
ParsedQuantity parse_quantity(std::string_view text, std::optional<Dimension> wanted = {});

/// Writes a value so that parse_quantity gives back the same bits: "0.29165e6 Hz".
std::string write_quantity(double value, Dimension);
/// Writes a value for people: four digits and a fitting prefix, "291.6 kHz".
std::string pretty_quantity(double value, Dimension);
/// Writes a measured number with two digits of its standard uncertainty: "42.577478461(18)"; nine digits of
/// one without.
std::string write_measured(double value, double uncertainty);

}  // namespace rabiline
