#include "simulation/form.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>

#include <fmt/format.h>

#include "plan/geometry.hpp"
#include "plan/transits.hpp"
#include "simulation/append.hpp"
#include "simulation/counting.hpp"
#include "simulation/finish.hpp"
#include "simulation/form_flight.hpp"
#include "simulation/precision.hpp"
#include "simulation/run.hpp"
#include "simulation/sums_copy.hpp"
#include "simulation/tree_runner.hpp"
#include "simulation/work.hpp"

namespace rabiline {
namespace {

constexpr double any_cost = std::numeric_limits<double>::infinity();
/// Even the half of it has more points than a covariance is kept of, so that no slab has one.
constexpr std::size_t least_at_once = 2 * (most_points_of_covariance + 1);
/// Nothing stops while a slab is planned, which takes about 0.1 ms for each of its points.
constexpr std::size_t most_flown_at_once = 4 * least_at_once;

/// Points [begin, end) of a scan.
Experiment some_of(const Experiment& scan, std::size_t begin, std::size_t end) {
  Experiment out;
  out.particles = scan.particles;
  out.first = scan.first + begin;
  out.points = {end - begin, [points = scan.points, begin](std::size_t p) { return points[begin + p]; }};
  return out;
}
Experiment slab_of(const Experiment& scan, std::size_t slab, std::size_t slabs) {
  if (slabs == 1) return scan;
  const std::size_t points = scan.points.size();
  return some_of(scan, points * slab / slabs, points * (slab + 1) / slabs);
}
/// Behind the point that flies.
Experiment behind(const Experiment& flown, const Experiment& slab) {
  Experiment both;
  both.particles = slab.particles;
  both.points = {slab.points.size() + 1, [&flown, &slab](std::size_t p) {
                   return p == 0 ? flown.points.front() : slab.points[p - 1];
                 }};
  return both;
}

std::size_t bytes_of_zones(const Stage& stage) {
  std::size_t bytes = 0;
  if (const SpinPath* path = path_of(stage))
    path->each_zone([&](const SpinZone& zone) { bytes += sizeof zone; });
  return bytes;
}
/// What the plan keeps of its points [bytes]. Nodes of all points hardly count.
std::size_t bytes_of_nodes(const std::vector<PlanNode>& nodes) {
  std::size_t bytes = 0;
  for (const PlanNode& node : nodes) {
    bytes += sizeof node + bytes_of_zones(node.stage) + bytes_of_nodes(node.next);
    for (const PlanNode::Reweighting& one : node.reweightings) bytes += bytes_of_zones(one.stage);
  }
  return bytes;
}
/// About what a point takes while it is worked out: its stages as they are compiled, in the tree and in its
/// copy; its sums as they are flown on two threads, added up and finished; and what becomes of all that.
double bytes_of_point(const Plan& plan) {
  constexpr double stages_and_result = 8192;
  std::size_t bytes = 4 * plan.sums * sizeof(Sum);
  for (const PlanTree& tree : plan.trees) bytes += 3 * bytes_of_nodes(tree.next);
  return stages_and_result + static_cast<double>(bytes) / plan.points;
}

/// Where what each point counts behind moments stands: begin and end.
std::vector<std::pair<std::size_t, std::size_t>> counted_behind(const PlanTree& tree) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  const auto add = [&](std::size_t begin, std::size_t size) { ranges.emplace_back(begin, begin + size); };
  each_transit(tree.next, [&](const PlanNode& first) {
    for (const PlanNode::Reweighting& reweighting : first.reweightings)
      for (const PlanNode* node = &first; node != nullptr;
           node = node->next.empty() ? nullptr : &node->next.front()) {
        add(node->sums + reweighting.shift, sums_needed(node->stage));
        if (node->ledger != 0) add(node->ledger + reweighting.shift, LedgerSums{tree.ledger_levels}.size());
      }
  });
  return ranges;
}

/// What stragglers come to behind the moments.
void add_stragglers(const Plan& plan, const std::vector<Straggler>& stragglers, Isa isa, Sums& sums) {
  if (stragglers.empty()) return;
  TreeRunner runner(isa, Batch::capacity);
  Sums flown(plan.sums);
  for (const Straggler& s : stragglers) {
    if (!is_of(s, plan)) throw std::invalid_argument("what was kept is of another beam");
    runner.fly(plan.trees[s.tree], s.particle, s.particle + 1, flown);
  }
  for (const PlanTree& tree : plan.trees)
    for (const auto& [begin, end] : counted_behind(tree))
      for (std::size_t i = begin; i < end; ++i) sums[i] += flown[i];
}

/// Where a point takes so much [bytes].
std::size_t slabs_within(std::uint64_t memory, const Experiment& scan, double bytes_of_point) {
  const auto at_once =
      std::max(least_at_once, static_cast<std::size_t>(static_cast<double>(memory) / bytes_of_point));
  return (scan.points.size() + at_once - 1) / at_once;
}

/// What results list, and by which names.
bool are_listed_alike(const Beamline& a, const Beamline& b) {
  const auto species_alike = [](const Component& one, const Component& other) {
    return one.species.name == other.species.name && one.species.spin == other.species.spin &&
           one.species.structure.has_value() == other.species.structure.has_value();
  };
  const auto parts_alike = [](const PlacedPart& one, const PlacedPart& other) {
    const Detector *screen = detector_in(one.part), *same = detector_in(other.part);
    return one.placement.name == other.placement.name && one.part.index() == other.part.index() &&
           (screen == nullptr || screen->bins == same->bins);
  };
  return a.law.index() == b.law.index() && a.chamber.has_value() == b.chamber.has_value() &&
         a.source.direction.index() == b.source.direction.index() &&
         std::ranges::equal(a.species, b.species, species_alike) &&
         std::ranges::equal(a.parts, b.parts, parts_alike);
}

/// Slabs have results of one shape, and the bins of the whole scan: these follow from all points where a
/// detector is moved or changes its size.
bool may_be_cut(const Experiment& scan, std::size_t slabs) {
  const Beamline& first = scan.points.front();
  for (const Beamline& point : scan.points)
    if (!are_listed_alike(first, point)) return false;
  const ScreenGrids grids = screen_grids(scan.points);
  for (std::size_t k = 0; k < slabs; ++k)
    if (screen_grids(slab_of(scan, k, slabs).points) != grids) return false;
  return true;
}

/// The form in which points fly, and do not follow from one flight.
Form fly_points(const Experiment& scan, const MomentsWanted& wanted, const MemoryLimits& memory,
                int threads) {
  const std::size_t points = scan.points.size();
  if (points > least_at_once) {
    const Plan sample = plan_of_slab(some_of(scan, 0, least_at_once), threads);
    const double bytes = bytes_of_point(sample), all = static_cast<double>(points) / sample.points;
    // Sums of slabs that have flown stay, those of one slab come to them.
    const double kept = bytes_of_kept_sums(sample) * all, least = static_cast<double>(memory.wanted) / 4;
    std::size_t slabs = slabs_within(memory.wanted, scan, bytes);
    if (slabs > 1)
      slabs =
          slabs_within(static_cast<std::uint64_t>(std::max(static_cast<double>(memory.wanted) - kept, least)),
                       scan, bytes);
    if (slabs > 1) slabs = std::max(slabs, (points + most_flown_at_once - 1) / most_flown_at_once);
    if (slabs > 1 && !scan.points.front().until && may_be_cut(scan, slabs)) {
      Form form{slab_of(scan, 0, slabs), {}, {}, slabs};
      form.plan = plan_of_slab(form.flown, threads);
      return form;
    }
    const double needed = bytes * static_cast<double>(points);
    if (needed > static_cast<double>(memory.most))
      throw std::invalid_argument(fmt::format(
          "{} scan points need about {:.3g} GiB while they fly together, and a run may take {:.3g} GiB\n"
          "  help: use fewer points; a scan of numbers alone, without `until` and without a detector that "
          "changes, flies in parts",
          points, needed / 0x1p30, static_cast<double>(memory.most) / 0x1p30));
  }
  return {scan, make_plan(scan, threads, most_tree_cost, wanted)};
}

/// A part of the particles, so often halved.
Result finish_part(const Experiment& experiment, const Plan& plan, Sums sums, int halvings, int threads) {
  if (halvings == 0) return finish(experiment, plan, std::move(sums), threads);
  return finish(part_of(experiment, plan, halvings), part_of(plan, halvings), std::move(sums), threads);
}

}  // namespace

