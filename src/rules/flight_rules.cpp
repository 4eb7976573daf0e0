// What only the fields as each species sees them tell: how far phases are known, and what drives levels.
#include <algorithm>
#include <numbers>
#include <span>

#include "plan/level_history.hpp"
#include "plan/level_ways.hpp"
#include "plan/plan.hpp"
#include "plan/spin_history.hpp"
#include "plan/tally_plan.hpp"
#include "rules/room.hpp"
#include "section/magnet_field.hpp"

namespace rabiline {
namespace {

/// The fields that reach over a place; `of_drives`: those with a clock alone, where there are any.
std::vector<const PlacedPart*> fields_at(const Beamline& beamline, double y, bool of_drives) {
  std::vector<const PlacedPart*> out;
  for (const PlacedPart& part : beamline.parts) {
    const PartTraits traits = traits_of(part.part);
    if ((of_drives ? traits.drives : traits.field) && part.placement.at <= y && y < end_of(part))
      out.push_back(&part);
  }
  return of_drives && out.empty() ? fields_at(beamline, y, false) : out;
}

/// Every kernel has room for so many fields at one place.
void check_overlaps(const Beamline& beamline, const Sections& sections, Faults& out) {
  for (const Section& section : sections.sections) {
    const std::size_t drives = section.rotating.size() + section.swinging.size();
    if (drives <= static_cast<std::size_t>(most_drives)) continue;
    const double y = (section.begin + section.end) / 2;
    out.push_back(
        {section.swinging.empty()
             ? fields_at(beamline, y, false).back()->placement.name
             : beamline.parts[static_cast<std::size_t>(section.swinging.back().field.part)].placement.name,
         "at",
         fmt::format("{} alternating or turning fields overlap from {} to {}, and {} are the most", drives,
                     metres(section.begin), metres(section.end), most_drives),
         "move one of them along the beam"});
    return;
  }
}

/// Magnets, filters, detectors and tallies of spins ask what fields have done.
bool asks_for_spin(const Plane& plane) {
  return std::visit(
      [](const auto& term) {
        using Term = std::decay_t<decltype(term)>;
        if constexpr (std::is_same_v<Term, MonitorTerm>)
          return std::any_of(term.tallies.begin(), term.tallies.end(),
                             [](const Tally& tally) { return asks_for_spin(tally); });
        return std::is_same_v<Term, MagnetTerm> || std::is_same_v<Term, ScreenTerm> ||
               std::is_same_v<Term, FilterTerm>;
      },
      plane.term);
}
/// Whether it asks for anything but levels along z.
bool asks_across_z(const Plane& plane) {
  return std::visit(
      [](const auto& term) {
        if constexpr (requires { term.tallies; }) {
          for (const Tally& tally : term.tallies)
            for (const TallyAxis& axis : tally.axes)
              if (axis.axis && (axis.axis->x != 0 || axis.axis->y != 0)) return true;
          return false;
        }
        if constexpr (std::is_same_v<std::decay_t<decltype(term)>, MagnetTerm>) return spin_axis(term).x != 0;
        return std::is_same_v<std::decay_t<decltype(term)>, FilterTerm>;
      },
      plane.term);
}

/// The fields whose phases the spins of a species need: of a straight flight those before each question, else
/// all that turn the path.
std::vector<SpinZone> zones_needed(const Beamline& beamline, const Species& species, const Sections& sections,
                                   const ZoneMaker& zones) {
  std::vector<SpinZone> out;
  if (turning_of(beamline.law, species).rate_per_tesla != 0) {
    for (const Section& section : sections.sections) out.push_back(zones.zone_of(section));
    return out;
  }
  const SpinHistory spins(sections, zones, beamline.source, stretches_of(beamline, species, sections));
  for (const Plane& plane : sections.planes) {
    if (!asks_for_spin(plane)) continue;
    const std::vector<SpinZone> before = is_quantum(beamline) && !asks_across_z(plane)
                                             ? spins.zones_before_levels(plane, {})
                                             : spins.zones_before(plane);
    out.insert(out.end(), before.begin(), before.end());
  }
  return out;
}

void check_phases(const Beamline& beamline, const Species& species, const Sections& sections, Faults& out) {
  const ZoneMaker zones = zone_maker(beamline, species);
  for (const SpinZone& zone : zones_needed(beamline, species, sections, zones)) {
    const double phase = zones.phase_behind(zone);
    if (phase <= most_phase) continue;
    const PlacedPart& part = *fields_at(beamline, (zone.begin + zone.end) / 2, zone.drives > 0).back();
    const std::string atom = atom_called(species);
    out.push_back(
        {part.placement.name, traits_of(part.part).drives ? "frequency" : "field",
         fmt::format("{} would turn by {:.2g} radians before a particle leaves the field at {}: more "
                     "than {:.0e}, beyond which its phase is no longer known",
                     species.name, phase, metres(zone.end), most_phase),
         "make the field or the frequency smaller, or the particles faster" +
             (atom.empty() ? atom : fmt::format(", or fly `{}`, which has levels", atom))});
    return;
  }
}

/// Where spins are carried in steps that keep the law's tolerance.
void check_steps(const Beamline& beamline, const Species& species, const Sections& sections, Faults& out) {
  const ZoneMaker zones = zone_maker(beamline, species);
  for (SpinZone& zone : zones_needed(beamline, species, sections, zones)) {
    zones.keep_tolerance(zone);
    const double steps = zone.step > 0 ? (zone.end - zone.begin) / zones.speed() / zone.step : 0;
    if (steps <= most_spin_steps) continue;
    const std::string& name = fields_at(beamline, (zone.begin + zone.end) / 2, true).back()->placement.name;
    out.push_back({name, "at",
                   fmt::format("a spin of {} would take {:.2g} steps from {} to {} to keep the law's "
                               "tolerance of {:g}, and {:.0e} "
                               "are the most in one field",
                               species.name, steps, metres(zone.begin), metres(zone.end),
                               law_traits(beamline.law).tolerance, most_spin_steps),
                   "a looser `tolerance` of the law, or a field that is slower, weaker or shorter"});
    return;
  }
}

/// Whether a species' levels are sorted on a stretch.
bool sorts_levels(const Beamline& beamline, const Sections& sections, const Stretch& stretch) {
  return std::ranges::any_of(beamline.species, [&](const Component& component) {
    return std::ranges::any_of(stretches_of(beamline, component.species, sections),
                               [&](const Stretch& s) { return s.begin == stretch.begin && s.outlook.sorts; });
  });
}

/// Gas somewhere on a stretch, which scatters as a whole where that begins.
const PlacedPart* gas_in(const Beamline& beamline, const Stretch& stretch) {
  constexpr double rounding = 1e-12;  // [m]
  for (const PlacedPart& part : beamline.parts)
    if (std::holds_alternative<GasCell>(part.part) && part.placement.at < stretch.end - rounding &&
        end_of(part) > stretch.begin + rounding)
      return &part;
  return nullptr;
}

bool has_reach(const Part& part) {
  return std::visit(
      [](const auto& any) {
        return requires { any.reach; };
      },
      part);
}

/// What stands in a field that differs from place to place may be passed both ways; where levels are sorted,
/// nothing may stand, and nothing may drive them.
void check_stepped(const Beamline& beamline, const Sections& sections, Faults& out) {
  const auto part = [&](int number) -> const PlacedPart& {
    return beamline.parts[static_cast<std::size_t>(number)];
  };
  const bool atoms = is_quantum(beamline) && std::ranges::all_of(beamline.species, [](const Component& c) {
                       return c.species.structure.has_value();
                     });
  for (const Stretch& stretch : stretches_of(sections)) {
    const bool sorts = sorts_levels(beamline, sections, stretch);
    const std::string* field = nullptr;  // none where gravity alone asks for steps
    for (const Section& section : sections.sections) {
      if (!section.needs_steps() || section.begin < stretch.begin || section.end > stretch.end) continue;
      const int number = !section.shaped.empty()     ? section.shaped.front().part
                         : !section.swinging.empty() ? section.swinging.front().field.part
                         : !section.electric.empty() ? section.electric.front().part
                                                     : chamber_number;
      if (field == nullptr && number != chamber_number) field = &part(number).placement.name;
      if (!sorts || (section.rotating.empty() && section.swinging.empty())) continue;
      const std::string& drive =
          section.swinging.empty()
              ? fields_at(beamline, (section.begin + section.end) / 2, true).front()->placement.name
              : part(section.swinging.front().field.part).placement.name;
      out.push_back(
          {drive, "at",
           field == nullptr
               ? fmt::format("`{}` acts where paths are followed level by level, as gravity acts along the "
                             "beam and a magnet sorts them, and they cannot be driven at the same time",
                             drive)
               : fmt::format("`{}` acts where the field of `{}` sorts the levels by its gradient, and they "
                             "cannot be driven at the same time",
                             drive, *field),
           field == nullptr ? "let gravity act across the beam" : "move it out of that field"});
      return;
    }
    if (atoms && !sorts) continue;  // they fly straight
    for (const Plane& plane : sections.planes) {
      if (plane.y <= stretch.begin || plane.y >= stretch.end) continue;
      const bool both_ways =
          std::holds_alternative<PlateTerm>(plane.term) || std::holds_alternative<ScreenTerm>(plane.term) ||
          std::holds_alternative<MonitorTerm>(plane.term) || std::holds_alternative<AlignTerm>(plane.term);
      const PlacedPart& inside = part(plane.part);
      if (both_ways && !sorts) {
        if (const PlacedPart* gas = gas_in(beamline, stretch)) {
          out.push_back(
              {gas->placement.name, "at",
               fmt::format("`{}` stands in the gas `{}`, which acts at once where {} begins ({} to {})",
                           inside.placement.name, gas->placement.name,
                           field == nullptr
                               ? std::string("the flight under gravity along the beam")
                               : fmt::format("the field of `{}`, which is followed along each path,", *field),
                           metres(stretch.begin), metres(stretch.end)),
               fmt::format("end the gas in front of that, or move `{}` out of it", inside.placement.name)});
          return;
        }
        continue;
      }
      out.push_back(
          {inside.placement.name, "at",
           field == nullptr
               ? fmt::format("`{}` can be passed in one direction only, and gravity along the beam may turn "
                             "particles back",
                             inside.placement.name)
               : fmt::format("`{}` stands in the field of `{}`, which {} ({} to {})", inside.placement.name,
                             *field,
                             sorts ? "sorts the levels by its gradient" : "is followed along each path",
                             metres(stretch.begin), metres(stretch.end)),
           field == nullptr ? "omit it, or let gravity act across the beam"
           : has_reach(find_part(beamline, *field)->part)
               ? fmt::format("move it out of the field, or let `reach` end that of `{}` before it", *field)
               : "move it out of the field"});
      return;
    }
  }
}

SpinHistory history_of(const Beamline& beamline, const Species& atom, const Sections& sections,
                       const ZoneMaker& zones) {
  return {sections, zones, beamline.source,
          flown_in_steps(stretches_of(beamline, atom, sections), beamline.law, atom)};
}

/// The drive that acts on levels in a section.
std::string drive_at(const Beamline& beamline, const CourseSection& section) {
  return fields_at(beamline, (section.field.begin + section.field.end) / 2, true).back()->placement.name;
}

/// The key by which a field that differs from place to place swings.
std::string key_of_swing(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.formula.box.frequency; })
          if (any.formula.box.frequency) return "formula.frequency";
        return "oscillates";
      },
      part);
}

