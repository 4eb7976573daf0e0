// Fields that drive spins of one moment: those that do nothing, and what their approximations leave out.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "plan/plan.hpp"
#include "plan/stretches.hpp"
#include "plan/zones.hpp"
#include "rules/warning_room.hpp"
#include "transport/describe_outlook.hpp"
#include "transport/mean_flight.hpp"

namespace rabiline {
namespace {

using constants::two_pi;

/// A field with a clock, alone in a zone, as one species sees it.
struct Drive {
  const PlacedPart* part;
  SpinZone zone;
  double speed;               // [m/s] of the species
  double rotation, coupling;  // [rad/s] of the field at that speed, and of the spin about it
  double width() const { return speed / (zone.end - zone.begin); }  // [Hz] 1/T
  double larmor() const { return zone.spin_rate; }                  // [rad/s] signed, like `rotation`
  bool turns_one_way() const { return zone.kind == ZoneKind::rotating || zone.kind == ZoneKind::profiled; }
};

bool is_on(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.oscillator; }) return any.amplitude != 0;
        return false;
      },
      part);
}

/// [rad/s] The rate of a drive that comes nearest to the precession, of those that it sweeps through.
double nearest_rotation(const SpinZone& zone) {
  const double from = zone.drive[0].omega, to = from + swept_in_all(zone.drive[0]);
  return std::clamp(zone.spin_rate, std::min(from, to), std::max(from, to));
}

/// Of 0 Hz only where asked for.
std::vector<Drive> drives_of(const Beamline& beamline, const Species& species, bool even_still = false) {
  std::vector<Drive> out;
  const ZoneMaker maker = zone_maker(beamline, species);
  const MeanFlight flight = mean_flight(beamline, species.mass);
  for (const Section& section : sections_of(beamline).sections) {
    const double speed = flight.speed_between(section.begin, section.end);
    if (!section.shaped.empty()) continue;  // static fields that the zone does not know
    const SpinZone zone = maker.zone_of(section);
    if (zone.drives != 1 || (zone.drive[0].omega == 0 && !even_still)) continue;
    const double middle = (section.begin + section.end) / 2;
    for (const PlacedPart& part : beamline.parts)
      if (is_on(part.part) && part.placement.at < middle && middle < end_of(part))
        out.push_back({&part, zone, speed, nearest_rotation(zone) + zone.drive[0].twist * speed,
                       std::abs(zone.drive[0].spin_rate)});
  }
  return out;
}

/// Those that fly with one moment.
std::vector<const Species*> points_of(const Beamline& beamline) {
  std::vector<const Species*> out;
  for (const Component& component : beamline.species)
    if (!is_quantum(beamline) || !component.species.structure) out.push_back(&component.species);
  return out;
}

/// It flips less than a hundredth of what it would on resonance: w1^2/(w1^2 + detuning^2) at most, against
/// sin^2(w1 T/2), or 1 where that turns the spin by half a turn and more (I. I. Rabi, Phys. Rev. 51 (1937)
/// 652).
bool is_far(const Drive& d) {
  const double detuning = std::abs(d.rotation) - std::abs(d.larmor()), half_turn = std::numbers::pi / 2;
  const double on_resonance = portable::sin(std::min(d.coupling / d.width() / 2, half_turn));
  const double flips = d.coupling * d.coupling / (d.coupling * d.coupling + detuning * detuning);
  return flips < 0.01 * on_resonance * on_resonance;
}
bool turns_against(const Drive& d) { return d.turns_one_way() && d.rotation * d.larmor() < 0; }

std::string hertz(double omega) { return pretty_quantity(std::abs(omega) / two_pi, Dimension::frequency); }

/// The part whose clock it is that a field turns by.
const std::string& owner_of_clock(const PlacedPart& part) {
  const std::string* clock = clock_of(part.part);
  return clock ? *clock : part.placement.name;
}

