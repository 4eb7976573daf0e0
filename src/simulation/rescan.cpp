#include "simulation/rescan.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "simulation/finish.hpp"
#include "simulation/precision.hpp"
#include "simulation/run.hpp"
#include "simulation/walk.hpp"
#include "simulation/work.hpp"

namespace rabiline {
namespace {

/// Whether every node serves all points, or is one whose points follow from moments. Otherwise, why not.
bool is_one_flight(const std::vector<PlanNode>& nodes, std::size_t points, std::string_view& why) {
  for (const PlanNode& node : nodes) {
    if (node.points.size() == points && !node.why_one_by_one.empty()) why = node.why_one_by_one;
    if (node.points.size() != points || (!node.ways.empty() && !node.transit)) return false;
    if (!node.transit && traits_of(node.stage).counts_levels && path_of(node.stage) != nullptr) return false;
    if (!node.transit && !is_one_flight(node.next, points, why)) return false;
  }
  return true;
}
bool is_one_flight(const Plan& plan, std::string_view& why) {
  for (std::size_t k = 0; k < plan.trees.size(); ++k) {
    if (k > 0 && plan.trees[k].component == plan.trees[k - 1].component) return false;
    if (!is_one_flight(plan.trees[k].next, static_cast<std::size_t>(plan.points), why)) return false;
  }
  return true;
}

/// Behind projections.
std::vector<std::string> screens_of(const Plan& plan, const Beamline& beamline) {
  std::vector<std::string> names;
  for (const PlanTree& tree : plan.trees)
    each_transit(tree.next, [&](const PlanNode& projection) {
      for (const PlanNode* node = &projection; !node->next.empty();) {
        node = &node->next.front();
        const int part = catches(node->stage);
        if (part == no_part) continue;
        const std::string& name = beamline.parts[static_cast<std::size_t>(part)].placement.name;
        if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
      }
    });
  return names;
}

Beamline with_totals(Beamline beamline, const std::vector<std::string>& of) {
  for (PlacedPart& part : beamline.parts)
    if (std::find(of.begin(), of.end(), part.placement.name) != of.end())
      if (auto* detector = std::get_if<Detector>(&part.part)) detector->bins = {1, 1};
  return beamline;
}
Experiment with_totals(const Experiment& experiment, const std::vector<std::string>& of) {
  Experiment out = experiment;
  out.points = {experiment.points.size(),
                [points = experiment.points, of](std::size_t p) { return with_totals(points[p], of); }};
  return out;
}
Experiment first_point_of(const Experiment& experiment) {
  Experiment out;
  out.particles = experiment.particles;
  out.points = {experiment.points.front()};
  return out;
}

/// One layout's moments to another's; the bins of screens are added up where the other has one.
class MomentsCopy {
 public:
  MomentsCopy(const TransitLayout& a, const Sum* from, const TransitLayout& b, Sum* to)
      : a_(a), from_(from), b_(b), to_(to) {}

  void copy() {
    if (a_.links() != b_.links() || a_.all_outcomes() != b_.all_outcomes() ||
        a_.cells().count != b_.cells().count || a_.weights_alike() != b_.weights_alike())
      throw std::invalid_argument("the moments that were kept are of another beam");
    for (std::size_t k = 0; k < a_.links(); ++k)
      for (std::size_t from = 0; from < a_.levels(); ++from) {
        to_[b_.decided(k, from)] += from_[a_.decided(k, from)];
        for (std::size_t rank = 0; rank < a_.outcomes(from).size(); ++rank) copy_path(k, from, rank);
      }
  }

 private:
  void copy_path(std::size_t k, std::size_t from, std::size_t a) {
    add(a_.stop(k, from, a), b_.stop(k, from, a));
    if (!a_.link(k).is_screen) return;
    const ScreenSums &screen = a_.link(k).screen, &other = b_.link(k).screen;
    const bool same = screen.bins() == other.bins();
    for (std::size_t bin = 0; bin < screen.bins(); ++bin) {
      add(a_.share(k, bin, from, a), b_.share(k, same ? bin : 0, from, a));
      for (std::size_t b = 0; b < a + (a_.weights_alike() ? 0 : 1); ++b)
        add(a_.square(k, bin, from, a, b), b_.square(k, same ? bin : 0, from, a, b));
    }
    for (std::size_t b = 0; b < a; ++b) {
      add(a_.screen(k, from, a, b), same ? b_.screen(k, from, a, b) : b_.square(k, 0, from, a, b));
      if (!same) continue;
      for (std::size_t x = 0; x < screen.columns; ++x)
        add(a_.column(k, x, from, a, b), b_.column(k, x, from, a, b));
      for (std::size_t z = 0; z < screen.rows; ++z) add(a_.row(k, z, from, a, b), b_.row(k, z, from, a, b));
    }
  }
  void add(std::size_t row, std::size_t to) {
    const std::size_t length = static_cast<std::size_t>(a_.cells().count) * transit_powers;
    for (std::size_t i = 0; i < length; ++i) to_[b_.moment(to, 0, 0) + i] += from_[a_.moment(row, 0, 0) + i];
  }

  const TransitLayout& a_;
  const Sum* from_;
  const TransitLayout& b_;
  Sum* to_;
};

/// What does not depend on the scan point, from the sums of one plan to those of another of the same flight.
class SumsCopy {
 public:
  SumsCopy(const Sums& from, Sums& to) : from_(from), to_(to) {}

