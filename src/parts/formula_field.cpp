#include "parts/formula_field.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "field/field_formula.hpp"
#include "field/host_maths.hpp"
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

FieldFormula formula_of(const FormulaBox& box) {
  FieldFormula formula{{box.bx, box.by, box.bz}, box.constants.value_or(NamedValues{}), 0};
  if (box.is_electric())
    formula.components = {box.ex.value_or("0"), box.ey.value_or("0"), box.ez.value_or("0")};
  formula.frequency = box.frequency.value_or(0);
  formula.duration = box.duration.value_or(0);
  return formula;
}

/// Some of the cells, each at the same share of it, which is no simple fraction: what repeats with the step
/// would look even at simple ones.
MapAxis between(const MapAxis& axis) {
  constexpr int most = 16;
  const int cells = axis.nodes - 1, each = (cells + most - 1) / most;
  return {(cells - 1) / each + 1, axis.begin + 0.3819660112501051 * axis.step, each * axis.step};
}

}  // namespace

double missed_between(const SampledFormula& sampled_formula) {
  const FormulaBox& box = sampled_formula.box;
  if (box.duration) return 0;
  std::array<MapAxis, 3> axes = axes_of(box);
  for (MapAxis& axis : axes) axis = between(axis);
  double largest = 0, missed = 0;
  for (const FieldHarmonic& exact : sampled(formula_of(box), axes)) {
    const auto own = std::ranges::find_if(*sampled_formula.maps, [&](const FormulaMap& map) {
      return map.number == exact.number && map.sine == exact.sine;
    });
    for (std::size_t i = 0; i < exact.nodes.field.size() / 3; ++i) {
      const auto node = [&](int axis, std::size_t number) {
        return axes[static_cast<std::size_t>(axis)].begin +
               axes[static_cast<std::size_t>(axis)].step * static_cast<double>(number);
      };
      const auto y_nodes = static_cast<std::size_t>(axes[1].nodes),
                 z_nodes = static_cast<std::size_t>(axes[2].nodes);
      FieldHere<double> here{};
      if (own != sampled_formula.maps->end())
        here = field_of<HostMaths>(own->map.shape(1, MapOutside::zero), node(0, i / (y_nodes * z_nodes)),
                                   node(1, i / z_nodes % y_nodes), node(2, i % z_nodes));
      for (std::size_t k = 0; k < 3; ++k) {
        const double value = exact.nodes.field[3 * i + k];
        largest = std::max(largest, std::abs(value));
        missed = std::max(missed, std::abs(value - here.field[k]));
      }
    }
  }
  return largest > 0 ? missed / largest : 0;
}

double places_of(const FormulaBox& box) {
  double places = 1;
  for (const double extent : {box.width, box.length, box.height})
    places *= std::max(4.0, std::ceil(extent / box.step) + 1);
  constexpr double times = 256;  // about, of what does not repeat
  return box.frequency ? 2 * most_field_harmonics * places : box.duration ? times * places : places;
}

std::shared_ptr<const FormulaMaps> maps_of(const FormulaBox& box) {
  const FieldFormula formula = formula_of(box);
  auto maps = std::make_shared<FormulaMaps>();
  const auto map_of = [&](MapNodes& nodes) {
    nodes.electric = box.is_electric();
    return FieldMap(std::move(nodes), std::array<MapSymmetry, 3>{}, "formula");
  };
  if (box.duration) {
    for (FieldOfCourse& field : sampled_in_time(formula, axes_of(box)))
      maps->push_back({0, false, std::move(field.course), std::move(field.stops), map_of(field.nodes)});
    return maps;
  }
  for (FieldHarmonic& harmonic : sampled(formula, axes_of(box)))
    maps->push_back({harmonic.number, harmonic.sine, {}, {}, map_of(harmonic.nodes)});
  return maps;
}

void contribute(const FormulaField& part, const Placement& place, SectionBuilder& builder) {
  const FormulaBox& box = part.formula.box;
  builder.keep(part.formula.maps);
  for (const FormulaMap& own : *part.formula.maps) {
    MapMotion motion{clock_of(part.oscillates)};
    if (own.number > 0)
      motion.clock = Oscillator{.frequency = own.number * box.frequency.value_or(0),
                                .phase = own.number * box.phase.angle - (own.sine ? std::numbers::pi / 2 : 0),
                                .random_phase = box.phase.kind == Phase::Kind::random,
                                .harmonic = own.number};
    if (const int nodes = static_cast<int>(own.course.size()) - 2; nodes > 0)
      motion.course = {own.course.data(), nodes, (nodes - 1) / *box.duration, own.stops.data()};
    contribute_map(own.map, part.scale, part.outside, motion, turned_frame(part.tilt), part.offset, place,
                   builder);
  }
}

std::vector<Fault> faults_of(const FormulaField& part, const Placement& place) {
  if (!part.oscillates || !(part.is_electric() || part.formula.box.moves())) return {};
  return {{place.name, "oscillates",
           part.is_electric()
               ? fmt::format("`{}` is an electric field, and these stand still", place.name)
               : fmt::format("the formulas of `{}` have t, and `oscillates` would multiply them", place.name),
           part.is_electric() ? "omit `oscillates`"
                              : "omit `oscillates`, and write the factor into the formulas"}};
}

}  // namespace rabiline
