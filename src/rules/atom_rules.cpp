// What atoms with levels cannot fly through, or be asked about.
#include <algorithm>
#include <cmath>
#include <optional>

#include "rules/room.hpp"
#include "section/section_builder.hpp"
#include "spin/level_names.hpp"
#include "transport/kernels.hpp"

namespace rabiline {
namespace {

/// "F=4 m=0": a level that the species has.
std::string some_level(const Species& atom) {
  const auto labels = level_labels(coupled_spins(*atom.structure));
  return weak_field_name(labels[labels.size() / 2]);
}

// ---- species ----

void check_structures(const Beamline& beamline, Faults& out) {
  for (std::size_t i = 0; i < beamline.species.size(); ++i) {
    const Species& species = beamline.species[i].species;
    if (!species.structure) continue;
    if (species.levels() > most_levels)
      out.push_back({"species", key_of_species(i, "name"),
                     fmt::format("`{}` has {} levels, (2I + 1)(2J + 1); at most {} are supported",
                                 species.name, species.levels(), most_levels),
                     "leave out what the experiment does not resolve"});
    const bool fields = std::any_of(beamline.parts.begin(), beamline.parts.end(),
                                    [](const PlacedPart& p) { return traits_of(p.part).field; });
    if (species.charge != 0 && fields)
      out.push_back({"species", key_of_species(i, "name"),
                     fmt::format("`{}` has a charge, and fields would bend its path: levels are followed on "
                                 "straight flights",
                                 species.name),
                     "write `charge: 0 e`"});
  }
}

/// Parts that know one moment only.
void check_parts(const Beamline& beamline, const Species& atom, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const PartTraits traits = traits_of(part.part);
    if (traits.needs_one_moment.empty()) continue;
    out.push_back(
        {part.placement.name, "kind",
         fmt::format("`{}` {}, but `{}` has {} levels", part.placement.name, traits.needs_one_moment,
                     atom.name, atom.levels()),
         traits.instead.empty()
             ? fmt::format("let the source prepare levels, `spin: {{kind: levels, levels: [{}]}}`, or select "
                           "them by a deflecting magnet",
                           some_level(atom))
             : std::string(traits.instead)});
  }
}

// ---- static fields ----

bool is_along_z(const Vector3& field) { return field.x == 0 && field.y == 0 && field.z >= 0; }

/// Fields add up where they overlap: only their sum must point along +z.
void check_static_fields(const Beamline& beamline, const Species& atom, Faults& out) {
  std::vector<std::pair<const PlacedPart*, StaticField>> fields;
  SectionBuilder builder(Wall{});
  for (const PlacedPart& part : beamline.parts) {
    const std::optional<StaticField> own = static_field_of(part.part);
    if (!own) continue;
    if (!own->turns) {
      fields.emplace_back(&part, *own);
      builder.uniform(part.placement.at, end_of(part), {own->field});
    } else if (own->field != Vector3{}) {
      out.push_back({part.placement.name, std::string(own->blame),
                     fmt::format("`{}` turns its field along the beam, and `{}` is followed through fields "
                                 "along +z only",
                                 part.placement.name, atom.name),
                     "a `uniform_field` along z keeps the levels that they are"});
    }
  }
  const std::vector<Section> sections = builder.build().sections;
  for (const auto& [part, own] : fields) {
    const double begin = part->placement.at, end = end_of(*part);
    const bool wrong = std::any_of(sections.begin(), sections.end(), [&](const Section& s) {
      return s.begin < end && s.end > begin && !is_along_z(s.field);
    });
    if (!wrong || is_along_z(own.field)) continue;
    out.push_back({part->placement.name, std::string(own.blame),
                   fmt::format("`{}` does not point along +z, and `{}` is followed through fields along +z "
                               "only",
                               part->placement.name, atom.name),
                   "turn the axes of the experiment so that its field is along +z"});
  }
}

/// Fields beyond any laboratory: phases and moments would be lost in rounding.
void check_sizes(const Beamline& beamline, const Species& atom, Faults& out) {
  constexpr double most = 1e4;  // [T]
  const auto check = [&](double field, const std::string& subject, std::string_view key,
                         std::string_view whose) {
    if (std::abs(field) > most)
      out.push_back({subject, std::string(key),
                     fmt::format("{} is {}, more than {} at which levels of `{}` are followed", whose,
                                 pretty_quantity(field, Dimension::magnetic_field),
                                 pretty_quantity(most, Dimension::magnetic_field), atom.name),
                     "no laboratory has that; is the unit wrong?"});
  };
  for (const PlacedPart& part : beamline.parts)
    std::visit(
        [&](const auto& p) {
          const std::string &name = part.placement.name, whose = fmt::format("the field of `{}`", name);
          if constexpr (requires { double{p.field}; }) check(p.field, name, "field", whose);
          if constexpr (requires { double{p.amplitude}; }) check(p.amplitude, name, "amplitude", whose);
          if constexpr (requires { double{p.pole_field}; }) check(p.pole_field, name, "pole_field", whose);
        },
        part.part);
  if (const auto* thermal = std::get_if<ThermalSpin>(&beamline.source.spin))
    check(thermal->field, "source", "spin.field", "the field at the source");
}

// ---- fields that drive transitions ----

/// A field drives levels by what turns or swings in time, about z.
template <class Field>
void check_drive(const Field& field, const std::string& name, const Species& atom, Faults& out) {
  if constexpr (requires { field.twist; }) {
    if (field.twist != 0)
      out.push_back(
          {name, "twist",
           fmt::format("`{}` turns along the beam, and the levels of `{}` are driven by fields that "
                       "turn in time only",
                       name, atom.name),
           "omit `twist`"});
    if (!(field.tilt == Tilt{}))
      out.push_back({name, "tilt",
                     fmt::format("`{}` turns in a tilted plane, and the levels of `{}` are driven by fields "
                                 "that turn about z",
                                 name, atom.name),
                     "omit `tilt`"});
    if (field.sense == Sense::co || field.sense == Sense::counter)
      out.push_back(
          {name, "sense",
           fmt::format("`{}` cannot say which way `{}` turns: levels of `{}` precess both ways",
                       *field.sense == Sense::co ? "co" : "counter", name, atom.name),
           "write `positive`, from x to y, for transitions whose upper level has m + 1, or `negative` "
           "for m - 1"});
  }
  if constexpr (requires { field.sweep; }) {
    const char* key = field.sweep                                       ? "sweep"
                      : field.pulses                                    ? "pulses"
                      : field.phase_gradient != PhaseGradient{}         ? "phase_gradient"
                      : field.amplitude_gradient != AmplitudeGradient{} ? "amplitude_gradient"
                                                                        : nullptr;
    if (key != nullptr)
      out.push_back(
          {name, key,
           fmt::format("`{}` changes in time or across the beam, and the levels of `{}` are driven by "
                       "fields that do so along the beam only",
                       name, atom.name),
           fmt::format("omit `{}`, or define a species with the moment and the spin of the two levels",
                       key)});
  }
  if constexpr (requires { field.phase_advance; })
    if (field.phase_advance != 0)
      out.push_back(
          {name, "phase_advance",
           fmt::format("the phase of `{}` runs along the beam, and the levels of `{}` are driven by "
                       "fields of one phase",
                       name, atom.name),
           "omit `phase_advance`"});
  if constexpr (requires { field.approximation; })
    if (field.approximation == Approximation::none)
      out.push_back({name, "approximation",
                     fmt::format("`{}` acts on the levels of `{}` in the rotating-wave approximation only",
                                 name, atom.name),
                     "write `rotating_wave`; `rabiline check` tells how much it leaves out"});
}

/// Whether a field with a clock is on.
bool drives(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.oscillator; }) return any.amplitude != 0;
        return false;
      },
      part);
}