bool is_one_flight(const Plan& plan, std::string_view& why) {
  for (std::size_t k = 0; k < plan.trees.size(); ++k) {
    if (k > 0 && plan.trees[k].component == plan.trees[k - 1].component) return false;
    if (!is_one_flight(plan.trees[k], plan.points, why)) return false;
  }
  return true;
}

Experiment slab_of(const Experiment& scan, const Form& form, std::size_t slab) {
  return slab_of(scan, slab, form.slabs);
}
Plan plan_of_slab(const Experiment& slab, int threads) { return make_plan(slab, threads, most_tree_cost); }

Experiment first_point_of(const Experiment& experiment) {
  Experiment out;
  out.particles = experiment.particles;
  out.points = {experiment.points.front()};
  return out;
}

std::size_t slabs_of(const Experiment& flown, const Experiment& scan, const MomentsWanted& moments,
                     std::uint64_t max_memory) {
  if (scan.points.size() <= least_at_once) return 1;
  const Experiment sample = some_of(scan, 0, least_at_once);
  return slabs_within(max_memory, scan,
                      bytes_of_point(make_plan(behind(flown, sample), 0, any_cost, moments)));
}

/// A cell is as wide as the fastest turning of any point wants it.
std::optional<Form> follow(const Experiment& flown, const Experiment& scan, const MomentsWanted& moments,
                           std::size_t slabs, std::string_view& why) {
  Form form{flown, {}, {}, slabs};
  for (std::size_t slab = 0; slab < slabs; ++slab) {
    const Plan plan = make_plan(behind(flown, slab_of(scan, slab, slabs)), 0, any_cost, moments);
    if (!is_one_flight(plan, why)) return {};
    std::size_t place = 0;
    for (const PlanTree& tree : plan.trees)
      each_transit(tree.next, [&](const PlanNode& node) {
        if (place == form.cells.size()) form.cells.push_back(node.transit->cells());
        SlownessCells& cells = form.cells[place++];
        if (node.transit->cells().count > cells.count) cells = node.transit->cells();
      });
  }
  if (form.cells.empty()) return {};
  form.plan = make_plan(flown, 0, any_cost, {true, &form.cells});
  return form;
}