/// Of a field that turns against the precession: what turns it round.
Fault fault_of_sense(const Beamline& beamline, const PlacedPart& part, bool so_is_its_clock) {
  const std::string &name = part.placement.name, &owner = owner_of_clock(part);
  std::string message =
      fmt::format("the field of `{}` turns against the precession there and cannot be resonant", name);
  if (!so_is_its_clock)
    return warning(name, "oscillator", std::move(message),
                   fmt::format("spins precess the other way at `{}`, whose clock it follows: give `{}` a "
                               "`frequency` and a `sense` of its own, and omit `oscillator`",
                               owner, name));
  const auto* clock = std::get_if<RotatingField>(&find_part(beamline, owner)->part);
  const auto help = [](std::optional<Sense> sense) -> std::string_view {
    switch (sense.value_or(Sense::co)) {
      case Sense::co:
        return "write `sense: counter`: `co` is for a field along +z, and here it is along -z";
      case Sense::counter:
        return "write `sense: co`";
      case Sense::positive:
        return "write `sense: negative`";
      case Sense::negative:
        break;
    }
    return "write `sense: positive`";
  };
  return warning(owner, "sense", std::move(message), std::string(help(clock ? clock->sense : std::nullopt)));
}

/// A field with a clock, as all species together see it.
struct Idle {
  const PlacedPart* part;
  const Drive* nearest;                           // to its resonance
  bool far = true, against = true, along = true;  // the last: along the static field, where it turns nothing
};
std::vector<Idle> judged(const std::vector<Drive>& drives, const Beamline& beamline) {
  const auto distance = [](const Drive& d) { return std::abs(std::abs(d.rotation) - std::abs(d.larmor())); };
  std::vector<Idle> out;
  for (const PlacedPart& part : beamline.parts) {
    Idle idle{&part, nullptr};
    for (const Drive& d : drives) {
      if (d.part != &part) continue;
      idle.far = idle.far && is_far(d);
      idle.against = idle.against && turns_against(d);
      idle.along = idle.along && d.coupling == 0 && d.larmor() != 0;
      if (!idle.nearest || distance(d) < distance(*idle.nearest)) idle.nearest = &d;
    }
    if (idle.nearest) out.push_back(idle);
  }
  return out;
}

}  // namespace

Faults idle_drives_of(const Beamline& beamline) {
  std::vector<Drive> drives;
  for (const Species* species : points_of(beamline))
    for (const Drive& drive : drives_of(beamline, *species)) drives.push_back(drive);
  const std::vector<Idle> all = judged(drives, beamline);
  Faults out;
  const auto tell_once = [&](Fault fault) {
    if (std::ranges::none_of(
            out, [&](const Fault& f) { return f.subject == fault.subject && f.key == fault.key; }))
      out.push_back(std::move(fault));
  };
  for (const Idle& idle : all) {
    const std::string& name = idle.part->placement.name;
    const std::string& owner = owner_of_clock(*idle.part);
    const Drive& nearest = *idle.nearest;
    if (idle.along)
      tell_once(warning(name, "direction",
                        fmt::format("`{}` swings along the static field there, and turns no spins", name),
                        "let it swing across that field, along x where the field is along z"));
    else if (idle.far && nearest.larmor() == 0)
      tell_once(warning(name, "at",
                        fmt::format("`{}` stands where there is no static field for spins to precess in, and "
                                    "cannot be resonant",
                                    name),
                        "let a static field, such as a `uniform_field`, reach over it"));
    else if (idle.far)
      tell_once(
          warning(owner, "frequency",
                  fmt::format("`{}` at {} is far from every resonance: spins precess at {} there, 1/T is {}",
                              name, hertz(nearest.rotation), hertz(nearest.larmor()),
                              pretty_quantity(nearest.width(), Dimension::frequency)),
                  "is one of the units wrong?"));
    else if (idle.against)
      tell_once(fault_of_sense(beamline, *idle.part, std::ranges::all_of(all, [&](const Idle& other) {
                                 return other.against || other.part->placement.name != owner;
                               })));
  }
  return out;
}

Faults endless_turns_of(const Beamline& beamline) {
  Faults out;
  for (const Species* species : points_of(beamline))
    for (const Drive& d : drives_of(beamline, *species)) {
      const bool is_near = std::abs(std::abs(d.rotation) - std::abs(d.larmor())) < d.coupling;
      const double turns = d.coupling / two_pi / d.width();
      if (d.turns_one_way() && is_near && turns > most_turns && swept_in_all(d.zone.drive[0]) == 0)
        out.push_back(fault_of_turns(d.part->placement.name, turns, "the spins"));
    }
  return out;
}

