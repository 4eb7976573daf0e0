#pragma once
// How people write levels: "F=4 m=-3", or in a strong field "m_J=1/2 m_I=-7/2".
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "spin/level_labels.hpp"

namespace rabiline {

/// A level by one of its two names, (F, m_F) or (m_J, m_I); see LevelLabel.
struct LevelName {
  bool strong_field = false;
  int twice_first = 0, twice_second = 0;  // 2F and 2m_F, or 2m_J and 2m_I
  bool operator==(const LevelName&) const = default;
};

/// Nothing where the text is no name.
std::optional<LevelName> parse_level_name(std::string_view text);
/// Its number, where there is such a level.
std::optional<int> find_level(std::span<const LevelLabel> labels, const LevelName& name);
/// "F=4 m=-3"
std::string weak_field_name(const LevelLabel& label);
/// "m_J=+1/2 m_I=-7/2"
std::string strong_field_name(const LevelLabel& label);
/// All levels by their weak-field names, in the order of their numbers.
std::vector<std::string> names_of_levels(const CoupledSpins& spins);
/// "m = +3/2", ..., "m = -3/2": those of one spin, in the order of their numbers.
std::vector<std::string> names_of_levels(int levels);
/// "3", "-1/2"
std::string write_half(int twice);

}  // namespace rabiline
