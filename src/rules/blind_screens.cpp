#include "rules/blind_screens.hpp"

#include <algorithm>
#include <set>
#include <vector>

#include <fmt/format.h>

#include "rules/part_effects.hpp"

namespace rabiline {
namespace {

bool is_filter(const Part& part) {
  return std::visit(
      [](const auto& any) {
        return requires { any.up; };
      },
      part);
}
/// By the numbers of parts.
std::vector<bool> sorts_spins(const Beamline& beamline) {
  std::vector<bool> sorts = parts_that_move_paths(beamline);
  for (std::size_t i = 0; i < sorts.size(); ++i) sorts[i] = sorts[i] || is_filter(beamline.parts[i].part);
  return sorts;
}

bool has_bore(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.bore; }) return any.bore.has_value();
        return false;
      },
      part);
}
/// Of what sorts no spins.
bool turns_spins_alone(const Part& part) {
  const PartTraits traits = traits_of(part);
  return (traits.field || traits.sets_spins) && !has_bore(part) && !is_magnet(part);
}
Beamline without_what_turns_spins(const Beamline& beamline) {
  const std::vector<bool> sorts = sorts_spins(beamline);
  Beamline out = beamline;
  out.parts.clear();
  for (std::size_t i = 0; i < sorts.size(); ++i)
    if (sorts[i] || !turns_spins_alone(beamline.parts[i].part)) out.parts.push_back(beamline.parts[i]);
  return out;
}

/// Whether the scan changes nothing but what turns spins, by the ends of its axes.
bool scans_spins_alone(const ScanPoints& points) {
  if (points.size() < 2) return false;
  const Beamline &first = points.front(), last = points[points.size() - 1];
  return law_traits(first.law).kappa == 0 && first.parts != last.parts &&
         without_what_turns_spins(first) == without_what_turns_spins(last);
}

/// The first part that is not the same at both ends of the scan, or follows the clock of one that is not.
const Placement* first_changed(const ScanPoints& points) {
  const Beamline &first = points.front(), last = points[points.size() - 1];
  std::set<std::string> changed;
  for (std::size_t i = 0; i < first.parts.size(); ++i)
    if (!(first.parts[i] == last.parts[i])) changed.insert(first.parts[i].placement.name);
  const Placement* out = nullptr;
  for (const PlacedPart& part : first.parts) {
    const std::string* clock = clock_of(part.part);
    if (!changed.contains(part.placement.name) && !(clock && changed.contains(*clock))) continue;
    if (!out || part.placement.at < out->at) out = &part.placement;
  }
  return out;
}

bool tallies_spins(const Part& part) {
  const std::vector<Tally>* tallies = tallies_of(part);
  return tallies && std::ranges::any_of(*tallies, [](const Tally& tally) {
           return std::ranges::any_of(tally.axes,
                                      [](const TallyAxis& axis) { return asks_for_spin(axis.quantity); });
         });
}

}  // namespace

std::string note_on_blind_screens(const Experiment& experiment) {
  if (!scans_spins_alone(experiment.points)) return {};
  const Beamline& beamline = experiment.points.front();
  const Placement* scanned = first_changed(experiment.points);
  double sorted = HUGE_VAL;  // from here on [m], by what may turn otherwise
  const std::vector<bool> sorts = sorts_spins(beamline);
  bool sorts_before = false;
  for (std::size_t i = 0; i < sorts.size(); ++i) {
    if (!sorts[i]) continue;
    if (end_of(beamline.parts[i]) > scanned->at)
      sorted = std::min(sorted, beamline.parts[i].placement.at);
    else
      sorts_before = true;
  }
  std::string names;
  for (const PlacedPart& part : beamline.parts) {
    if (!detector_in(part.part)) continue;
    if (part.placement.at > sorted || tallies_spins(part.part)) return {};
    names += fmt::format("{}`{}`", names.empty() ? "" : " and ", part.placement.name);
  }
  if (names.empty()) return {};
  return fmt::format(
      "note       no part {0}in front of {1} sorts spins, so the counts there do not depend on what is "
      "scanned:\n"
      "           look at its levels (`rabiline plot-levels`), or add a `spin_filter` or a magnet\n",
      sorts_before ? fmt::format("behind `{}` and ", scanned->name) : "", names);
}

}  // namespace rabiline