Faults missed_resonances_of(const ScanPoints& points) {
  struct Missed {
    std::string owner;
    Approach approach;                 // [rad/s] of |rotation| to |precession|
    double precession = 0, width = 0;  // [rad/s, Hz] where it is nearest
  };
  std::map<std::string, Missed> drives;
  constexpr std::size_t most = 256;
  constexpr double golden = 0.61803398874989485;  // of all points some that are even in every axis of a grid
  for (std::size_t i = 0; i < std::min(points.size(), most); ++i) {
    const double share = static_cast<double>(i) * golden;
    const Beamline point =
        points[points.size() <= most ? i
                                     : static_cast<std::size_t>((share - std::floor(share)) *
                                                                static_cast<double>(points.size()))];
    for (const Species* species : points_of(point))
      for (const Drive& d : drives_of(point, *species)) {
        Missed& all = drives[d.part->placement.name];
        all.owner = owner_of_clock(*d.part);
        all.approach.is_met = all.approach.is_met || d.larmor() == 0;
        if (!all.approach.look_at(std::abs(d.rotation) - std::abs(d.larmor()),
                                  std::max(two_pi * d.width(), d.coupling)))
          continue;
        all.precession = d.larmor();
        all.width = d.width();
      }
  }
  Faults out;
  for (const auto& [name, all] : drives)
    if (all.approach.keeps_off() && all.approach.moves())
      out.push_back(warning(
          all.owner, "frequency",
          fmt::format("no scan point is near the resonance of `{}`: the nearest is {} away from the {} at "
                      "which spins precess there, and 1/T is {}",
                      name, hertz(all.approach.nearest), hertz(all.precession),
                      pretty_quantity(all.width, Dimension::frequency)),
          "scan over the resonance, or is one of the units wrong?"));
  return out;
}

bool is_driven(const Beamline& beamline, const Fault& fault) {
  return std::ranges::any_of(beamline.parts, [&](const PlacedPart& part) {
    return is_on(part.part) &&
           (part.placement.name == fault.subject || owner_of_clock(part) == fault.subject);
  });
}

namespace {

/// The rotating-wave approximation of an oscillating field, where its other half is not small.
void judge_rotating_wave(const Beamline& beamline, const Species& species, Faults& out) {
  for (const Drive& d : drives_of(beamline, species, true)) {
    const bool approximated = std::visit(
        [](const auto& any) {
          if constexpr (requires { any.approximation; })
            return any.approximation == Approximation::rotating_wave;
          return false;
        },
        d.part->part);
    const std::string& name = d.part->placement.name;
    if (!approximated) continue;
    if (d.zone.drive[0].omega == 0)
      out.push_back(
          warning(name, "approximation",
                  fmt::format("`{}` does not swing: at 0 Hz the rotating-wave approximation leaves half "
                              "of its field, which stands still",
                              name),
                  "write `approximation: none`, or a `uniform_field`"));
    else if (d.larmor() == 0)
      out.push_back(warning(name, "approximation",
                            fmt::format("`{}` is used in the rotating-wave approximation where there is no "
                                        "static field for spins to precess in",
                                        name),
                            "write `approximation: none`"));
    else if (const double share = d.coupling / std::abs(d.larmor()); share > 0.1)
      out.push_back(
          warning(name, "approximation",
                  fmt::format("the rotating-wave approximation of `{}` is poor: the half of its field that "
                              "turns with the spins is {:.2g} of the static field",
                              name, share),
                  "`approximation: none` integrates the whole field", share));
    else if (const double shift = std::abs(d.larmor()) / two_pi * share * share / 4; shift > d.width())
      out.push_back(warning(
          name, "approximation",
          fmt::format(
              "what the rotating-wave approximation of `{}` leaves out would shift the resonance by {}, more "
              "than the line's width, 1/T = {}",
              name, pretty_quantity(shift, Dimension::frequency),
              pretty_quantity(d.width(), Dimension::frequency)),
          "`approximation: none` takes the whole field", share));
  }
}

bool across_z(const std::optional<UnitVector>& axis) { return axis && (axis->x != 0 || axis->y != 0); }

/// Whether spins lie across the field behind a part: a drive, a coil, a filter or a source across z.
bool tips(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.oscillator; }) return any.amplitude != 0;
        if constexpr (requires { any.angle; }) return any.angle != 0 && across_z(any.axis);
        if constexpr (requires { any.up; }) return across_z(any.axis);
        return false;
      },
      part);
}
bool starts_across(const StartSpin& spin) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.axis; }) return across_z(any.axis);
        return false;
      },
      spin);
}
/// Whether a part asks for a phase: by a second drive, or across z.
bool needs_phase(const Part& part) {
  const std::vector<Tally>* tallies = tallies_of(part);
  return tips(part) || (tallies && std::any_of(tallies->begin(), tallies->end(), [](const Tally& tally) {
                          return std::any_of(tally.axes.begin(), tally.axes.end(), [](const TallyAxis& axis) {
                            return across_z(axis.axis) || axis.quantity == Quantity::spin_azimuth;
                          });
                        }));
}

