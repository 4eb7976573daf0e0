#pragma once
// The formulas of a field's components, read and worked out; for those who sample them.
#include <array>
#include <memory>
#include <string>

#include "field/field_formula.hpp"

namespace rabiline {

/// One component.
class FormulaComponent {
 public:
  /// Throws FormulaFault where its text cannot be read.
  FormulaComponent(const FieldFormula&, std::size_t component);
  ~FormulaComponent();
  FormulaComponent(const FormulaComponent&) = delete;
  FormulaComponent& operator=(const FormulaComponent&) = delete;

  /// Whether it has t.
  bool moves() const;
  /// At a place [m] and a time [s]. Throws FormulaFault where it has no finite value.
  double at(const std::array<double, 3>& place, double t);

 private:
  struct Parser;
  std::unique_ptr<Parser> parser_;
};

/// "muParser 2.3.3": of what reads them.
std::string formula_parser_version();

/// A node of a grid [m].
inline std::array<double, 3> place_of(const std::array<MapAxis, 3>& axes, std::size_t i, std::size_t j,
                                      std::size_t k) {
  return {axes[0].begin + axes[0].step * static_cast<double>(i),
          axes[1].begin + axes[1].step * static_cast<double>(j),
          axes[2].begin + axes[2].step * static_cast<double>(k)};
}

}  // namespace rabiline
