#include "rules/field_lint.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/portable_math.hpp"
#include "field/field_formula.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/plan.hpp"
#include "rules/warning_room.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// A field along the beam's axis, where there is any: a map that is tilted has its corners beside the axis.
struct AxisField {
  double begin = 0, end = 0;  // [m]
  double largest = 0;         // [T], or [V/m], its size in between
  Vector3 first, last;        // at either end
  /// What particles meet between the source and where the last of them are caught.
  bool begins() const { return begin > 0; }
  bool ends(double caught_at) const { return end < caught_at; }
  double step(double caught_at) const {
    return std::max(begins() ? length_of(first) : 0, ends(caught_at) ? length_of(last) : 0);
  }
};

Vector3 vector_of(const FieldHere<double>& here) { return {here.field[0], here.field[1], here.field[2]}; }
/// But for what swings.
Vector3 steady_field_at(const Section& section, double y, double t) {
  FieldHere<double> sum{};
  for (const ShapedTerm& term : section.shaped) add_field_at<HostMaths>(term, 0.0, y, 0.0, t, sum);
  return section.field + vector_of(sum);
}
/// Of what swings, all at one angle p as a cos p + b sin p, the long axis of the ellipse.
Vector3 field_at(const Section& section, double y, double t) {
  Vector3 a, b;
  for (const SwingingTerm& term : section.swinging) {
    FieldHere<double> peak{};
    add_field<HostMaths>(term.field, 0.0, y, 0.0, peak);
    const double phase = term.oscillator.phase_of_swing(1);
    a = a + portable::cos(phase) * vector_of(peak);
    b = b + portable::sin(phase) * vector_of(peak);
  }
  const double angle = portable::atan2(2 * dot(a, b), dot(a, a) - dot(b, b)) / 2;
  return steady_field_at(section, y, t) + portable::cos(angle) * a + portable::sin(angle) * b;
}
Vector3 electric_field_at(const Section& section, double y, double /*it stands*/) {
  FieldHere<double> sum{};
  for (const ShapedTerm& term : section.electric) add_field<HostMaths>(term, 0.0, y, 0.0, sum);
  return vector_of(sum);
}
constexpr double hair = 1e-6;  // of a section's length: its end itself may be rounded to outside

/// Static fields of all parts but one just inside of where that one's begins or ends; what follows another
/// part's clock has none.
Vector3 field_of_others(const Beamline& beamline, const PlacedPart& part, double y) {
  Vector3 field;
  for (const PlacedPart& other : beamline.parts) {
    if (&other == &part || !traits_of(other.part).field || clock_of(other.part)) continue;
    SectionBuilder builder(Wall{});
    std::visit([&](const auto& any) { contribute(any, other.placement, builder); }, other.part);
    for (const Section& section : builder.build().sections)
      if (section.begin <= y && y <= section.end) field = field + field_at(section, y, 0);
  }
  return field;
}

/// [s] when a formula that has t is looked at: over its course, or one period. 0 for what stands.
std::vector<double> moments_of(const Part& part) {
  constexpr int moments = 64;
  const auto* formula = std::get_if<FormulaField>(&part);
  if (!formula || !formula->formula.box.moves()) return {0};
  const FormulaBox& box = formula->formula.box;
  const double last = box.duration ? *box.duration : 1 / *box.frequency;
  std::vector<double> out;
  for (int i = 0; i <= moments; ++i) out.push_back(last * i / moments);
  return out;
}

/// The last place from `yes` on, where it is so, towards `no`, where it is not.
template <class Is>
double bisected(double yes, double no, double most_off, const Is& is_so) {
  while (std::abs(yes - no) > most_off) {
    const double middle = 0.5 * (yes + no);
    (is_so(middle) ? yes : no) = middle;
  }
  return yes;
}

void take_longer(Vector3& longest, const Vector3& other) {
  if (length_of(other) > length_of(longest)) longest = other;
}

