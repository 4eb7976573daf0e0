// What atoms with levels cannot fly through, or be asked about.
#include <algorithm>
#include <cmath>
#include <optional>

#include "plan/beam.hpp"
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

/// A coil winds spins up by an angle, which is that of one spin; a filter lets levels pass by their names.
void check_parts(const Beamline& beamline, const Species& atom, Faults& out) {
  const auto check = [&](const auto& part, const std::string& name) {
    if constexpr (requires { part.angle; }) {
      if (atom.structure->i.twice == 0) return;
      out.push_back(
          {name, "kind",
           fmt::format("`{}` turns one spin by an angle, but `{}` has two, I and J", name, atom.name),
           "write a `uniform_field` with the coil's field, or drive transitions by a `rotating_field` or an "
           "`oscillating_field`"});
    }
    if constexpr (requires { part.up; }) {
      check_named_levels(beamline, part.levels, name, "levels", out);
      if (part.axis)
        out.push_back({name, "axis",
                       fmt::format("`{}` filters spins along an axis, but `{}` has {} levels", name,
                                   atom.name, atom.levels()),
                       fmt::format("name the levels that pass: `levels: [{}]`", some_level(atom))});
    }
  };
  for (const PlacedPart& part : beamline.parts)
    std::visit([&](const auto& any) { check(any, part.placement.name); }, part.part);
}

// ---- fields ----

/// A magnet finds levels along +z and pushes them along its gradient.
void check_magnets(const Beamline& beamline, const Species& atom, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    std::optional<StaticField> own = static_field_of(part.part);
    if (!own || !is_magnet(part.part)) continue;
    if (const auto* magnet = std::get_if<GradientMagnet>(&part.part)) {
      const Offset beam = axis_of_beam(beamline.source, part.placement.at + magnet->length / 2);
      own->field.z += magnet->gradient * (magnet->along.x * beam.x + magnet->along.z * beam.z);
    }
    if (own->field.x == 0 && own->field.y == 0 && own->field.z >= 0) continue;
    out.push_back({part.placement.name, std::string(own->blame),
                   fmt::format("`{}` does not point along +z, where magnets find the levels of `{}`",
                               part.placement.name, atom.name),
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
  for (const PlacedPart& part : beamline.parts) {
    if (is_electric(part.part)) continue;
    std::visit(
        [&](const auto& p) {
          const std::string &name = part.placement.name, whose = fmt::format("the field of `{}`", name);
          if constexpr (requires { double{p.field}; }) check(p.field, name, "field", whose);
          if constexpr (requires { double{p.amplitude}; }) check(p.amplitude, name, "amplitude", whose);
          if constexpr (requires { double{p.pole_field}; }) check(p.pole_field, name, "pole_field", whose);
        },
        part.part);
  }
  if (const auto* thermal = std::get_if<ThermalSpin>(&beamline.source.spin))
    check(thermal->field, "source", "spin.field", "the field at the source");
}

// ---- fields that drive transitions ----

/// A field that drives levels turns one way, whatever precesses. One spin J alone precesses with +g_J about
/// B, so that `co` has a word there.
template <class Field>
void check_drive(const Field& field, const std::string& name, const Species& atom, Faults& out) {
  if constexpr (requires { field.sense; }) {
    if (field.sense != Sense::co && field.sense != Sense::counter) return;
    const bool with = *field.sense == Sense::co, one_spin = atom.structure->i.twice == 0;
    out.push_back(
        {name, "sense",
         fmt::format(
             "`{}` cannot say which way `{}` turns: {}", with ? "co" : "counter", name,
             one_spin ? fmt::format("`{}` has levels, and a field that drives levels has a sense of its own",
                                    atom.name)
                      : fmt::format("levels of `{}` precess both ways", atom.name)),
         one_spin
             ? fmt::format("write `{}`, which it is where the static field is along +z",
                           (atom.structure->g_j > 0) == with ? "positive" : "negative")
             : "write `positive`, from x to y, for transitions whose upper level has m + 1, or `negative` "
               "for m - 1"});
  }
}

void check_drives(const Beamline& beamline, const Species& atom, Faults& out) {
  for (const PlacedPart& part : beamline.parts)
    std::visit([&](const auto& any) { check_drive(any, part.placement.name, atom, out); }, part.part);
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
  if (!law_traits(beamline.law).has_forces)  // the hypothesis knows one gamma for each particle
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
  check_magnets(beamline, *first, out);
  check_sizes(beamline, *first, out);
  check_drives(beamline, *first, out);
  check_spin_tallies(beamline, *first, out);
}

}  // namespace rabiline
