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

/// B [T] or E [V/m] in x, y and z [m], z up and y along the beam, and t [s], and the box in which it is
/// sampled.
struct FormulaBox {
  static constexpr std::string_view example =
      "Bx: -G*x, Bz: B0 + G*z, constants: {B0: 1 mT, G: 2 T/m}, width: 1 cm, height: 1 cm, length: 10 cm, "
      "step: 1 mm";
  std::string bx = "0", by = "0", bz = "0";
  std::optional<std::string> ex{}, ey{}, ez{};  // any of them: it is an electric field
  std::optional<NamedValues> constants{};
  double width = 0, height = 0, length = 0;  // [m] along x and z, both ways from the axis, and along y
  double step = 0;                           // [m] of the grid
  std::optional<double> frequency{};         // [Hz] of formulas with t
  Phase phase;                               // of theirs
  std::optional<double> duration{};          // [s] of formulas with t that do not repeat
  bool is_electric() const { return ex || ey || ez; }
  bool moves() const { return frequency || duration; }
  bool operator==(const FormulaBox&) const = default;
};
template <>
inline constexpr auto parameters<FormulaBox> = std::tuple{
    param("Bx", &FormulaBox::bx, "the field along x [T] as a formula in x, y and z [m]",
          std::string_view{"0"}),
    param("By", &FormulaBox::by, "likewise along y, the beam", std::string_view{"0"}),
    param("Bz", &FormulaBox::bz, "likewise along z", std::string_view{"0"}),
    param("Ex", &FormulaBox::ex, "an electric field along x [V/m] instead, which stands"),
    param("Ey", &FormulaBox::ey, "likewise along y, the beam"),
    param("Ez", &FormulaBox::ez, "likewise along z"),
    param("constants", &FormulaBox::constants, "names in the formulas and their values, with units"),
    param("width", &FormulaBox::width, Dimension::length, range::positive,
          "of the box along x, half on each side of the axis"),
    param("height", &FormulaBox::height, Dimension::length, range::positive, "likewise along z"),
    param("length", &FormulaBox::length, Dimension::length, range::positive, "of the box along the beam"),
    param("step", &FormulaBox::step, Dimension::length, range::positive,
          "distance of the places at which the formulas are worked out"),
    param("frequency", &FormulaBox::frequency, Dimension::frequency, range::positive,
          "with which formulas that have t [s] repeat, up to four harmonics of it"),
    param("phase", &FormulaBox::phase, "of their period at emission: locked (t = 0), random, or an angle",
          Phase{}),
    param("duration", &FormulaBox::duration, Dimension::time, range::positive,
          "of formulas with t [s] that do not repeat: the time from t = 0 on; then the field stays"),
};
/// What of a formula stands, swings with a multiple of its frequency, or follows a course in time.
struct FormulaMap {
  int number = 0;  // of the harmonic; 0: it does not swing
  bool sine = false;
  std::vector<double> course{}, stops{};  // as TimeCourse has it; empty: none
  FieldMap map;
};
using FormulaMaps = std::vector<FormulaMap>;
/// The formulas, and the maps that they were sampled onto, which live as long as any beamline that has them.
struct SampledFormula {
  FormulaBox box;
  std::shared_ptr<const FormulaMaps> maps;
  bool operator==(const SampledFormula& o) const { return box == o.box; }
};

/// The maps of a formula, of which there is one at least. Throws FormulaFault.
std::shared_ptr<const FormulaMaps> maps_of(const FormulaBox&);
/// By which part of its largest component the maps are off between their nodes, of what repeats or stands.
/// Throws FormulaFault.
double missed_between(const SampledFormula&);
/// How many values it is worked out at.
double places_of(const FormulaBox&);
inline constexpr double most_formula_places = 2e7;

/// A field from formulas. Its origin is at `at` on the beam, displaced by the offset.
struct FormulaField {
  static constexpr std::string_view kind = "formula_field",
                                    meaning = "a field, B or E, from formulas in x, y, z and t";
  static constexpr std::string_view place =
      "where the origin of the formulas (x, y, z = 0) stands on the beam, from the source; the box begins "
      "there";
  static constexpr PartTraits traits{.field = true};
  SampledFormula formula;
  double scale = 1;
  MapOutside outside = MapOutside::zero;
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool is_electric() const { return formula.box.is_electric(); }
  bool operator==(const FormulaField&) const = default;
};
template <>
inline constexpr auto parameters<FormulaField> = std::tuple{
    param("formula", &FormulaField::formula, "the components, their constants, and the box"),
    param("scale", &FormulaField::scale, Dimension::number, range::any, "factor of the whole field", 1.0),
    param("outside", &FormulaField::outside, "the field beside the box; none if omitted", MapOutside::zero),
    param("offset", &FormulaField::offset, "displacement of the formulas' origin from the axis", Offset{}),
    param("tilt", &FormulaField::tilt, "how the field is turned about its origin", Tilt{}),
    param("oscillates", &FormulaField::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const FormulaField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const FormulaField&, const Placement&);

}  // namespace rabiline
