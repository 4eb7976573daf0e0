// Fields that drive the levels of atoms: those that drive nothing, miss their lines or turn levels far too
// often, and what their approximations leave out.
#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <set>
#include <tuple>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/units.hpp"
#include "plan/driven_parts.hpp"
#include "plan/level_lines.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

using Driven = DrivenParts::Driven;

/// Where a field is 100 widths and Rabi frequencies away, it flips about 1e-4 at most.
bool is_far(const Transition& t, double width) { return std::abs(t.detuning) > 100 * (width + t.rabi); }

/// Farther away it flips a seventeenth at most, and where exactly the line is hardly matters.
bool is_driven(const Transition& t, double width) { return std::abs(t.detuning) < 4 * (width + t.rabi); }

/// Amplitudes that the rotating-wave approximation may leave out: beside those that it has they change a
/// probability by twice as much.
constexpr double most_left_out = 0.07;

/// [Hz] About what shifts a line that the approximation leaves out: the fourth order, by what the second
/// does. Lines of two photons were found to be off by four times as much.
constexpr double fourth_order = 4;
/// Of a line's width: what shifts it by more turns levels by a third of a radian more on their way.
constexpr double most_shift = 0.05;
struct LeftOutShift {
  double shift = 0, width = 0;
  std::string line{}, field{};
};

/// What the approximations leave out before one part, at the worst of its scan points.
class Approximations {
 public:
  void look_at(const Driven& driven) {
    if (worst_ == nullptr || driven.neglected > worst_->neglected) worst_ = &driven;
  }
  void look_at(const Driven& driven, const std::string& field, const Transition& line, double width) {
    const double shift = fourth_order * (line.photons == 2 ? 4 : 1) * std::abs(line.shift) *
                         driven.neglected * driven.neglected;
    if (shift > most_shift * width && shift * most_.width >= most_.shift * width)
      most_ = {shift, width, name_of(driven.structure, line), field};
  }
  void tell(Faults& out) const {
    if (worst_ != nullptr && worst_->neglected > most_left_out)
      out.push_back(
          warning(*worst_->approximated.begin(), "amplitude",
                  fmt::format("the rotating-wave approximation of `{}` is poor: {}",
                              fmt::join(worst_->approximated, "` and `"), left_out(worst_->neglected)),
                  worst_->beside_whole_fields
                      ? "its frame does not follow whole fields that drive at the same place: give all of "
                        "them the same `approximation`"
                      : "a smaller field helps, one that turns (a `rotating_field`), or `approximation: "
                        "none`"));
    else if (most_.shift > 0)
      out.push_back(
          warning(most_.field, "approximation",
                  fmt::format("what the rotating-wave approximation of `{}` leaves out may shift {} by "
                              "up to {}, and the line's width is {}",
                              most_.field, most_.line, pretty_quantity(most_.shift, Dimension::frequency),
                              pretty_quantity(most_.width, Dimension::frequency)),
                  "`approximation: none` takes the whole field"));
  }

 private:
  const Driven* worst_ = nullptr;
  LeftOutShift most_{};
};

/// A field that drives levels, as all species and scan points see it.
class DrivingField {
 public:
  void look_at(int component, const Driven& driven, const DrivenZone& zone,
               const std::vector<Transition>& all, double width) {
    for (const Transition& t : all) {
      Line& line = lines_[{component, t.upper, t.lower, t.photons}];
      const double strength = std::max(width, t.rabi);
      is_useful_ = is_useful_ || !is_far(t, width);
      // Along a way, levels may follow their field, or a sweep, through a line.
      line.approach.is_met = line.approach.is_met || driven.on_way;
      if (std::abs(t.detuning) < strength && !driven.on_way)
        line.turns = std::max(line.turns, t.rabi / width);
      if (!line.approach.look_at(t.detuning, strength)) continue;
      line.nearest = t;
      line.width = width;
      line.structure = &driven.structure;
    }
    const double distance = all.empty() ? HUGE_VAL : std::abs(all.front().detuning);
    if (nearest_zone_ != nullptr && distance >= distance_) return;
    distance_ = distance;
    nearest_zone_ = &zone;
    nearest_ = {all.begin(), all.begin() + std::min<std::ptrdiff_t>(3, std::ssize(all))};
    structure_ = &driven.structure;
  }