  void copy(const Plan& a, const Plan& b) {
    require(a.trees.size() == b.trees.size());
    for (std::size_t k = 0; k < a.trees.size(); ++k) {
      const PlanTree &tree = a.trees[k], &other = b.trees[k];
      require(tree.first == other.first && tree.last == other.last &&
              tree.ledger_levels == other.ledger_levels &&
              sums_of(tree.source).size() == sums_of(other.source).size());
      add(tree.sums, other.sums, sums_of(tree.source).size());
      add(tree.ledger, other.ledger, tree.ledger_levels);
      ledger_size_ = LedgerSums{tree.ledger_levels}.size();
      copy(tree.next, other.next);
    }
  }

 private:
  void copy(const std::vector<PlanNode>& a, const std::vector<PlanNode>& b) {
    require(a.size() == b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
      require((a[i].transit == nullptr) == (b[i].transit == nullptr));
      if (a[i].transit) {
        MomentsCopy(*a[i].transit, &from_[a[i].moments], *b[i].transit, &to_[b[i].moments]).copy();
        continue;
      }
      require(sums_needed(a[i].stage) == sums_needed(b[i].stage) && (a[i].ledger == 0) == (b[i].ledger == 0));
      add(a[i].sums, b[i].sums, sums_needed(a[i].stage));
      if (a[i].ledger != 0) add(a[i].ledger, b[i].ledger, ledger_size_);
      copy(a[i].next, b[i].next);
    }
  }
  void add(std::size_t from, std::size_t to, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) to_[to + i] += from_[from + i];
  }
  static void require(bool alike) {
    if (!alike) throw std::invalid_argument("what was kept is of another beam");
  }

  const Sums& from_;
  Sums& to_;
  std::size_t ledger_size_ = 0;
};

/// Where what each point counts behind moments stands: begin and end.
std::vector<std::pair<std::size_t, std::size_t>> counted_behind(const PlanTree& tree) {
  std::vector<std::pair<std::size_t, std::size_t>> ranges;
  const auto add = [&](std::size_t begin, std::size_t size) { ranges.emplace_back(begin, begin + size); };
  each_transit(tree.next, [&](const PlanNode& first) {
    for (const PlanNode::Way& way : first.ways)
      for (const PlanNode* node = &first; node != nullptr;
           node = node->next.empty() ? nullptr : &node->next.front()) {
        add(node->sums + way.shift, sums_needed(node->stage));
        if (node->ledger != 0) add(node->ledger + way.shift, LedgerSums{tree.ledger_levels}.size());
      }
  });
  return ranges;
}

/// What stragglers come to behind the moments.
void add_stragglers(const Plan& plan, const std::vector<Straggler>& stragglers, Isa isa, Sums& sums) {
  Walker walker(isa, Batch::capacity);
  Sums flown(plan.sums);
  for (const Straggler& s : stragglers) {
    if (!is_of(s, plan)) throw std::invalid_argument("what was kept is of another beam");
    walker.fly(plan.trees[s.tree], s.particle, s.particle + 1, flown);
  }
  for (const PlanTree& tree : plan.trees)
    for (const auto& [begin, end] : counted_behind(tree))
      for (std::size_t i = begin; i < end; ++i) sums[i] += flown[i];
}

/// Refused unless the points are those of one flight with that of the record.
void require_one_flight(const Experiment& flown, const Experiment& wanted, const MomentsWanted& moments) {
  Experiment both;
  both.particles = wanted.particles;
  both.points = {wanted.points.size() + 1,
                 [&](std::size_t p) { return p == 0 ? flown.points.front() : wanted.points[p - 1]; }};
  std::string_view why = "it changes more than how spins turn between two places that ask for their level";
  if (!is_one_flight(make_plan(both, 0, std::numeric_limits<double>::infinity(), moments), why))
    throw std::invalid_argument(fmt::format(
        "this scan does not follow from the flight that was kept: {}\n  help: fly it with `rabiline run`",
        why));
}

}  // namespace

std::optional<FlightRecord> record_of(const Experiment& experiment, const Plan& plan,
                                      const RunOutcome& outcome, KeptBins bins, std::string_view& why_not) {
  why_not = "the scan changes more than how spins turn between two places that ask for their level";
  FlightRecord record;
  for (const PlanTree& tree : plan.trees)
    each_transit(tree.next, [&](const PlanNode& node) { record.cells.push_back(node.transit->cells()); });
  if (!is_one_flight(plan, why_not) || record.cells.empty()) return {};
  if (bins == KeptBins::totals) record.totals_of = screens_of(plan, experiment.points.front());
  const Experiment one = with_totals(first_point_of(experiment), record.totals_of);
  const Plan alone = make_plan(one, 0, std::numeric_limits<double>::infinity(), {true, &record.cells});
  record.sums.resize(alone.sums);
  SumsCopy(outcome.sums, record.sums).copy(plan, alone);
  record.stragglers = outcome.stragglers;
  record.halvings = outcome.halvings;
  return record;
}

Result rescan(const Experiment& flown, const FlightRecord& record, const Experiment& wanted, Isa isa,
              int threads) {
  const MomentsWanted moments{true, &record.cells};
  const Experiment one = with_totals(first_point_of(flown), record.totals_of),
                   scan = with_totals(wanted, record.totals_of);
  require_one_flight(one, scan, moments);
  const double infinity = std::numeric_limits<double>::infinity();
  const Plan alone = make_plan(one, 0, infinity, moments), plan = make_plan(scan, 0, infinity, moments);
  if (alone.sums != record.sums.size()) throw std::invalid_argument("what was kept is of another beam");
  if (record.halvings > Precision(flown, alone).halvings())
    throw std::invalid_argument("what was kept is of another number of particles");
  Sums sums(plan.sums);
  SumsCopy(record.sums, sums).copy(alone, plan);
  add_stragglers(plan, record.stragglers, isa, sums);
  Result result =
      finish(part_of(scan, plan, record.halvings), part_of(plan, record.halvings), std::move(sums), threads);
  result.flight = record;
  return result;
}

}  // namespace rabiline
