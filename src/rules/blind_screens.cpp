#include "rules/blind_screens.hpp"

#include <algorithm>
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
  return (traits.field || !traits.needs_one_moment.empty()) && !has_bore(part) && !is_magnet(part);
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
  double sorted = HUGE_VAL;  // from here on [m]
  const std::vector<bool> sorts = sorts_spins(beamline);
  for (std::size_t i = 0; i < sorts.size(); ++i)
    if (sorts[i]) sorted = std::min(sorted, beamline.parts[i].placement.at);
  std::string names;
  for (const PlacedPart& part : beamline.parts) {
    if (!detector_in(part.part)) continue;
    if (part.placement.at > sorted || tallies_spins(part.part)) return {};
    names += fmt::format("{}`{}`", names.empty() ? "" : " and ", part.placement.name);
  }
  if (names.empty()) return {};
  return fmt::format(
      "note       no part in front of {0} sorts spins, so the counts there do not depend on what is "
      "scanned:\n"
      "           look at its levels (`rabiline plot-levels`), or add a `spin_filter` or a magnet\n",
      names);
}

}  // namespace rabiline
