#include "simulation/rescan.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "simulation/precision.hpp"
#include "simulation/run.hpp"
#include "simulation/sums_copy.hpp"

namespace rabiline {
namespace {

/// What counts in bins behind projections.
std::vector<std::string> parts_with_bins(const Plan& plan, const Beamline& beamline) {
  std::vector<std::string> names;
  for (const PlanTree& tree : plan.trees)
    each_transit(tree.next, [&](const PlanNode& projection) {
      for (std::size_t k = 0; !projection.next.empty() && k < projection.transit->links(); ++k) {
        const TransitLink& link = projection.transit->link(k);
        if (!link.is_screen() && !link.is_tally()) continue;
        const std::string& name = beamline.parts[static_cast<std::size_t>(link.part)].placement.name;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      }
    });
  return names;
}

Beamline with_totals(Beamline beamline, const std::vector<std::string>& of) {
  for (PlacedPart& part : beamline.parts) {
    if (std::find(of.begin(), of.end(), part.placement.name) == of.end()) continue;
    if (auto* monitor = std::get_if<Monitor>(&part.part)) monitor->tallies = {};
    if (auto* detector = std::get_if<Detector>(&part.part)) {
      detector->bins = {1, 1};
      detector->tallies = {};
    }
  }
  return beamline;
}
Experiment with_totals(const Experiment& experiment, const std::vector<std::string>& of) {
  Experiment out = experiment;
  out.points = {experiment.points.size(),
                [points = experiment.points, of](std::size_t p) { return with_totals(points[p], of); }};
  return out;
}
}  // namespace

std::optional<FlightRecord> record_of(const Experiment& experiment, const Plan& plan,
                                      const RunOutcome& outcome, KeptBins bins, std::string_view& why_not) {
  why_not =
      "the scan changes more than how spins turn between two places that ask for their level, or a tally "
      "asks "
      "for more of a spin than that";
  FlightRecord record;
  for (const PlanTree& tree : plan.trees)
    each_transit(tree.next, [&](const PlanNode& node) { record.cells.push_back(node.transit->cells()); });
  if (!is_one_flight(plan, why_not) || record.cells.empty()) return {};
  if (bins == KeptBins::totals) record.totals_of = parts_with_bins(plan, experiment.points.front());
  const Experiment one = with_totals(first_point_of(experiment), record.totals_of);
  const Plan alone = make_plan(one, 0, std::numeric_limits<double>::infinity(), {true, &record.cells});
  record.sums.resize(alone.sums);
  copy_flight(plan, outcome.sums, alone, record.sums);
  record.stragglers = outcome.stragglers;
  record.halvings = outcome.halvings;
  return record;
}

Result rescan(const Experiment& flown, const FlightRecord& record, const Experiment& wanted,
              std::uint64_t max_memory, Isa isa, int threads, const TakePoints& take) {
  const MomentsWanted moments{true, &record.cells};
  const Experiment one = with_totals(first_point_of(flown), record.totals_of),
                   scan = with_totals(wanted, record.totals_of);
  std::string_view why = "it changes more than how spins turn between two places that ask for their level";
  const std::optional<Form> form = follow(one, scan, moments, slabs_of(one, scan, moments, max_memory), why);
  if (!form)
    throw std::invalid_argument(fmt::format(
        "this scan does not follow from the flight that was kept: {}\n  help: fly it with `rabiline run`",
        why));
  if (form->plan.sums != record.sums.size()) throw std::invalid_argument("what was kept is of another beam");
  if (record.halvings > Precision(flown).halvings())
    throw std::invalid_argument("what was kept is of another number of particles");
  Result result = finish(*form, scan, record.sums, record.stragglers, record.halvings, isa, threads, take);
  result.flight = record;
  result.provenance.slabs = form->slabs;
  return result;
}

}  // namespace rabiline
