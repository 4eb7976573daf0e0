#include "plan/explain_atoms.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "core/portable_math.hpp"
#include "core/units.hpp"
#include "plan/level_waves.hpp"
#include "spin/level_names.hpp"
#include "spin/levels.hpp"
#include "spin/rotating_frame.hpp"

namespace rabiline {
namespace {

/// A transition that a field can drive: between which levels, and how far it is.
struct Transition {
  int upper = 0, lower = 0;
  double frequency = 0, detuning = 0, rabi = 0;  // [Hz]; detuning of the field from the transition
};

/// Those that the direction of a field and its sense allow, the nearest first.
std::vector<Transition> transitions_near(const Structure& structure, const LevelZone& zone) {
  const CoupledSpins spins = coupled_spins(structure);
  const RotatingTerm& drive = *zone.drive;
  const Levels levels = levels_at(spins, zone.field);
  const DrivenStates states = driven_states(spins, levels, drive);
  const bool swings = sense_of(drive) == 0;
  const double negligible = 1e-14 * states.energy.cwiseAbs().maxCoeff();
  std::vector<Transition> out;
  for (int i = 0; i < spins.levels(); ++i)
    for (int k = 0; k < spins.levels(); ++k) {
      double apart = states.energy(i) - states.energy(k);
      if (std::abs(apart) < negligible) apart = 0;
      const auto upper = static_cast<std::size_t>(i), lower = static_cast<std::size_t>(k);
      const bool turns =
          swings || levels.labels[upper].twice_m - levels.labels[lower].twice_m == 2 * sense_of(drive);
      if (i == k || apart < 0 || (apart == 0 && swings && i > k) || states.coupling(i, k) == 0 || !turns)
        continue;
      out.push_back({i, k, apart, drive.oscillator.frequency - apart,
                     (swings ? 1 : 2) * std::abs(states.coupling(i, k))});
    }
  std::stable_sort(out.begin(), out.end(), [](const Transition& a, const Transition& b) {
    return std::abs(a.detuning) < std::abs(b.detuning);
  });
  return out;
}

/// [Hz] Of each level, by what does not stand still in the field's frame.
Eigen::VectorXd shifts_of(const Structure& structure, const LevelZone& zone) {
  const CoupledSpins spins = coupled_spins(structure);
  const Levels levels = levels_at(spins, zone.field);
  const DrivenStates states = driven_states(spins, levels, *zone.drive);
  const DrivenStates* const alone[] = {&states};
  return standing_coupling(rotating_frame(levels.labels, *zone.drive, alone), states).second.diagonal();
}

bool is_pulsed(const LevelZone& zone) { return zone.drive->gate != Gate{}; }
/// [Hz] 1 over the time for which it drives at a stretch.
double width_of(const LevelZone& zone, double speed) {
  const double passing = speed / (zone.end - zone.begin);
  const Gate& gate = zone.drive->gate;
  return is_pulsed(zone) ? std::max(passing, 1 / (gate.end - gate.begin)) : passing;
}

/// [Hz] About what shifts a line that the approximation leaves out: the fourth order, by what the second
/// does.
struct LeftOutShift {
  double shift = 0, width = 0;
  std::string line{}, field{};
};

/// Where a field is 100 widths and Rabi frequencies away, it flips about 1e-4 at most.
bool is_far(const Transition& t, double width) { return std::abs(t.detuning) > 100 * (width + t.rabi); }

std::string megahertz(double f) {
  return std::abs(f) < 1e5 ? pretty_quantity(f, Dimension::frequency) : fmt::format("{:.10g} MHz", f / 1e6);
}
std::string name_of(const Structure& structure, const Transition& t) {
  const std::vector<std::string> names = names_of_levels(coupled_spins(structure));
  return fmt::format("{} - {}", names[static_cast<std::size_t>(t.upper)],
                     names[static_cast<std::size_t>(t.lower)]);
}
std::string left_out(double neglected) {
  return neglected < 1 ? fmt::format("amplitudes up to {:.2g} are left out", neglected)
                       : "what it leaves out is too strong for that";
}
std::string tesla(double b) { return pretty_quantity(b, Dimension::magnetic_field); }

/// What of a field is along B and leaves m as it is, and what turns right-handed and left-handed about it: m
/// + 1 and m - 1 of the upper level.
std::string parts_of(const RotatingTerm& drive) {
  const double swings = drive.amplitude * portable::hypot(drive.first.x, drive.first.y) / 2;
  const int sense = sense_of(drive);
  const auto sigma = [&](int which) {
    return tesla(sense == 0 ? swings : sense * which > 0 ? drive.amplitude : 0);
  };
  return fmt::format("pi {}, sigma+ {}, sigma- {}",
                     tesla(sense == 0 ? drive.amplitude * std::abs(drive.first.z) : 0), sigma(1), sigma(-1));
}

/// The nearest transitions, a line each: so many, and all within 100 widths where `all`.
void tell_transitions(const Structure& structure, const LevelZone& zone, double width, std::size_t least,
                      bool all, std::vector<std::string>& out) {
  const std::vector<Transition> near = transitions_near(structure, zone);
  const Eigen::VectorXd shifts = shifts_of(structure, zone);
  if (near.empty()) out.emplace_back("    no transition turns with it");
  for (std::size_t i = 0; i < near.size(); ++i) {
    const Transition& t = near[i];
    if (i >= least && !(all && std::abs(t.detuning) <= 100 * width)) break;
    std::string flips;
    if (const double rate = portable::hypot(t.rabi, t.detuning);
        zone.drive->envelope.shape == Shape::rectangular && !is_pulsed(zone) && rate > 0)
      flips = fmt::format(", alone it flips {:.3g}",
                          portable::pow(t.rabi / rate * portable::sin(std::numbers::pi * rate / width), 2));
    const double by = shifts(t.upper) - shifts(t.lower);
    const std::string shift = by == 0 ? ""
                                      : fmt::format("; what turns otherwise shifts it by {}",
                                                    pretty_quantity(by, Dimension::frequency));
    out.push_back(fmt::format("    {} at {}, detuned by {}, Rabi frequency {}{}{}", name_of(structure, t),
                              megahertz(t.frequency), pretty_quantity(t.detuning, Dimension::frequency),
                              pretty_quantity(t.rabi, Dimension::frequency), flips, shift));
  }
}

}  // namespace

std::string headline_of(const Species& atom) {
  const Structure& s = *atom.structure;
  const CoupledSpins spins = coupled_spins(s);
  std::vector<std::pair<double, int>> terms;  // energy and 2F
  for (int twice_f = std::abs(s.i.twice - s.j.twice); twice_f <= s.i.twice + s.j.twice; twice_f += 2)
    terms.emplace_back(zero_field_energy(spins, twice_f), twice_f);
  std::sort(terms.begin(), terms.end());
  std::string apart;
  for (std::size_t i = 1; i < terms.size() && i < 4; ++i)
    apart += fmt::format(", F={} above F={} by {}", write_half(terms[i].second),
                         write_half(terms[i - 1].second), megahertz(terms[i].first - terms[i - 1].first));
  return fmt::format("{}: I = {}, J = {}, {} levels{}", atom.name, write_half(s.i.twice),
                     write_half(s.j.twice), s.levels(), apart);
}

namespace {

/// The field that drives levels there.
std::string name_of(const LevelZone& zone, const Beamline& beamline) {
  if (zone.part >= 0) return beamline.parts[static_cast<std::size_t>(zone.part)].placement.name;
  for (const PlacedPart& part : beamline.parts)
    if (traits_of(part.part).drives && part.placement.at <= zone.begin && zone.begin < end_of(part))
      return part.placement.name;
  return fmt::format("the field at {:.4g} m", zone.begin);
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
    for (const WaveFields& wave : path.way->fields().waves)
      made.neglected = std::max(made.neglected, wave.frame.neglected);
  } else {
    const SampledTables::Driven& tabled = plan_.tables->driven_by(path.transitions);
    made.neglected = tabled.levels.neglected();
    made.largest_slowness = tabled.largest_slowness;
    std::ranges::copy_if(tabled.zones, std::back_inserter(made.zones),
                         [](const LevelZone& zone) { return zone.drive.has_value(); });
  }
  for (const LevelZone& zone : made.zones) made.names.push_back(name_of(zone, beamline));
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

double DrivenParts::speed_at(std::size_t point, int component) {
  const Beamline& beamline = beamline_at(static_cast<int>(point));
  return mean_speed(beamline.source.speed,
                    beamline.species[static_cast<std::size_t>(component)].species.mass);
}

void DrivenParts::add_zone(std::size_t number, const std::vector<const Driven*>& at, double speed,
                           std::vector<std::string>& out) const {
  const std::size_t last = at.size() - 1;
  const LevelZone* before = nullptr;
  for (const std::size_t point : std::set<std::size_t>{0, last / 2, last}) {
    if (at[point] == nullptr || number >= at[point]->zones.size()) continue;
    const LevelZone& zone = at[point]->zones[number];
    if (before && *before == zone) continue;
    before = &zone;
    const double width = width_of(zone, speed);
    out.push_back(fmt::format("at B = {}{}{}: {}, width {} {}", tesla(zone.field),
                              at[point]->on_way ? ", where a line is nearest" : "",
                              last == 0 ? "" : fmt::format(", scan point {}", point + 1),
                              megahertz(zone.drive->oscillator.frequency),
                              is_pulsed(zone) ? "of a pulse" : "v/L",
                              pretty_quantity(width, Dimension::frequency)));
    if (point == 0) out.push_back(fmt::format("    its parts about B: {}", parts_of(*zone.drive)));
    tell_transitions(at[point]->structure, zone, width, point == 0 ? 3 : 1, point == 0, out);
  }
}

std::vector<std::string> DrivenParts::lines(int component, int part, double speed) const {
  std::vector<std::string> out;
  const auto found = parts_.find(
      {component, experiment_.points.front().parts[static_cast<std::size_t>(part)].placement.name});
  if (found == parts_.end()) return out;
  const std::vector<const Driven*>& at = found->second;
  const auto first = std::find_if(at.begin(), at.end(), [](const Driven* d) { return d != nullptr; });
  const Driven& driven = **first;
  std::vector<std::vector<std::string>> told;
  const std::vector<LevelZone>& zones = driven.zones;
  for (std::size_t i = 0; i < zones.size(); ++i) {
    told.emplace_back();
    add_zone(i, at, speed, told.back());
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
  const bool profiled = std::ranges::any_of(
      zones, [](const LevelZone& zone) { return zone.drive->envelope.shape != Shape::rectangular; });
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

std::vector<Fault> DrivenParts::warnings() {
  std::vector<Fault> out;
  const auto add = [&](const std::string& subject, const char* key, std::string text, std::string help = {}) {
    if (std::none_of(out.begin(), out.end(), [&](const Fault& f) { return f.message == text; }))
      out.push_back({subject, key, std::move(text), std::move(help), Severity::warning});
  };
  struct Best {
    std::vector<Transition> near{};
    double distance = 0;  // in widths and Rabi frequencies
    const LevelZone* zone = nullptr;
    const std::string* name = nullptr;  // of its field
    const Structure* structure = nullptr;
  };
  std::set<std::string> useful;  // fields that drive some species of the beam
  std::vector<Best> all;
  for (const auto& [where, at] : parts_) {
    const auto& [component, name] = where;
    std::vector<Best> best;
    const Driven* before = nullptr;
    const Driven* worst = nullptr;
    LeftOutShift most;
    for (std::size_t point = 0; point < at.size(); ++point) {
      const Driven* driven = at[point];
      if (driven == nullptr || std::exchange(before, driven) == driven) continue;
      if (worst == nullptr || driven->neglected > worst->neglected) worst = driven;
      const std::vector<LevelZone>& zones = driven->zones;
      best.resize(std::max(best.size(), zones.size()));
      for (std::size_t i = 0; i < zones.size(); ++i) {
        const std::string& field = driven->names[i];
        const double width = width_of(zones[i], speed_at(point, component));
        std::vector<Transition> near = transitions_near(driven->structure, zones[i]);
        const Eigen::VectorXd shifts = shifts_of(driven->structure, zones[i]);
        for (const Transition& t : near) {
          if (is_far(t, width)) continue;
          useful.insert(field);
          const double shift =
              std::abs(shifts(t.upper) - shifts(t.lower)) * driven->neglected * driven->neglected;
          if (shift > width && shift * most.width >= most.shift * width)
            most = {shift, width, name_of(driven->structure, t), field};
        }
        if (useful.contains(field)) continue;
        const double distance = near.empty() ? HUGE_VAL : std::abs(near.front().detuning);
        if (best[i].zone && distance >= best[i].distance) continue;
        best[i] = {std::move(near), distance, &zones[i], &field, &driven->structure};
      }
    }
    std::ranges::move(best, std::back_inserter(all));
    if (worst != nullptr && worst->neglected > 0.1)
      add(worst->names.front(), "amplitude",
          fmt::format("the rotating-wave approximation of `{}` is poor: {}",
                      fmt::join(std::set(worst->names.begin(), worst->names.end()), "` and `"),
                      left_out(worst->neglected)),
          "a smaller field helps, or one that turns: a `rotating_field`");
    else if (most.shift > 0)
      add(most.field, "approximation",
          fmt::format(
              "what the rotating-wave approximation of `{}` leaves out would shift {} by about {}, more "
              "than the line's width, {}",
              most.field, most.line, pretty_quantity(most.shift, Dimension::frequency),
              pretty_quantity(most.width, Dimension::frequency)),
          "`approximation: none` takes the whole field");
  }
  for (const Best& b : all) {
    if (b.zone == nullptr || useful.contains(*b.name)) continue;
    std::string list;
    for (std::size_t i = 0; i < b.near.size() && i < 3; ++i)
      list += fmt::format("{}{} at {}", i == 0 ? "" : ", ", name_of(*b.structure, b.near[i]),
                          megahertz(b.near[i].frequency));
    add(*b.name, "frequency",
        fmt::format("`{}` drives no transition{}: at B = {} and {}, nearest are {}", *b.name,
                    experiment_.axes.empty() ? "" : " at any scan point", tesla(b.zone->field),
                    megahertz(b.zone->drive->oscillator.frequency), list.empty() ? "none" : list));
  }
  return out;
}

std::string field_free_gaps(const Beamline& beamline) {
  std::vector<std::pair<double, double>> fields;
  for (const PlacedPart& part : beamline.parts)
    if (holds_spins(part.part)) fields.emplace_back(part.placement.at, end_of(part));
  for (const Section& section : sections_of(beamline).sections)
    if (section.has_shaped_fields()) fields.emplace_back(section.begin, section.end);
  std::sort(fields.begin(), fields.end());
  std::string gaps;
  double reach = fields.empty() ? 0 : fields.front().second;
  for (const auto& [begin, end] : fields) {
    if (begin > reach + 1e-9)
      gaps += fmt::format("{}{:.4g} to {:.4g} m", gaps.empty() ? "" : ", ", reach, begin);
    reach = std::max(reach, end);
  }
  return gaps;
}

std::vector<int> all_levels(const Species& species) {
  std::vector<int> levels(static_cast<std::size_t>(species.levels()));
  std::iota(levels.begin(), levels.end(), 0);
  return levels;
}

std::vector<int> levels_on_axis(const Source& source, const Species& species, const Law& law) {
  if (!law_traits(law).has_levels || source.offset != Offset{} || !(source.tilt == SourceTilt{})) return {};
  const auto* named = std::get_if<LevelsSpin>(&source.spin);
  if (!named || !species.structure) return all_levels(species);
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(*species.structure));
  std::set<int> levels;
  for (const LevelName& name : named->levels)
    if (const auto level = find_level(labels, name)) levels.insert(*level);
  return {levels.begin(), levels.end()};
}

std::vector<Fault> warnings_of_atoms(const Experiment& experiment, const Plan& plan) {
  return DrivenParts(experiment, plan).warnings();
}

}  // namespace rabiline