/// Of what swings too often on a way, by the fastest of its fields.
Fault fault_of_cycles(const Beamline& beamline, const Species& atom, const LevelFields& fields,
                      double cycles) {
  const auto fault = [&](const std::string& name, std::string key, std::string help) {
    return Fault{name, std::move(key),
                 fmt::format("`{}` swings {:.3g} times while the levels of `{}` pass fields without a closed "
                             "form, and {:.0e} times are the most for a whole field",
                             name, cycles, atom.name, most_cycles),
                 std::move(help)};
  };
  const CourseSection& section = *std::ranges::max_element(fields.sections, {}, &CourseSection::fastest);
  const std::span drives(section.field.drive, static_cast<std::size_t>(section.field.drives));
  const auto fastest =
      std::ranges::max_element(drives, {}, [](const DriveTerm& drive) { return std::abs(drive.omega); });
  for (int i = section.shaped_begin; i < section.shaped_end; ++i) {
    const ShapedTerm& term = fields.shaped[static_cast<std::size_t>(i)];
    if (term.drive != fastest - drives.begin()) continue;
    const PlacedPart& part = beamline.parts[static_cast<std::size_t>(term.part)];
    return fault(part.placement.name, key_of_swing(part.part),
                 "make it slower or shorter, or drive by an `oscillating_field`, which may be taken in the "
                 "rotating-wave approximation");
  }
  return fault(drive_at(beamline, section), "approximation",
               "write `approximation: rotating_wave`, or give it one size and a uniform static field");
}

