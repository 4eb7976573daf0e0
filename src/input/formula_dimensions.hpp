#pragma once
// What kind of quantity a formula is, by the units of its constants.
#include <array>
#include <map>
#include <optional>
#include <string>

#include "core/units.hpp"

namespace rabiline {

/// What is added or asked for although it cannot be right, and where in the formula: at `length` characters
/// from `from` on.
struct FormulaMisfit {
  std::string message;
  std::size_t from = 0, length = 0;
};

/// Places are lengths and t is a time. A number, also a constant without a unit, may stand for a quantity of
/// any kind in SI, and with it what it multiplies or divides: such a formula is taken for right. The text is
/// one that the formulas' own parser has read.
std::optional<FormulaMisfit> misfit_of(const std::string& formula,
                                       const std::map<std::string, Dimension>& constants, Dimension wanted);

}  // namespace rabiline
