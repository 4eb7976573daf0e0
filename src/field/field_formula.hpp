#pragma once
// Static fields as formulas, sampled onto the nodes of a map.
#include <array>
#include <map>
#include <stdexcept>
#include <string>

#include "field/field_map.hpp"

namespace rabiline {

/// B_x, B_y and B_z [T] in x, y and z [m], with named constants in SI.
struct FieldFormula {
  std::array<std::string, 3> components{"0", "0", "0"};
  std::map<std::string, double> constants;
  bool operator==(const FieldFormula&) const = default;
};

/// What is wrong with the text of one component, and where in it: at `length` characters from `from` on.
struct FormulaFault : std::runtime_error {
  FormulaFault(const std::string& message, std::string help_)
      : runtime_error(message), help(std::move(help_)) {}
  std::string help;
  std::size_t component = 0, from = 0, length = 0;
};

/// Whether a formula can have a constant of that name: a letter, then letters, digits or `_`, and no word
/// with a meaning of its own.
bool can_name_constant(const std::string&);

/// The field at the nodes of these axes: x, y, z. Throws FormulaFault.
MapNodes sampled(const FieldFormula&, const std::array<MapAxis, 3>& axes);

}  // namespace rabiline
