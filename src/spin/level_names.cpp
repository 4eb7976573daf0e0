#include "spin/level_names.hpp"

#include <algorithm>
#include <charconv>

namespace rabiline {
namespace {

/// Twice a whole or half number: "+1/2", "-3".
std::optional<int> parse_half(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const bool half = text.ends_with("/2");
  if (half) text.remove_suffix(2);
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < -100 || value > 100) return {};
  if (half && value % 2 == 0) return {};
  return half ? value : 2 * value;
}

/// "m=-3" begins the text: its value, and the text behind it.
std::optional<int> take(std::string_view key, std::string_view& text) {
  while (text.starts_with(' ') || text.starts_with(',')) text.remove_prefix(1);
  if (!text.starts_with(key)) return {};
  text.remove_prefix(key.size());
  while (text.starts_with(' ')) text.remove_prefix(1);
  if (!text.starts_with('=')) return {};
  text.remove_prefix(1);
  while (text.starts_with(' ')) text.remove_prefix(1);
  const std::size_t end = std::min(text.find_first_of(" ,"), text.size());
  const std::optional<int> value = parse_half(text.substr(0, end));
  text.remove_prefix(end);
  return value;
}

std::string with_sign(int twice) { return std::string(twice > 0 ? "+" : "").append(write_half(twice)); }

}  // namespace

std::string write_half(int twice) {
  return twice % 2 == 0 ? std::to_string(twice / 2) : std::to_string(twice) + "/2";
}

std::optional<LevelName> parse_level_name(std::string_view text) {
  const auto both = [&](std::string_view first, std::string_view second) -> std::optional<LevelName> {
    std::string_view rest = text;
    const auto a = take(first, rest), b = a ? take(second, rest) : std::nullopt;
    if (!a || !b || rest.find_first_not_of(' ') != rest.npos) return {};
    return LevelName{first == "m_J", *a, *b};
  };
  for (const char* second : {"m", "m_F"})
    if (const auto name = both("F", second)) return name;
  return both("m_J", "m_I");
}

std::optional<int> find_level(std::span<const LevelLabel> labels, const LevelName& name) {
  return name.strong_field ? find_strong_field_level(labels, name.twice_first, name.twice_second)
                           : find_weak_field_level(labels, name.twice_first, name.twice_second);
}

std::string weak_field_name(const LevelLabel& label) {
  return "F=" + write_half(label.twice_f) + " m=" + with_sign(label.twice_m);
}

std::string strong_field_name(const LevelLabel& label) {
  return "m_J=" + with_sign(label.twice_m_j) + " m_I=" + with_sign(label.twice_m_i);
}

std::vector<std::string> names_of_levels(const CoupledSpins& spins) {
  std::vector<std::string> names;
  for (const LevelLabel& label : level_labels(spins)) names.push_back(weak_field_name(label));
  return names;
}

std::vector<std::string> names_of_levels(int levels) {
  std::vector<std::string> names;
  for (int twice_m = levels - 1; twice_m > -levels; twice_m -= 2)
    names.push_back((twice_m > 0 ? "m = +" : "m = ") + write_half(twice_m));
  return names;
}

}  // namespace rabiline