/// Nothing where all of a part's field is uniform, or follows a clock. Of a formula that has t, the largest.
std::optional<AxisField> axis_field_of(const PlacedPart& part) {
  if (!traits_of(part.part).field || clock_of(part.part)) return std::nullopt;
  SectionBuilder builder(Wall{});
  std::visit([&](const auto& any) { contribute(any, part.placement, builder); }, part.part);
  const auto field = is_electric(part.part) ? electric_field_at : field_at;
  const std::vector<double> moments = moments_of(part.part);
  std::optional<AxisField> out;
  for (const Section& section : builder.build().sections) {
    if (!section.needs_steps()) continue;
    const auto largest_at = [&](double y) {
      Vector3 longest;
      for (const double t : moments) take_longer(longest, field(section, y, t));
      return longest;
    };
    constexpr int places = 256;
    const auto place = [&](int i) { return section.begin + (section.end - section.begin) * i / places; };
    const double inside = hair * (section.end - section.begin);
    AxisField here{section.begin, section.end, 0, largest_at(section.begin + inside),
                   largest_at(section.end - inside)};
    int first = -1, last = places;
    for (int i = 0; i <= places; ++i) {
      const double size = length_of(largest_at(place(i)));
      if (size > 0) last = i;
      if (size > 0 && first < 0) first = i;
      here.largest = std::max(here.largest, size);
    }
    const auto is_there = [&](double y) { return largest_at(y) != Vector3{}; };
    if (first > 0 && here.first == Vector3{}) {
      here.begin = bisected(place(first), place(first - 1), inside, is_there);
      here.first = largest_at(here.begin);
    }
    if (last < places && here.last == Vector3{}) {
      here.end = bisected(place(last), place(last + 1), inside, is_there);
      here.last = largest_at(here.end);
    }
    if (!out) {
      out = here;
      continue;
    }
    out->largest = std::max(out->largest, here.largest);
    out->end = here.end;
    out->last = here.last;
  }
  return out;
}

double caught_at(const Beamline& beamline) {
  double last = 0;
  for (const PlacedPart& part : beamline.parts)
    if (std::holds_alternative<Detector>(part.part)) last = std::max(last, part.placement.at);
  return last > 0 ? last : std::numeric_limits<double>::infinity();
}

/// Parts whose edges are hard by their nature.
bool has_hard_edges(const Part& part) {
  return std::visit(
      [](const auto& any) {
        return requires { any.length; };
      },
      part);
}

/// The tables that a field is the sum of, the largest share of each, and the key that they stand under.
struct Tables {
  std::vector<std::pair<const FieldMap*, double>> maps{};
  std::string_view key{}, step_key{};
  std::string in_time{};  // how their shares change
  double missed = 0;      // of a formula between its places
};
Tables tables_of(const Part& part) {
  if (const auto* mapped = std::get_if<MappedField>(&part))
    return {{{mapped->map.map.get(), 1.0}}, "map", "map"};
  const auto* formula = std::get_if<FormulaField>(&part);
  if (!formula) return {};
  Tables out{{}, "formula", "formula.step"};
  for (const FormulaMap& one : *formula->formula.maps) {
    double share = one.course.empty() ? 1 : 0;
    for (const double node : one.course) share = std::max(share, std::abs(node));
    out.maps.emplace_back(&one.map, share);
  }
  const FormulaBox& box = formula->formula.box;
  if (box.duration)
    out.in_time = fmt::format(", followed for {}", pretty_quantity(*box.duration, Dimension::time));
  if (box.frequency)
    out.in_time = fmt::format(", repeated with {}", pretty_quantity(*box.frequency, Dimension::frequency));
  try {
    out.missed = missed_between(formula->formula);
  } catch (const FormulaFault&) {  // it has no value between the places where it has one
    out.missed = 1;
  }
  return out;
}

