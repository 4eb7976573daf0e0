#include "rules/rules.hpp"

#include <algorithm>
#include <set>

#include "core/diagnostics.hpp"
#include "rules/room.hpp"

namespace rabiline {

const PlacedPart* find_part(const Beamline& beamline, std::string_view name) {
  for (const PlacedPart& part : beamline.parts)
    if (part.placement.name == name) return &part;
  return nullptr;
}

std::string suggest_name(std::string_view wrong, const std::vector<std::string>& known) {
  const std::string near = closest(wrong, known);
  if (!near.empty()) return fmt::format("did you mean `{}`?", near);
  std::string out;
  for (const std::string& name : known) out += fmt::format("{}`{}`", out.empty() ? "there is " : ", ", name);
  return out;
}

bool is_quantum(const Beamline& beamline) { return law_traits(beamline.law).has_levels; }

const Species* atom_of(const Beamline& beamline) {
  for (const Component& component : beamline.species)
    if (component.species.structure) return &component.species;
  return nullptr;
}

std::string atom_called(const Species& species) {
  const std::string atom = species.name + " atom";
  return !species.structure && find_species(atom) ? atom : std::string();
}

bool turns_paths(const Beamline& beamline) {
  const LawTraits law = law_traits(beamline.law);
  if (!law.has_forces) return law.kappa != 0;
  return std::any_of(beamline.species.begin(), beamline.species.end(),
                     [](const Component& c) { return c.species.charge != 0; });
}

void check_names(const Beamline& beamline, Faults& out) {
  for (std::size_t i = 0; i < beamline.parts.size(); ++i) {
    const std::string& name = beamline.parts[i].placement.name;
    const PlacedPart* first = find_part(beamline, name);
    if (first != &beamline.parts[i])
      out.push_back({fmt::format("parts[{}]", i), "name",
                     fmt::format("the name `{}` is taken by the {} at {}", name, kind_of(first->part),
                                 metres(first->placement.at)),
                     "names must differ"});
  }
}

std::vector<Fault> faults_of(const Beamline& beamline) {
  Faults out;
  if (beamline.species.empty()) {
    out.push_back({"species", "", "nothing flies: there is no species", "write `species: neutron`"});
    return out;
  }
  check_ranges(beamline, out);
  check_names(beamline, out);
  if (!out.empty()) return out;  // what follows finds parts by their names
  for (const PlacedPart& part : beamline.parts)
    for (Fault& fault : faults_of(part)) out.push_back(std::move(fault));
  check_species(beamline, out);
  check_screens(beamline, out);
  check_tallies(beamline, out);
  check_source(beamline, out);
  check_fields(beamline, out);
  check_electric_fields(beamline, out);
  check_magnets(beamline, out);
  check_atoms(beamline, out);
  check_walls(beamline, out);
  if (out.empty()) check_flight(beamline, out);
  return out;
}

namespace {
std::set<std::string> names_of_counting_parts(const Beamline& beamline) {
  std::set<std::string> names;
  for (const PlacedPart& part : beamline.parts)
    if (detector_in(part.part) || monitor_in(part.part)) names.insert(part.placement.name);
  return names;
}
}  // namespace

std::optional<Fault> fault_of_axis(std::string_view parameter, const ScanPoints& points) {
  const std::set<std::string> counting = names_of_counting_parts(points.front());
  for (const Beamline& point : points)
    if (names_of_counting_parts(point) != counting)
      return Fault{
          "", "",
          fmt::format("`{}` cannot be scanned: all points have the same detectors and monitors", parameter),
          "make one run with it and one without"};
  if (std::optional<Fault> fault = fault_of_scanned_tallies(parameter, points)) return fault;
  for (const Beamline& point : points) {
    if (point.until != points.front().until)
      return Fault{"", "",
                   fmt::format("`{}` cannot be scanned: a run ends for all its points together", parameter),
                   "keep it in the file"};
    if (point.source.rate != points.front().source.rate)
      return Fault{
          "", "",
          fmt::format("`{}` cannot be scanned: the source's `rate` is a factor of all results", parameter),
          "keep it in the file, and multiply"};
    for (const PlacedPart& part : point.parts) {
      const PlacedPart* first = find_part(points.front(), part.placement.name);
      const Detector *now = detector_in(part.part), *then = first ? detector_in(first->part) : nullptr;
      if (now && then && now->bins != then->bins)
        return Fault{"", "",
                     fmt::format("`{}` cannot be scanned: all points fill the same histogram of `{}`",
                                 parameter, part.placement.name),
                     "make one run for each number of bins"};
    }
  }
  return std::nullopt;
}

}  // namespace rabiline