/// Where fields are followed in steps, each period takes many; and a frame has one frequency.
void check_cycles(const Beamline& beamline, const Species& atom, const Sections& sections, Faults& out) {
  const ZoneMaker zones = zone_maker(beamline, atom);
  const SpinHistory spins = history_of(beamline, atom, sections, zones);
  for (const Plane& plane : sections.planes) {
    const double known = spins.known_before(plane);
    if (!asks_for_spin(plane) || !needs_way(sections.sections, known, plane.y)) continue;
    const LevelFields fields = level_fields(beamline, atom, sections.sections, known, plane.y);
    double cycles = 0;
    for (const CourseSection& section : fields.sections) cycles += cycles_in(section, zones.speed());
    if (cycles > most_cycles) return out.push_back(fault_of_cycles(beamline, atom, fields, cycles));
    for (const CourseSection& section : fields.sections) {
      if (section.wave < 0) continue;
      const WaveFields& wave = fields.waves[static_cast<std::size_t>(section.wave)];
      const double time = (section.field.end - section.field.begin) / zones.speed();
      for (const DriveTerm& drive : wave.drives) {
        const double other = std::abs(drive.omega) / (2 * std::numbers::pi);
        if (std::abs(other - wave.frequency) * time <= most_cycles) continue;
        const std::string name = drive_at(beamline, section);
        out.push_back(
            {name, "at",
             fmt::format(
                 "`{}` acts together with another field, at {} and {}, and the levels of `{}` turn with one "
                 "frequency at a place in the rotating-wave approximation",
                 name, pretty_quantity(wave.frequency, Dimension::frequency),
                 pretty_quantity(other, Dimension::frequency), atom.name),
             "write `approximation: none` for the slower one, or move it"});
        return;
      }
    }
  }
}

