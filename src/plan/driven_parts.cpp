#include "plan/driven_parts.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/portable_math.hpp"
#include "core/units.hpp"
#include "plan/level_lines.hpp"
#include "plan/level_waves.hpp"

namespace rabiline {
namespace {

/// The nearest transitions, a line each: so many, and all within 100 widths where `all`.
void tell_transitions(const Structure& structure, const DrivenZone& zone, double width, std::size_t least,
                      bool all, std::vector<std::string>& out) {
  const std::vector<Transition> near = transitions_near(structure, zone);
  if (near.empty()) out.emplace_back("    no transition turns with it");
  const auto tell = [&](const Transition& t) {
    std::string flips;
    // Of two photons the same field always shifts the line, by about as much as it drives it.
    if (const double rate = portable::hypot(t.rabi, t.detuning - (t.photons == 2 ? t.shift : 0));
        zone.is_even && !is_pulsed(zone) && rate > 0)
      flips = fmt::format(", alone it flips {:.3g}",
                          portable::pow(t.rabi / rate * portable::sin(std::numbers::pi * rate / width), 2));
    const std::string shift =
        t.shift == 0
            ? ""
            : fmt::format("; {} shifts it by {}", t.photons == 2 ? "the field" : "what turns otherwise",
                          pretty_quantity(t.shift, Dimension::frequency));
    out.push_back(fmt::format("    {} at {}, detuned by {}, Rabi frequency {}{}{}", name_of(structure, t),
                              megahertz(t.frequency), pretty_quantity(t.detuning, Dimension::frequency),
                              pretty_quantity(t.rabi, Dimension::frequency), flips, shift));
  };
  for (std::size_t i = 0; i < near.size(); ++i) {
    if (i >= least && !(all && std::abs(near[i].detuning) <= 100 * width)) break;
    tell(near[i]);
  }
  for (const Transition& t : transitions_of_two_photons(structure, zone, width)) tell(t);
}

const std::string& name_of(int part, const Beamline& beamline) {
  return beamline.parts[static_cast<std::size_t>(part)].placement.name;
}

}  // namespace

DrivenParts::DrivenParts(const Experiment& experiment, const Plan& plan)
    : experiment_(experiment), plan_(plan) {
  for (const PlanTree& tree : plan.trees) collect(tree.component, tree.next);
}

void DrivenParts::collect(int component, const std::vector<PlanNode>& nodes) {
  for (const PlanNode& node : nodes) {
    collect(component, node.stage, node.points);
    for (const PlanNode::Reweighting& reweighting : node.reweightings)
      collect(component, reweighting.stage, reweighting.points);
    collect(component, node.next);
  }
}

const DrivenParts::Driven* DrivenParts::driven_of(const SpinPath& path, const Beamline& beamline,
                                                  const Species& atom) {
  const Structure& structure = *atom.structure;
  const void* of = path.way != nullptr ? static_cast<const void*>(path.way) : path.transitions;
  const auto [known, is_new] = driven_.try_emplace(of, Driven{structure});
  Driven& made = known->second;
  if (!is_new) return &made;
  if (path.way != nullptr) {
    made.on_way = true;
    made.zones =
        zones_near_lines(path.way->fields(), structure, mean_speed(beamline.source.speed, atom.mass));
    made.beside_whole_fields = std::ranges::any_of(path.way->fields().sections, [](const CourseSection& s) {
      return s.wave >= 0 && s.field.drives > 0;
    });
    for (const WaveFields& wave : path.way->fields().waves) {
      made.neglected = std::max(made.neglected, wave.frame.neglected);
      for (const DriveTerm& drive : wave.drives) made.approximated.insert(name_of(drive.part, beamline));
    }
  } else {
    const SampledTables::Driven& tabled = plan_.tables->driven_by(path.transitions);
    made.neglected = tabled.levels.neglected();
    made.largest_slowness = tabled.largest_slowness;
    for (const LevelZone& zone : tabled.zones)
      if (zone.drive) made.zones.push_back(driven_zone(zone));
  }
  for (const DrivenZone& zone : made.zones) {
    double begin = zone.begin, end = zone.end;
    for (const DrivenZone& other : made.zones) {
      if (other.part != zone.part) continue;
      begin = std::min(begin, other.begin);
      end = std::max(end, other.end);
    }
    made.names.push_back(name_of(zone.part, beamline));
    made.lengths.push_back(end - begin);
  }
  if (!made.on_way) made.approximated = {made.names.begin(), made.names.end()};
  return &made;
}

/// Kept, as most questions about one point come one after the other.
const Beamline& DrivenParts::beamline_at(int point) {
  if (std::exchange(in_hand_, point) != point)
    beamline_ = experiment_.points[static_cast<std::size_t>(point)];
  return beamline_;
}

void DrivenParts::collect(int component, const Stage& stage, const std::vector<int>& points) {
  const SpinPath* path = path_of(stage);
  if (path == nullptr || (path->transitions == nullptr && path->way == nullptr)) return;
  // Numbers of parts differ between the points where one is moved or not enabled.
  const Beamline& beamline = beamline_at(points.front());
  std::vector<const Driven*>& at =
      parts_[{component, beamline.parts[static_cast<std::size_t>(part_of(stage))].placement.name}];
  at.resize(experiment_.points.size());
  const Driven* driven =
      driven_of(*path, beamline, beamline.species[static_cast<std::size_t>(component)].species);
  for (const int point : points) at[static_cast<std::size_t>(point)] = driven;
}

MeanFlight DrivenParts::flight_at(std::size_t point, int component) {
  const Beamline& beamline = beamline_at(static_cast<int>(point));
  return mean_flight(beamline, beamline.species[static_cast<std::size_t>(component)].species.mass);
}

/// The zone of one point that is that of another one: a drive may have no amplitude at some.
std::optional<std::size_t> DrivenParts::zone_called(const Driven& at, const Driven& most,
                                                    std::size_t number) {
  const std::string& name = most.names[number];
  auto before =
      std::count(most.names.begin(), most.names.begin() + static_cast<std::ptrdiff_t>(number), name);
  for (std::size_t i = 0; i < at.names.size(); ++i)
    if (at.names[i] == name && before-- == 0) return i;
  return std::nullopt;
}

void DrivenParts::add_zone(const Driven& most, std::size_t number, const std::vector<const Driven*>& at,
                           const MeanFlight& flight, std::vector<std::string>& out) const {
  const std::size_t last = at.size() - 1;
  const DrivenZone* before = nullptr;
  for (const std::size_t point : std::set<std::size_t>{0, last / 2, last}) {
    const std::optional<std::size_t> same = at[point] ? zone_called(*at[point], most, number) : std::nullopt;
    if (!same || (before && *before == at[point]->zones[*same])) continue;
    const DrivenZone& zone = at[point]->zones[*same];
    const bool first = before == nullptr;
    before = &zone;
    const double width =
        width_of(zone, at[point]->lengths[*same], flight.speed_between(zone.begin, zone.end));
    out.push_back(fmt::format("at B = {}{}{}: {}, width {} {}", tesla(zone.field),
                              at[point]->on_way ? ", where a line is nearest" : "",
                              last == 0 ? "" : fmt::format(", scan point {}", point + 1),
                              megahertz(zone.frequency), is_pulsed(zone) ? "of a pulse" : "v/L",
                              pretty_quantity(width, Dimension::frequency)));
    if (first)
      out.push_back(fmt::format("    its parts about {}: pi {}, sigma+ {}, sigma- {}",
                                zone.field < 0 ? "+z, against B" : "B", tesla(std::abs(zone.parts.along)),
                                tesla(zone.parts.right), tesla(zone.parts.left)));
    tell_transitions(at[point]->structure, zone, width, first ? 3 : 1, first, out);
  }
}

std::vector<std::string> DrivenParts::lines(int component, int part, const MeanFlight& flight) const {
  std::vector<std::string> out;
  const auto found = parts_.find(
      {component, experiment_.points.front().parts[static_cast<std::size_t>(part)].placement.name});
  if (found == parts_.end()) return out;
  const std::vector<const Driven*>& at = found->second;
  const Driven& driven = **std::ranges::max_element(
      at, {}, [](const Driven* d) { return d == nullptr ? -1 : static_cast<int>(d->zones.size()); });
  std::vector<std::vector<std::string>> told;
  const std::vector<DrivenZone>& zones = driven.zones;
  for (std::size_t i = 0; i < zones.size(); ++i) {
    told.emplace_back();
    add_zone(driven, i, at, flight, told.back());
    const auto same =
        static_cast<std::size_t>(std::find(told.begin(), told.end(), told.back()) - told.begin());
    out.push_back(fmt::format("{} drives from {:.4f} to {:.4f} m{}", driven.names[i], zones[i].begin,
                              zones[i].end,
                              same == i ? "" : fmt::format(", as {} does", driven.names[same])));
    if (same == i)
      for (const std::string& line : told.back()) out.push_back("  " + line);
  }
  if (driven.on_way) return out;  // whose stage says the rest
  double neglected = 0;
  for (const Driven* d : at)
    if (d != nullptr) neglected = std::max(neglected, d->neglected);
  const bool profiled = std::ranges::any_of(zones, [](const DrivenZone& zone) { return !zone.is_even; });
  out.push_back(profiled
                    ? fmt::format("probabilities worked out for each particle: profiles in steps, to 1e-8 "
                                  "down to {:.4g} m/s; all else exact",
                                  1 / driven.largest_slowness)
                    : "probabilities worked out for each particle, exact at every speed");
  if (neglected > 0)
    out.push_back("rotating-wave approximation, with the shifts by the rest to third order: " +
                  left_out(neglected));
  return out;
}

}  // namespace rabiline
