// What atoms with levels cannot fly through, or be asked about.
#include <algorithm>
#include <cmath>
#include <optional>

#include "input/check_nodes.hpp"
#include "section/section_builder.hpp"
#include "spin/level_names.hpp"
#include "transport/kernels.hpp"

namespace rabiline {
namespace {

/// The first species with levels, if any flies.
const Species* atom_of(const Beamline& beamline) {
  for (const Component& component : beamline.species)
    if (component.species.structure) return &component.species;
  return nullptr;
}

const Place& place_of_species(const Node& root, std::size_t number) {
  static const Place nowhere;
  const Entry* entry = root.find("species");
  if (!entry) return nowhere;
  const Node& node = entry->value;
  if (node.is_sequence() && number < node.items.size()) return place_of(node.items[number], "name");
  return node.is_mapping() ? place_of(node, "name") : node.place;
}

/// "F=4 m=0": a level that the species has.
std::string some_level(const Species& atom) {
  const auto labels = level_labels(coupled_spins(*atom.structure));
  return weak_field_name(labels[labels.size() / 2]);
}

// ---- laws and mixtures ----

/// The hypothesis knows one gamma for each particle.
void check_dorado(const Beamline& beamline, const Species& atom, const Node& root, Reading& reading) {
  if (!std::holds_alternative<DoradoLaw>(beamline.law)) return;
  const Entry* law = root.find("law");
  if (!law) return;
  reading.error(law->value.is_mapping() ? place_of(law->value, "name") : law->value.place,
                fmt::format("the law dorado turns the velocity with one spin and its gamma, but `{}` has {} "
                            "levels and no single gamma",
                            atom.name, atom.levels()),
                "define a species with the gyromagnetic ratio of the level: "
                "`{name: ..., mass: ..., charge: 0 e, spin: 1/2, gyromagnetic_ratio: ...}`");
}

/// What the Hamiltonian cannot mean.
void check_constants(const Species& species, const Node& root, Reading& reading) {
  const Structure& s = *species.structure;
  const Entry* entry = root.find("species");
  const Entry* own = entry && entry->value.is_mapping() ? entry->value.find("structure") : nullptr;
  if (!own || !own->value.is_mapping()) return;
  const auto given = [&](std::string_view key) { return own->value.find(key) != nullptr; };
  for (const Diagnostic& error : reading.errors)
    for (const Entry& constant : own->value.entries)
      if (error.place.text == constant.value.place.text && error.place.line == constant.value.place.line &&
          error.place.column == constant.value.place.column)
        return;  // what could not be read counts as zero
  const auto refuse_size = [&](std::string_view key, double value, double most, std::string_view unit) {
    if (std::abs(value) > most)
      reading.error(place_of(own->value, key),
                    fmt::format("`{}` of `{}` is {:.4g}{}, more than {:.4g}{}", key, species.name, value,
                                unit, most, unit),
                    "no atom has that; is the unit wrong?");
  };
  refuse_size("coupling", s.coupling, 1e16, " Hz");
  refuse_size("quadrupole", s.quadrupole, 1e16, " Hz");
  refuse_size("g_J", s.g_j, 1e3, "");
  refuse_size("g_I", s.g_i, 1e3, "");
  if (s.quadrupole != 0 && s.i.twice > 0 && s.j.twice > 0 && (s.i.twice < 2 || s.j.twice < 2))
    reading.error(
        place_of(own->value, "quadrupole"),
        fmt::format("the quadrupole interaction acts on spins of 1 or more, but I is {} and J is {}",
                    write_half(s.i.twice), write_half(s.j.twice)),
        "leave `quadrupole` away");
  if (given("coupling") && s.coupling == 0 && s.quadrupole == 0)
    reading.error(
        place_of(own->value, "coupling"),
        fmt::format("I and J of `{}` do not feel each other, so it is no atom with levels", species.name),
        "a species with one moment has `spin` and `gyromagnetic_ratio` instead of `structure`");
  else if (given("g_J") && given("g_I") && s.g_j == s.g_i)
    reading.error(
        place_of(own->value, "g_J"),
        fmt::format("`g_J` and `g_I` of `{}` are equal: no field could mix its levels", species.name),
        "g_I is that of the nucleus in Bohr magnetons, about 1e-3 or smaller");
}

/// Levels are counted by their numbers, which mean the same for all particles.
void check_mixture(const Beamline& beamline, const Species& atom, const Node& root, Reading& reading) {
  if (beamline.species.size() < 2) return;
  for (std::size_t i = 0; i < beamline.species.size(); ++i)
    if (&beamline.species[i].species == &atom)
      reading.error(
          place_of_species(root, i),
          fmt::format("`{}` has levels of its own and cannot fly in one beam with other species", atom.name),
          "make one run for each species, or scan `species`");
}

void check_structures(const Beamline& beamline, const Node& root, Reading& reading) {
  for (std::size_t i = 0; i < beamline.species.size(); ++i) {
    const Species& species = beamline.species[i].species;
    if (!species.structure) continue;
    check_constants(species, root, reading);
    if (species.levels() > most_levels)
      reading.error(place_of_species(root, i),
                    fmt::format("`{}` has {} levels, (2I + 1)(2J + 1), and {} are the most", species.name,
                                species.levels(), most_levels),
                    "leave out what the experiment does not resolve");
    const bool fields = std::any_of(beamline.parts.begin(), beamline.parts.end(),
                                    [](const PlacedPart& p) { return is_field(p.part); });
    if (species.charge != 0 && fields)
      reading.error(place_of_species(root, i),
                    fmt::format("`{}` has a charge, and fields would bend its path: levels are followed on "
                                "straight flights",
                                species.name),
                    "write `charge: 0 e`");
  }
}

// ---- parts that know one moment only ----

void check_parts(const Beamline& beamline, const Species& atom, const PartNodes& nodes, Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    const auto refuse = [&](std::string_view does, const std::string& help) {
      reading.error(
          place_in(nodes, part, "kind"),
          fmt::format("`{}` {}, but `{}` has {} levels", part.placement.name, does, atom.name, atom.levels()),
          help);
    };
    if (std::holds_alternative<Polarizer>(part.part))
      refuse("aligns one moment with a field",
             fmt::format("let the source prepare levels, `spin: {{kind: levels, levels: [{}]}}`, or select "
                         "them by a deflecting magnet",
                         some_level(atom)));
    if (std::holds_alternative<SpinFilter>(part.part))
      refuse("filters spins 1/2", "a deflecting magnet and a slit select levels");
    if (std::holds_alternative<Coil>(part.part))
      refuse("turns one spin by an angle",
             "drive transitions by a `rotating_field` or an `oscillating_field`");
  }
}

// ---- static fields ----

bool is_along_z(const Vector3& field) { return field.x == 0 && field.y == 0 && field.z >= 0; }

/// A part's static field, if it has one that does not turn along the beam. Levels follow those of magnets
/// that point elsewhere from place to place.
std::optional<Vector3> static_field_of(const Part& part) {
  if (const auto* uniform = std::get_if<UniformField>(&part))
    return uniform->field * turned(uniform->direction, uniform->tilt);
  if (const auto* guide = std::get_if<GuideField>(&part); guide && guide->from == guide->to)
    return guide->field * turned(guide->from, guide->tilt);
  if (const auto* magnet = std::get_if<GradientMagnet>(&part)) return Vector3{0, 0, magnet->field};
  return std::nullopt;
}

/// The key that turns a field away from +z.
std::string_view key_that_turns(const Part& part) {
  if (const auto* uniform = std::get_if<UniformField>(&part)) {
    if (!(uniform->tilt == Tilt{})) return "tilt";
    return uniform->direction == UnitVector{} ? "field" : "direction";
  }
  if (const auto* guide = std::get_if<GuideField>(&part)) return guide->tilt == Tilt{} ? "from" : "tilt";
  return "field";
}

/// Fields add up where they overlap: only their sum must point along +z.
void check_static_fields(const Beamline& beamline, const Species& atom, const PartNodes& nodes,
                         Reading& reading) {
  std::vector<std::pair<const PlacedPart*, Vector3>> fields;
  SectionBuilder builder(Wall{});
  for (const PlacedPart& part : beamline.parts) {
    const auto* guide = std::get_if<GuideField>(&part.part);
    if (const std::optional<Vector3> own = static_field_of(part.part)) {
      fields.emplace_back(&part, *own);
      builder.uniform(part.placement.at, end_of(part), {*own});
    } else if (guide && guide->field != 0) {
      reading.error(place_in(nodes, part, "to"),
                    fmt::format("`{}` turns its field along the beam, and `{}` is followed through fields "
                                "along +z only",
                                part.placement.name, atom.name),
                    "a `uniform_field` along z keeps the levels that they are");
    }
  }
  const std::vector<Section> sections = builder.build().sections;
  for (const auto& [part, own] : fields) {
    const double begin = part->placement.at, end = end_of(*part);
    const bool wrong = std::any_of(sections.begin(), sections.end(), [&](const Section& s) {
      return s.begin < end && s.end > begin && !is_along_z(s.field);
    });
    if (!wrong || is_along_z(own)) continue;
    reading.error(place_in(nodes, *part, key_that_turns(part->part)),
                  fmt::format("`{}` does not point along +z, and `{}` is followed through fields along +z "
                              "only",
                              part->placement.name, atom.name),
                  "turn the axes of the experiment so that its field is along +z");
  }
}

/// Fields beyond any laboratory: phases and moments would be lost in rounding.
void check_sizes(const Beamline& beamline, const Species& atom, const Node& root, const PartNodes& nodes,
                 Reading& reading) {
  constexpr double most = 1e4;  // [T]
  const auto check = [&](double field, const Place& place, std::string_view whose) {
    if (std::abs(field) > most)
      reading.error(place,
                    fmt::format("{} is {}, more than {} at which levels of `{}` are followed", whose,
                                pretty_quantity(field, Dimension::magnetic_field),
                                pretty_quantity(most, Dimension::magnetic_field), atom.name),
                    "no laboratory has that; is the unit wrong?");
  };
  for (const PlacedPart& part : beamline.parts)
    std::visit(
        [&](const auto& p) {
          const std::string whose = fmt::format("the field of `{}`", part.placement.name);
          if constexpr (requires { double{p.field}; }) check(p.field, place_in(nodes, part, "field"), whose);
          if constexpr (requires { double{p.amplitude}; })
            check(p.amplitude, place_in(nodes, part, "amplitude"), whose);
          if constexpr (requires { double{p.pole_field}; })
            check(p.pole_field, place_in(nodes, part, "pole_field"), whose);
        },
        part.part);
  if (const auto* thermal = std::get_if<ThermalSpin>(&beamline.source.spin)) {
    const Entry* source = root.find("source");
    const Entry* spin = source ? source->value.find("spin") : nullptr;
    if (spin) check(thermal->field, place_of(spin->value, "field"), "the field at the source");
  }
}

// ---- fields that drive transitions ----

bool drives(const Part& part) {
  if (const auto* field = std::get_if<RotatingField>(&part)) return field->amplitude != 0;
  if (const auto* field = std::get_if<OscillatingField>(&part)) return field->amplitude != 0;
  return false;
}

void check_rotating(const PlacedPart& part, const RotatingField& field, const Species& atom,
                    const PartNodes& nodes, Reading& reading) {
  const std::string& name = part.placement.name;
  if (field.twist != 0)
    reading.error(place_in(nodes, part, "twist"),
                  fmt::format("`{}` turns along the beam, and the levels of `{}` are driven by fields that "
                              "turn in time only",
                              name, atom.name),
                  "leave `twist` away");
  if (!(field.tilt == Tilt{}))
    reading.error(place_in(nodes, part, "tilt"),
                  fmt::format("`{}` turns in a tilted plane, and the levels of `{}` are driven by fields "
                              "that turn about z",
                              name, atom.name),
                  "leave `tilt` away");
  if (field.sense == Sense::co || field.sense == Sense::counter)
    reading.error(place_in(nodes, part, "sense"),
                  fmt::format("`{}` cannot say which way `{}` turns: levels of `{}` precess both ways",
                              *field.sense == Sense::co ? "co" : "counter", name, atom.name),
                  "write `positive`, from x to y, for transitions whose upper level has m + 1, or `negative` "
                  "for m - 1");
}

void check_drives(const Beamline& beamline, const Species& atom, const PartNodes& nodes, Reading& reading) {
  const PlacedPart* last = nullptr;  // that reaches farthest
  std::vector<const PlacedPart*> drivers;
  for (const PlacedPart& part : beamline.parts) {
    if (const auto* field = std::get_if<RotatingField>(&part.part))
      check_rotating(part, *field, atom, nodes, reading);
    if (const auto* field = std::get_if<OscillatingField>(&part.part);
        field && field->approximation == Approximation::none)
      reading.error(place_in(nodes, part, "approximation"),
                    fmt::format("`{}` acts on the levels of `{}` in the rotating-wave approximation only",
                                part.placement.name, atom.name),
                    "write `rotating_wave`; `rabiline check` tells how much it leaves out");
    if (drives(part.part)) drivers.push_back(&part);
  }
  std::stable_sort(drivers.begin(), drivers.end(), [](const PlacedPart* a, const PlacedPart* b) {
    return a->placement.at < b->placement.at;
  });
  for (const PlacedPart* part : drivers) {
    if (last && part->placement.at < end_of(*last))
      reading.error(
          place_in(nodes, *part, "at"),
          fmt::format("`{}` ({} to {}) and `{}` ({} to {}) would drive the levels of `{}` at one "
                      "place",
                      last->placement.name, metres(last->placement.at), metres(end_of(*last)),
                      part->placement.name, metres(part->placement.at), metres(end_of(*part)), atom.name),
          "place them one behind the other");
    if (!last || end_of(*part) > end_of(*last)) last = part;
  }
}

// ---- what is asked ----

void check_spin_tallies(const Beamline& beamline, const Species& atom, const PartNodes& nodes,
                        Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    const std::vector<Tally>* tallies = nullptr;
    if (const auto* detector = std::get_if<Detector>(&part.part)) tallies = &detector->tallies;
    if (const auto* monitor = std::get_if<Monitor>(&part.part)) tallies = &monitor->tallies;
    const Node* node = tallies ? nodes.find(part.placement.name) : nullptr;
    const Entry* list = node ? node->find("tallies") : nullptr;
    for (std::size_t i = 0; list && i < tallies->size() && i < list->value.items.size(); ++i)
      for (std::size_t k = 0; k < (*tallies)[i].axes.size(); ++k)
        if ((*tallies)[i].axes[k].quantity == Quantity::spin)
          reading.error(
              place_of(list->value.items[i].find("axes")->value.items[k], "quantity"),
              fmt::format("`{}` has two coupled spins, and `spin` is the projection of one", atom.name),
              "tally `level`, which has one bin for each of its levels");
  }
}

}  // namespace

void check_atoms(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const Species* atom = atom_of(beamline);
  if (atom == nullptr) return;
  check_dorado(beamline, *atom, root, reading);
  if (!std::holds_alternative<QuantumLaw>(beamline.law)) return;
  check_mixture(beamline, *atom, root, reading);
  check_structures(beamline, root, reading);
  check_parts(beamline, *atom, nodes, reading);
  check_static_fields(beamline, *atom, nodes, reading);
  check_sizes(beamline, *atom, root, nodes, reading);
  check_drives(beamline, *atom, nodes, reading);
  check_spin_tallies(beamline, *atom, nodes, reading);
}

}  // namespace rabiline