void check_drives(const Beamline& beamline, const Species& atom, Faults& out) {
  const PlacedPart* last = nullptr;  // that reaches farthest
  std::vector<const PlacedPart*> drivers;
  for (const PlacedPart& part : beamline.parts) {
    std::visit([&](const auto& any) { check_drive(any, part.placement.name, atom, out); }, part.part);
    if (drives(part.part)) drivers.push_back(&part);
  }
  std::stable_sort(drivers.begin(), drivers.end(), [](const PlacedPart* a, const PlacedPart* b) {
    return a->placement.at < b->placement.at;
  });
  for (const PlacedPart* part : drivers) {
    if (last && part->placement.at < end_of(*last))
      out.push_back(
          {part->placement.name, "at",
           fmt::format("`{}` ({} to {}) and `{}` ({} to {}) would drive the levels of `{}` at one "
                       "place",
                       last->placement.name, metres(last->placement.at), metres(end_of(*last)),
                       part->placement.name, metres(part->placement.at), metres(end_of(*part)), atom.name),
           "place them one behind the other"});
    if (!last || end_of(*part) > end_of(*last)) last = part;
  }
}

// ---- what is asked ----

void check_spin_tallies(const Beamline& beamline, const Species& atom, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const std::vector<Tally>* tallies = tallies_of(part.part);
    for (std::size_t i = 0; tallies && i < tallies->size(); ++i)
      for (std::size_t k = 0; k < (*tallies)[i].axes.size(); ++k)
        if ((*tallies)[i].axes[k].quantity == Quantity::spin)
          out.push_back(
              {part.placement.name, fmt::format("tallies[{}].axes[{}].quantity", i, k),
               fmt::format("`{}` has two coupled spins, and `spin` is the projection of one", atom.name),
               "tally `level`, which has one bin for each of its levels"});
  }
}

}  // namespace

void check_atoms(const Beamline& beamline, Faults& out) {
  const Species* first = atom_of(beamline);
  if (first == nullptr) return;
  if (!law_traits(beamline.law).deflects)  // the hypothesis knows one gamma for each particle
    out.push_back({"law", "name",
                   fmt::format("the law dorado turns the velocity with one spin and its gamma, but `{}` has "
                               "{} levels and no single gamma",
                               first->name, first->levels()),
                   "define a species with the gyromagnetic ratio of the level: "
                   "`{name: ..., mass: ..., charge: 0 e, spin: 1/2, gyromagnetic_ratio: ...}`"});
  if (!is_quantum(beamline)) return;
  check_structures(beamline, out);
  // What stands in the way of one atom stands in that of all.
  check_parts(beamline, *first, out);
  check_static_fields(beamline, *first, out);
  check_sizes(beamline, *first, out);
  check_drives(beamline, *first, out);
  check_spin_tallies(beamline, *first, out);
}

}  // namespace rabiline