/// The worst of the tables, in terms of the largest field that any of them comes to.
MapQuality quality_of(const Tables& tables) {
  std::vector<MapQuality> each;
  double largest = 0;
  for (const auto& [map, share] : tables.maps) {
    each.push_back(quality_of(*map));
    largest = std::max(largest, each.back().largest_field *= share);
  }
  MapQuality worst{largest, true, {}, false, {}, {}};
  const auto take = [](Spread& worse, const Spread& other, double weight) {
    worse.largest = std::max(worse.largest, weight * other.largest);
    worse.rms = std::max(worse.rms, weight * other.rms);
  };
  for (const MapQuality& one : each) {
    const double weight = largest > 0 ? one.largest_field / largest : 0;
    take(worst.error, one.error, weight);
    take(worst.divergence, one.divergence, weight);
    take(worst.curl, one.curl, weight);
    worst.halved = worst.halved && one.halved;
    worst.noisy = worst.noisy || one.noisy;
  }
  if (tables.missed > worst.error.largest) {
    worst.error.largest = tables.missed;
    worst.halved = true;
  }
  return worst;
}

/// Whether the field that ends there is gone, or does not turn the field that the others leave: by less than
/// a hundredth of a radian a spin follows within 3e-5.
bool is_quiet_end(const AxisField& field, const Beamline& beamline, const PlacedPart& part, bool at_begin) {
  constexpr double large_step = 1e-3, small_turn = 1e-2;
  const Vector3& step = at_begin ? field.first : field.last;
  if (length_of(step) <= large_step * field.largest) return true;
  if (is_electric(part.part)) return false;
  const double inside = hair * (field.end - field.begin);
  const Vector3 others =
      field_of_others(beamline, part, at_begin ? field.begin + inside : field.end - inside);
  const Vector3 all = others + step;
  return others != Vector3{} && dot(others, all) > 0 &&
         length_of(cross(others, all)) < small_turn * length_of(others) * length_of(all);
}
bool ends_quietly(const AxisField& field, const Beamline& beamline, const PlacedPart& part,
                  double caught_at) {
  return (!field.begins() || is_quiet_end(field, beamline, part, true)) &&
         (!field.ends(caught_at) || is_quiet_end(field, beamline, part, false));
}

/// Whether divergence or curl are large, or far larger than what the map misses between its nodes.
bool is_no_field(const MapQuality& q) {
  constexpr double large = 5e-3, slight = 3e-4, unlike = 20;
  const double wrong = std::max(q.divergence.rms, q.curl.rms);
  return wrong > large || (q.halved && !q.noisy && wrong > std::max(slight, unlike * q.error.rms));
}

std::string text_of(const MapQuality& q) {
  return fmt::format("{}, div {:.1g}, curl {:.1g}",
                     !q.halved ? std::string("too few nodes for its error")
                               : fmt::format("error {:.1g} (largest {:.1g}){}", q.error.rms, q.error.largest,
                                             q.noisy ? ", noise" : ""),
                     q.divergence.rms, q.curl.rms);
}

/// Where a static field on the axis ends in one direction and goes on in another, at once or behind a gap:
/// spins and levels stay as they are, and precess about another axis from there on.
std::string report_of_turns(const Beamline& beamline) {
  constexpr double slight = 1e-2;  // [rad]
  std::string out;
  Vector3 left;
  double left_at = 0;
  for (const Section& section : sections_of(beamline).sections) {
    const double inside = hair * (section.end - section.begin);
    const Vector3 met = steady_field_at(section, section.begin + inside, 0),
                  last = steady_field_at(section, section.end - inside, 0);
    const double turn = portable::atan2(length_of(cross(left, met)), dot(left, met));
    if (left != Vector3{} && met != Vector3{} && turn > slight)
      out +=
          fmt::format("  by {:.3g} degrees {}\n", turn * (180 / std::numbers::pi),
                      section.begin - left_at > inside
                          ? fmt::format("over the gap from {} to {}", metres(left_at), metres(section.begin))
                          : fmt::format("at {}", metres(section.begin)));
    if (last == Vector3{}) continue;
    left = last;
    left_at = section.end;
  }
  return out.empty() ? out : "where the static field on the axis changes direction abruptly\n" + out;
}

}  // namespace