  void tell(const std::string& name, bool is_scanned, Faults& out) const {
    if (!is_useful_) return out.push_back(fault_of_nothing(name, is_scanned));
    if (std::ranges::all_of(lines_, [](const auto& line) { return line.second.approach.keeps_off(); }) &&
        std::ranges::any_of(lines_, [](const auto& line) { return line.second.approach.moves(); }))
      out.push_back(fault_of_missed_line(name));
    const Line& most =
        std::ranges::max_element(lines_, {}, [](const auto& line) { return line.second.turns; })->second;
    if (most.turns > most_turns)
      out.push_back(fault_of_turns(name, most.turns, name_of(*most.structure, most.nearest)));
  }

 private:
  /// A transition over the scan points.
  struct Line {
    Approach approach{};   // [Hz]
    double turns = 0;      // Rabi cycles on resonance
    Transition nearest{};  // at the point where it is
    double width = 0;      // [Hz] there
    const Structure* structure = nullptr;
  };

  Fault fault_of_nothing(const std::string& name, bool is_scanned) const {
    std::string list;
    for (const Transition& t : nearest_)
      list += fmt::format("{}{} at {}", list.empty() ? "" : ", ", name_of(*structure_, t),
                          megahertz(t.frequency));
    return warning(name, "frequency",
                   fmt::format("`{}` drives no transition{}: at B = {} and {}, nearest are {}", name,
                               is_scanned ? " at any scan point" : "", tesla(nearest_zone_->field),
                               megahertz(nearest_zone_->frequency), list.empty() ? "none" : list));
  }
  Fault fault_of_missed_line(const std::string& name) const {
    const Line& line = std::ranges::min_element(lines_, {}, [](const auto& one) {
                         return one.second.approach.nearest;
                       })->second;
    return warning(
        name, "frequency",
        fmt::format("no scan point is near a line that `{}` drives: the nearest is {} away from {} "
                    "at {}, and the line's width is {}",
                    name, pretty_quantity(line.approach.nearest, Dimension::frequency),
                    name_of(*line.structure, line.nearest), megahertz(line.nearest.frequency),
                    pretty_quantity(line.width, Dimension::frequency)),
        "scan over the line, or is one of the units wrong?");
  }

  bool is_useful_ = false;                                  // drives some species of the beam
  std::map<std::tuple<int, int, int, int>, Line> lines_{};  // of a component, between two levels, of photons
  double distance_ = 0;                                     // [Hz]
  const DrivenZone* nearest_zone_ = nullptr;                // to a line
  std::vector<Transition> nearest_{};
  const Structure* structure_ = nullptr;
};

}  // namespace

Fault fault_of_turns(const std::string& name, double turns, const std::string& what) {
  return warning(name, "amplitude",
                 fmt::format("`{}` drives {:.3g} Rabi cycles of {}, and half a cycle is a whole flip", name,
                             turns, what),
                 "is one of the units wrong?");
}

Faults line_warnings_of(const Experiment& experiment, const Plan& plan) {
  DrivenParts parts(experiment, plan);
  std::map<std::string, DrivingField> fields;
  Faults out;
  for (const auto& [where, at] : parts.each()) {
    Approximations approximations;
    const Driven* before = nullptr;
    for (std::size_t point = 0; point < at.size(); ++point) {
      const Driven* driven = at[point];
      if (driven == nullptr || std::exchange(before, driven) == driven) continue;
      approximations.look_at(*driven);
      for (std::size_t i = 0; i < driven->zones.size(); ++i) {
        const DrivenZone& zone = driven->zones[i];
        const double width =
            width_of(zone, driven->lengths[i],
                     parts.flight_at(point, where.first).speed_between(zone.begin, zone.end));
        std::vector<Transition> all = transitions_near(driven->structure, zone);
        std::ranges::copy(transitions_of_two_photons(driven->structure, zone, width),
                          std::back_inserter(all));
        for (const Transition& t : all)
          if (is_driven(t, width)) approximations.look_at(*driven, driven->names[i], t, width);
        fields[driven->names[i]].look_at(where.first, *driven, zone, all, width);
      }
    }
    approximations.tell(out);
  }
  for (const auto& [name, field] : fields) field.tell(name, !experiment.axes.empty(), out);
  return out;
}

}  // namespace rabiline