Form form_of(const Experiment& scan, const MomentsWanted& wanted, const MemoryLimits& memory, int threads) {
  const Experiment flown = first_point_of(scan);
  const MomentsWanted everywhere{true};
  const std::size_t slabs = scan.particles == ScanParticles::shared && scan.points.size() > least_at_once
                                ? slabs_of(flown, scan, everywhere, memory.wanted)
                                : 1;
  std::string_view why;
  if (slabs > 1)
    if (std::optional<Form> form = follow(flown, scan, everywhere, slabs, why)) return std::move(*form);
  return fly_points(scan, wanted, memory, threads);
}

void add_points(Result points, const TakePoints& take, Result& all) {
  points.axes = std::move(all.axes);
  if (take) take(points);
  std::vector<ScanAxis> axes = std::move(points.axes);
  append(std::move(points), all);
  all.axes = std::move(axes);
}

Result finish(const Form& form, const Experiment& scan, Sums sums, const std::vector<Straggler>& stragglers,
              int halvings, Isa isa, int threads, const TakePoints& take) {
  Result all;
  all.axes = scan.axes;
  if (form.cells.empty()) {
    add_points(finish_part(scan, form.plan, std::move(sums), halvings, threads), take, all);
    return all;
  }
  for (std::size_t k = 0; k < form.slabs; ++k) {
    const Experiment slab = slab_of(scan, form, k);
    const Plan plan = make_plan(slab, threads, any_cost, {true, &form.cells});
    Sums of_slab(plan.sums);
    copy_flight(form.plan, sums, plan, of_slab);
    add_stragglers(plan, stragglers, isa, of_slab);
    add_points(finish_part(slab, plan, std::move(of_slab), halvings, threads), take, all);
  }
  return all;
}

}  // namespace rabiline