/// Transitions are tabulated in the slowness alone: two clocks must not differ by the time of emission.
void check_clocks(const Beamline& beamline, const Species& atom, const Sections& sections, Faults& out) {
  if (!beamline.source.pulse) return;
  const ZoneMaker zones = zone_maker(beamline, atom);
  const SpinHistory spins = history_of(beamline, atom, sections, zones);
  for (const Plane& plane : sections.planes) {
    if (!asks_for_spin(plane) || needs_way(sections.sections, spins.known_before(plane), plane.y)) continue;
    const Oscillator* first = nullptr;
    const std::vector<LevelZone> driven = driven_zones(sections.sections, spins.known_before(plane), plane.y);
    for (const LevelZone& zone : driven) {
      if (!zone.drive || zone.drive->oscillator.random_phase) continue;
      const Oscillator& clock = zone.drive->oscillator;
      if (first != nullptr && clock.frequency != first->frequency) {
        const std::string& name = beamline.parts[static_cast<std::size_t>(clock.part)].placement.name;
        const std::string& other = beamline.parts[static_cast<std::size_t>(first->part)].placement.name;
        out.push_back(
            {name, "phase",
             fmt::format("`{}` and `{}` drive the levels of a pulsed beam with known phases and different "
                         "frequencies, and its particles find them at different times",
                         other, name),
             "write `phase: random` for one of them, or omit the source's `pulse`"});
        return;
      }
      first = &clock;
    }
  }
}

/// Speeds that change along the beam are flown in steps from the source on; levels of atoms are tabulated by
/// one slowness, and an aim is taken along a straight line or a parabola across the beam.
void check_fall(const Beamline& beamline, Faults& out) {
  if (!beamline.gravity || beamline.gravity->direction.y == 0) return;
  const auto add = [&](std::string message, std::string help) {
    out.push_back({"gravity", "direction", std::move(message), std::move(help)});
  };
  if (const Species* atom = atom_of(beamline); atom != nullptr && is_quantum(beamline))
    add(fmt::format("this direction has a part along the beam, where the levels of `{}` are followed at one "
                    "speed only",
                    atom->name),
        "give a direction without a part along y, such as `-z`, or fly it under `classical`");
  if (std::holds_alternative<AimedDirection>(beamline.source.direction))
    add("this direction has a part along the beam, and a source is aimed across it only",
        "use `direction: {kind: cone, ...}`, or give a direction without a part along y");
}

/// Levels of atoms are those along +z, and are taken to follow the field of a magnet that is turned about the
/// beam; but not to turn round.
void check_turned_magnets(const Beamline& beamline, const Species& atom, const Sections& sections,
                          Faults& out) {
  for (const Plane& plane : sections.planes) {
    const auto* magnet = std::get_if<MagnetTerm>(&plane.term);
    if (magnet == nullptr || !is_against_axis(*magnet) || spin_axis(*magnet).z == 0) continue;
    const std::string& name = beamline.parts[static_cast<std::size_t>(plane.part)].placement.name;
    out.push_back(
        {name, magnet->shape.field < 0 ? "field" : "tilt",
         fmt::format("the field of `{}` points against +z at the beam, and levels of `{}` are those "
                     "along +z",
                     name, atom.name),
         "let its field change sign: the push, by the field's size, stays the same"});
  }
}

}  // namespace

void check_flight(const Beamline& beamline, Faults& out) {
  check_fall(beamline, out);
  if (!out.empty()) return;
  const Sections sections = sections_of(beamline);
  check_overlaps(beamline, sections, out);
  check_stepped(beamline, sections, out);
  if (!out.empty()) return;
  for (const Component& component : beamline.species) {
    if (is_quantum(beamline) && component.species.structure) {
      check_turned_magnets(beamline, component.species, sections, out);
      check_clocks(beamline, component.species, sections, out);
      check_cycles(beamline, component.species, sections, out);
    } else {
      check_phases(beamline, component.species, sections, out);
      if (out.empty()) check_steps(beamline, component.species, sections, out);
    }
  }
}

}  // namespace rabiline