/// The gradient of a deflecting magnet acts on paths, not on the phases of spins that differ over the beam.
void judge_gradients(const Beamline& beamline, Faults& out) {
  if (!law_traits(beamline.law).has_forces) return;
  for (const Plane& plane : sections_of(beamline).planes) {  // those that are not among other fields
    if (!std::holds_alternative<MagnetTerm>(plane.term)) continue;
    const PlacedPart& magnet = beamline.parts[static_cast<std::size_t>(plane.part)];
    const PlacedPart *before = nullptr, *behind = nullptr;
    for (const PlacedPart& part : beamline.parts) {
      if (end_of(part) <= magnet.placement.at + 1e-12 && tips(part.part)) before = &part;
      if (part.placement.at >= end_of(magnet) - 1e-12 && needs_phase(part.part) && !behind) behind = &part;
    }
    if ((!before && !starts_across(beamline.source.spin)) || !behind) continue;
    const std::string& name = magnet.placement.name;
    out.push_back(warning(
        name, "kind",
        fmt::format(
            "`{}` stands between {} and `{}`, where the phase of the spins matters: its gradient is "
            "not integrated into that phase, and {}",
            name, before ? fmt::format("`{}`", before->placement.name) : "the source", behind->placement.name,
            is_quantum(beamline) ? "each particle is in one level behind it, so that no fringes remain"
                                 : "all spins precess as on the axis"),
        "put it in front of what tips the spins, or behind what asks for them"));
  }
}

/// Atoms that stay coherent where their paths come apart; where they are sorted the stage says so.
void judge_coherence(const Beamline& beamline, const Species& atom, Faults& out) {
  const Sections sections = sections_of(beamline);
  for (const Stretch& stretch : stretches_of(beamline, atom, sections)) {
    if (!stretch.outlook.between || stretch.outlook.sorts) continue;
    for (const Section& section : sections.sections)
      if (section.begin >= stretch.begin && section.end <= stretch.end && !section.shaped.empty()) {
        const auto part = static_cast<std::size_t>(section.shaped.front().part);
        out.push_back(
            warning(beamline.parts[part].placement.name, "kind", describe_between(stretch.outlook)));
        break;
      }
  }
}

/// Drives of atoms in no field: nothing there tells the levels of one F apart, or along which axis they are.
void judge_fieldless(const Beamline& beamline, const Species& atom, Faults& out) {
  const ZoneMaker maker = zone_maker(beamline, atom);
  std::vector<const PlacedPart*> told;
  for (const Section& section : sections_of(beamline).sections) {
    const SpinZone zone = maker.zone_of(section);
    if (!section.shaped.empty() || zone.drives == 0 || zone.spin_rate != 0 || atom.gyromagnetic_ratio == 0)
      continue;
    const double middle = (section.begin + section.end) / 2;
    for (const PlacedPart& part : beamline.parts) {
      if (!is_on(part.part) || part.placement.at > middle || middle > end_of(part) ||
          std::ranges::find(told, &part) != told.end())
        continue;
      told.push_back(&part);
      const std::string& name = part.placement.name;
      out.push_back(warning(name, "at",
                            fmt::format("`{}` drives atoms where there is no static field: levels of one F "
                                        "have one energy there, and their m is that along z by name alone",
                                        name),
                            "let a static field, such as a `uniform_field`, reach over it"));
    }
  }
}

}  // namespace

Faults approximations_of(const Beamline& beamline) {
  Faults out;
  for (const Component& component : beamline.species)
    if (is_quantum(beamline) && component.species.structure) {
      judge_coherence(beamline, component.species, out);
      judge_fieldless(beamline, component.species, out);
    }
  for (const Species* species : points_of(beamline)) judge_rotating_wave(beamline, *species, out);
  judge_gradients(beamline, out);
  return out;
}

}  // namespace rabiline
