#pragma once
// The rows of a map in a CSV file, in any order, and the grid that they stand on.
#include <filesystem>
#include <stdexcept>
#include <string>

#include "field/field_map.hpp"

namespace rabiline {

/// What is wrong with a map's file: "line 17: ...", and what would mend it.
struct MapFault : std::runtime_error {
  MapFault(const std::string& message, std::string help_) : runtime_error(message), help(std::move(help_)) {}
  std::string help;
};

/// The largest file of text that is read as a map.
inline constexpr std::uintmax_t most_map_text = std::uintmax_t{2} << 30;

/// The nodes in SI. Throws MapFault. The file's size is looked at before anything is read.
MapNodes read_map_rows(const std::filesystem::path&);

}  // namespace rabiline
