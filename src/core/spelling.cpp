#include "core/spelling.hpp"

#include <fmt/format.h>

#include <cctype>
#include <charconv>
#include <optional>

#include "core/text.hpp"
#include "core/units.hpp"

namespace rabiline {
namespace {

void replace_all(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + with.size()))
    text.replace(at, what.size(), with);
}

std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool whole = error == std::errc{} && end == text.data() + text.size();
  return whole ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string with_plain_minus(std::string_view text) {
  std::string out(text);
  replace_all(out, "\u2212", "-");
  return out;
}

std::string degrees_of_pi(std::string_view text) {
  std::string word = lower(with_plain_minus(text));
  replace_all(word, "\u03c0", "pi");
  for (const std::string_view blank : {" ", "*", "rad"}) replace_all(word, blank, "");
  const std::size_t pi = word.find("pi");
  if (pi == word.npos) return {};
  std::string before = word.substr(0, pi), behind = word.substr(pi + 2);
  if (before.empty() || before == "-") before += '1';
  if (behind.empty()) behind = "/1";
  const std::optional<double> factor = number_in(before),
                              divisor = behind.front() == '/' ? number_in(behind.substr(1)) : std::nullopt;
  if (!factor || !divisor || *divisor == 0) return {};
  return fmt::format("{:.10g} deg", 180 * *factor / *divisor);
}

std::string unit_in(std::string_view quantity) {
  std::string found;
  for (const UnitSymbol& unit : unit_table()) {
    if (!quantity.ends_with(unit.symbol) || unit.symbol.size() <= found.size()) continue;
    const std::string_view before = quantity.substr(0, quantity.size() - unit.symbol.size());
    if (!before.empty() && std::string_view("0123456789. ").find(before.back()) != before.npos)
      found = unit.symbol;
  }
  return found;
}

std::string without_thousands(std::string_view quantity) {
  const auto is_digit = [&](std::size_t i) {
    return i < quantity.size() && std::isdigit(static_cast<unsigned char>(quantity[i]));
  };
  std::string out;
  for (std::size_t i = 0; i < quantity.size(); ++i) {
    const bool stands_between =
        i > 0 && is_digit(i - 1) && is_digit(i + 1) && is_digit(i + 2) && is_digit(i + 3) && !is_digit(i + 4);
    const bool separates =
        quantity[i] == '_' ||
        (stands_between && std::string_view(". '").find(quantity[i]) != std::string_view::npos);
    if (!separates) out += quantity[i];
  }
  return out;
}

bool has_point_before_thousands(std::string_view number) {
  const std::size_t point = number.find('.');
  return point > 0 && point <= 3 && number.front() != '0' && number.size() == point + 4 &&
         number.find_first_not_of("0123456789.") == number.npos;
}

}  // namespace rabiline
