#pragma once
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "parts/mapped_field.hpp"
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;

/// Named numbers in SI, of any dimension.
using NamedValues = std::map<std::string, double>;

/// B_x, B_y and B_z [T] in x, y and z [m], z up and y along the beam, and the box in which they are sampled.
struct FormulaBox {
  static constexpr std::string_view example =
      "Bx: -G*x, Bz: B0 + G*z, constants: {B0: 1 mT, G: 2 T/m}, width: 1 cm, height: 1 cm, length: 10 cm, "
      "step: 1 mm";
  std::string bx = "0", by = "0", bz = "0";
  std::optional<NamedValues> constants{};
  double width = 0, height = 0, length = 0;  // [m] along x and z, both ways from the axis, and along y
  double step = 0;                           // [m] of the grid
  bool operator==(const FormulaBox&) const = default;
};
template <>
inline constexpr auto parameters<FormulaBox> = std::tuple{
    param("Bx", &FormulaBox::bx, "the field along x [T] as a formula in x, y and z [m]",
          std::string_view{"0"}),
    param("By", &FormulaBox::by, "likewise along y, the beam", std::string_view{"0"}),
    param("Bz", &FormulaBox::bz, "likewise along z", std::string_view{"0"}),
    param("constants", &FormulaBox::constants, "names in the formulas and their values, with units"),
    param("width", &FormulaBox::width, Dimension::length, range::positive,
          "of the box along x, half on each side of the axis"),
    param("height", &FormulaBox::height, Dimension::length, range::positive, "likewise along z"),
    param("length", &FormulaBox::length, Dimension::length, range::positive, "of the box along the beam"),
    param("step", &FormulaBox::step, Dimension::length, range::positive,
          "distance of the places at which the formulas are worked out"),
};
/// The formulas, and the map that they were sampled onto, which lives as long as any beamline that has it.
struct SampledFormula {
  FormulaBox box;
  std::shared_ptr<const FieldMap> map;
  bool operator==(const SampledFormula& o) const { return box == o.box; }
};

/// The map of a formula. Throws FormulaFault.
std::shared_ptr<const FieldMap> map_of(const FormulaBox&);
/// How many places its grid has.
double places_of(const FormulaBox&);
inline constexpr double most_formula_places = 2e7;

/// A static field from formulas. Its origin is at `at` on the beam, displaced by the offset.
struct FormulaField {
  static constexpr std::string_view kind = "formula_field",
                                    meaning = "a static field from formulas in x, y and z";
  static constexpr PartTraits traits{.field = true};
  SampledFormula formula;
  double scale = 1;
  MapOutside outside = MapOutside::zero;
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool operator==(const FormulaField&) const = default;
};
template <>
inline constexpr auto parameters<FormulaField> = std::tuple{
    param("formula", &FormulaField::formula, "the components, their constants, and the box"),
    param("scale", &FormulaField::scale, Dimension::number, range::any, "factor of the whole field", 1.0),
    param("outside", &FormulaField::outside, "the field beside the box; none where it is missing",
          MapOutside::zero),
    param("offset", &FormulaField::offset, "displacement of the formulas' origin from the axis", Offset{}),
    param("tilt", &FormulaField::tilt, "how the field is turned about its origin", Tilt{}),
    param("oscillates", &FormulaField::oscillates,
          "frequency and phase with which the whole field swings; it stands where it is missing"),
};

void contribute(const FormulaField&, const Placement&, SectionBuilder&);

}  // namespace rabiline