std::string report_of_fields(const Beamline& beamline) {
  std::string out;
  const double end = caught_at(beamline);
  for (const PlacedPart& part : beamline.parts) {
    const std::optional<AxisField> field = axis_field_of(part);
    if (!field) continue;
    const Dimension dimension =
        is_electric(part.part) ? Dimension::electric_field : Dimension::magnetic_field;
    out += fmt::format("  {}: {}, {} to {}, up to {} on the axis", part.placement.name, kind_of(part.part),
                       metres(field->begin), metres(field->end), pretty_quantity(field->largest, dimension));
    if (!has_hard_edges(part.part) && (field->begins() || field->ends(end)))
      out += fmt::format(", {} where it ends", pretty_quantity(field->step(end), dimension));
    out += '\n';
    if (const auto* wire = std::get_if<StraightWire>(&part.part); wire != nullptr && wire->wire_length)
      out += "    a piece of wire without its leads, whose field is left out: what is there has a curl\n";
    if (const Tables tables = tables_of(part.part); !tables.maps.empty()) {
      const FieldMap& first = *tables.maps.front().first;
      std::string nodes;
      for (const MapAxis& axis : first.axes())
        nodes += fmt::format("{}{}", nodes.empty() ? "" : " x ", axis.nodes);
      const std::string count =
          tables.maps.size() == 1 ? "" : fmt::format("{} tables of ", tables.maps.size());
      const double bytes = static_cast<double>(tables.maps.size() * first.bytes());
      out += fmt::format("    {}: {}{} nodes{}, {:.1f} MiB; of its largest field: {}\n", first.path(), count,
                         nodes, tables.in_time, bytes / 1048576, text_of(quality_of(tables)));
    }
  }
  return (out.empty() ? out : "fields that are followed along each path\n" + out) + report_of_turns(beamline);
}

std::vector<Fault> warnings_of_fields(const Beamline& beamline) {
  constexpr double poor_map = 1e-3,
                   least_noise = 1e-9;  // of the largest field; a billionth is what rounds a table
  const double end = caught_at(beamline);
  Faults out;
  for (const PlacedPart& part : beamline.parts) {
    const std::string& name = part.placement.name;
    const std::optional<AxisField> field = axis_field_of(part);
    if (!field) continue;
    const Tables tables = tables_of(part.part);
    const std::string_view key = tables.key;
    if (!has_hard_edges(part.part) && !ends_quietly(*field, beamline, part, end))
      out.push_back(warning(
          name, "at",
          fmt::format("on the axis the field of `{}` ends abruptly, at {:.3g} % of its largest value", name,
                      100 * field->step(end) / field->largest),
          key == "map"       ? "supply a map that goes on until the field is gone"
          : key == "formula" ? "make `length` larger, or multiply by what lets the field fade at its ends"
                             : "make `reach` larger"));
    if (!is_electric(part.part) && field->largest > most_magnetic_field)
      out.push_back(warning(
          name, std::string(key),
          fmt::format("the field of `{}` comes to {} on the axis: no coil has more than {:.0f} T", name,
                      pretty_quantity(field->largest, Dimension::magnetic_field), most_magnetic_field),
          "is one of the units wrong?"));
    if (tables.maps.empty()) continue;
    const MapQuality quality = quality_of(tables);
    if (is_no_field(quality))
      out.push_back(warning(
          name, std::string(key),
          fmt::format("the {} of `{}` is no field without {}: over one step its divergence is {:.1g} and "
                      "its curl {:.1g} of its largest value",
                      key, name, is_electric(part.part) ? "charges" : "currents", quality.divergence.rms,
                      quality.curl.rms),
          "look for a wrong unit, order or sign of its components; omit what has currents or charges in "
          "it"));
    else if (quality.noisy && quality.error.rms > least_noise && key == "map")
      out.push_back(warning(
          name, "map",
          fmt::format("the map of `{}` has noise: over one step it changes at random by {:.1g} of its "
                      "largest field",
                      name, quality.error.rms),
          "smooth it as a field without divergence and curl, or use a coarser grid"));
    else if (quality.halved && quality.error.largest > poor_map)
      out.push_back(warning(
          name, std::string(tables.step_key),
          fmt::format(
              "the {} of `{}` is coarse: it misses up to {:.1g} of its largest field between its nodes", key,
              name, quality.error.largest),
          key == "map" ? "use a finer grid" : "make `step` shorter"));
  }
  return out;
}

}  // namespace rabiline
