#pragma once
// What the rules have in common, and the rules by theme, in the order in which they are asked.
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "beamline/experiment.hpp"
#include "core/fault.hpp"
#include "plan/magnets.hpp"

namespace rabiline {

using Faults = std::vector<Fault>;

inline std::string metres(double y) { return pretty_quantity(y, Dimension::length); }

/// The part of that name, or null.
const PlacedPart* find_part(const Beamline&, std::string_view name);
/// The names of the parts that `wanted` says yes to.
template <class Wanted>
std::vector<std::string> names_of_parts(const Beamline& beamline, Wanted wanted) {
  std::vector<std::string> out;
  for (const PlacedPart& part : beamline.parts)
    if (wanted(part)) out.push_back(part.placement.name);
  return out;
}
/// "did you mean `b`?", or "there is `a`, `b`".
std::string suggest_name(std::string_view wrong, const std::vector<std::string>& known);
/// "[1].structure": a key of a species among those of the beam.
inline std::string key_of_species(std::size_t number, std::string_view key) {
  return fmt::format("[{}].{}", number, key);
}
bool is_quantum(const Beamline&);
/// The first species with levels, or null.
const Species* atom_of(const Beamline&);
/// The atom of which a species is the nucleus; empty where there is none here.
std::string atom_called(const Species&);
/// Of an atom: levels that it has, each named once; the key is that of the list.
void check_named_levels(const Beamline&, std::span<const LevelName>, const std::string& subject,
                        const std::string& key, Faults&);
/// Whether fields bend paths.
bool turns_paths(const Beamline&);

void check_ranges(const Beamline&, Faults&);
void check_names(const Beamline&, Faults&);
void check_species(const Beamline&, Faults&);
void check_screens(const Beamline&, Faults&);
void check_tallies(const Beamline&, Faults&);
void check_source(const Beamline&, Faults&);
void check_start_spin(const Beamline&, Faults&);
void check_fields(const Beamline&, Faults&);
void check_electric_fields(const Beamline&, Faults&);
void check_magnets(const Beamline&, Faults&);
void check_atoms(const Beamline&, Faults&);
void check_walls(const Beamline&, Faults&);
/// What only the fields as each species sees them tell: asked where everything else is well.
void check_flight(const Beamline&, Faults&);

/// Tallies that not all points of a scan can fill.
std::optional<Fault> fault_of_scanned_tallies(std::string_view parameter, const ScanPoints& points);

}  // namespace rabiline
