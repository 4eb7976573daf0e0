#include "parts/formula_field.hpp"

#include <algorithm>
#include <cmath>

#include "field/field_formula.hpp"
#include "parts/own_frame.hpp"

namespace rabiline {
namespace {

/// In steps as even as they can be, none longer than the one that is asked for; four nodes or more.
MapAxis axis_of(double begin, double extent, double step) {
  const double cells = std::max(3.0, std::ceil(extent / step * (1 - 1e-9)));
  return {static_cast<int>(cells) + 1, begin, extent / cells};
}

std::array<MapAxis, 3> axes_of(const FormulaBox& box) {
  return {axis_of(-box.width / 2, box.width, box.step), axis_of(0, box.length, box.step),
          axis_of(-box.height / 2, box.height, box.step)};
}

}  // namespace

double places_of(const FormulaBox& box) {
  double places = 1;
  for (const double extent : {box.width, box.length, box.height})
    places *= std::max(4.0, std::ceil(extent / box.step) + 1);
  return places;
}

std::shared_ptr<const FieldMap> map_of(const FormulaBox& box) {
  return std::make_shared<const FieldMap>(
      sampled({{box.bx, box.by, box.bz}, box.constants.value_or(NamedValues{})}, axes_of(box)),
      std::array<MapSymmetry, 3>{}, "formula");
}

void contribute(const FormulaField& part, const Placement& place, SectionBuilder& builder) {
  contribute_map(*part.formula.map, part.scale, part.outside, part.oscillates, turned_frame(part.tilt),
                 part.offset, place, builder);
}

}  // namespace rabiline
