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
bool sorts_spins(const PlacedPart& part, const Beamline& beamline) {
  return is_filter(part.part) || moves_paths(part, beamline);
}

bool has_bore(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.bore; }) return any.bore.has_value();
        return false;
      },
      part);
}
bool turns_spins_alone(const PlacedPart& part, const Beamline& beamline) {
  const PartTraits traits = traits_of(part.part);
  return (traits.field || !traits.needs_one_moment.empty()) && !has_bore(part.part) &&
         !sorts_spins(part, beamline);
}
Beamline without_what_turns_spins(const Beamline& beamline) {
  Beamline out = beamline;
  std::erase_if(out.parts, [&](const PlacedPart& part) { return turns_spins_alone(part, beamline); });
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
  for (const PlacedPart& part : beamline.parts)
    if (sorts_spins(part, beamline)) sorted = std::min(sorted, part.placement.at);
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
