#include "simulation/form_flight.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <stdexcept>
#include <string_view>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "simulation/clock.hpp"
#include "simulation/finish.hpp"
#include "simulation/tallies.hpp"
#include "simulation/work.hpp"

namespace rabiline {
namespace {

/// What has flown of the slabs in front, as one run tells it.
class SlabsFlown {
 public:
  explicit SlabsFlown(Snapshot beginning) : all_(std::move(beginning)) {}

  /// With what has flown of the next slab, whose places and sums begin there.
  Snapshot with(const Snapshot& slab, std::uint64_t place, std::size_t sum) const {
    SlabsFlown both = *this;
    both.add(slab, place, sum);
    return std::move(both.all_);
  }
  void add(const Snapshot& slab, std::uint64_t place, std::size_t sum) {
    Intervals places(std::move(all_.finished));
    for (const auto& [begin, end] : slab.finished) places.insert(place + begin, place + end);
    all_.finished = places.list();
    for (const std::uint64_t at : slab.sums.at) all_.sums.at.push_back(sum + at);
    all_.sums.high.insert(all_.sums.high.end(), slab.sums.high.begin(), slab.sums.high.end());
    all_.sums.low.insert(all_.sums.low.end(), slab.sums.low.begin(), slab.sums.low.end());
  }
  const KeptSums& sums() const { return all_.sums; }

 private:
  Snapshot all_;
};

/// Those of a slab, of which so many begin there.
KeptSums part_of(const KeptSums& all, std::size_t first, std::size_t count) {
  const auto index_of = [&](std::size_t sum) {
    return std::ranges::lower_bound(all.at, sum) - all.at.begin();
  };
  const std::ptrdiff_t begin = index_of(first), end = index_of(first + count);
  const auto cut = [&](const std::vector<std::uint64_t>& from) {
    return from.empty() ? from : std::vector(from.begin() + begin, from.begin() + end);
  };
  KeptSums part{count, cut(all.at), cut(all.high), cut(all.low)};
  for (std::uint64_t& at : part.at) at -= first;
  return part;
}
/// The same of places.
Intervals::List part_of(const Intervals::List& all, std::uint64_t first, std::uint64_t count) {
  Intervals::List part;
  for (const auto& [begin, end] : all) {
    const std::uint64_t from = std::max(begin, first), to = std::min(end, first + count);
    if (from < to) part.emplace_back(from - first, to - first);
  }
  return part;
}

/// Calls f with where groups of particles are counted that only covariances need.
template <class F>
void each_group_for_covariance(const Plan& plan, F f) {
  const auto of = [&](const TallyPlace& tally, std::size_t first) {
    if (!sums_of(tally.tree->source).weights_differ) f(tally.at + first);
  };
  const Tallies tallies(plan);
  for (const ScreenTally& screen : tallies.screens) of(screen, screen.layout.group(0));
  for (const CensusTally& census : tallies.censuses) of(census, CensusSums::group(0));
}

/// What a result of the plan lists.
using ListedRows = std::set<std::tuple<std::string_view, int, int, int, std::size_t>>;
ListedRows rows_of(const Plan& plan) {
  ListedRows rows;
  const Tallies tallies(plan);
  for (const FateTally& f : tallies.fates) rows.insert({f.fate, f.part, f.component, 0, f.levels});
  for (const ScreenTally& s : tallies.screens) rows.insert({"screen", s.part, 0, 0, s.layout.bins()});
  for (const LevelTally& l : tallies.level_tallies) rows.insert({"levels", l.part, l.component, l.levels, 0});
  for (const CensusTally& c : tallies.censuses) rows.insert({"plane", c.part, c.plane, 0, 0});
  for (const HistogramTally& h : tallies.histograms)
    rows.insert({"tally", h.part, h.tally, h.plane, h.layout.bins});
  return rows;
}

}  // namespace

double bytes_of_kept_sums(const Plan& plan) {
  constexpr double each = 24;  // listed with its place
  std::size_t sums = plan.sums;
  each_group_for_covariance(plan, [&](std::size_t) { sums -= group_count; });
  return each * static_cast<double>(sums);
}

FormFlight::FormFlight(const Form& form, const Experiment& scan, int threads)
    : form_(form), scan_(scan), threads_(threads) {
  add(form.plan);
  if (!form.flies_in_slabs()) return;
  const ListedRows rows = rows_of(form.plan);
  for (std::size_t k = 1; k < form.slabs; ++k) {
    const Plan plan = plan_of_slab(slab_of(scan, form, k), threads);
    if (rows_of(plan) != rows)
      throw std::invalid_argument(fmt::format(
          "{} scan points do not fit into memory together, and cannot fly in parts: from somewhere on "
          "particles end where they do not before, or other levels are counted\n  help: scan the values from "
          "there "
          "on in a run of their own, use fewer points, or state with --max-memory that the run may take more",
          scan.points.size()));
    add(plan);
  }
}

void FormFlight::add(const Plan& plan) {
  const std::uint64_t particles = ParticleRow(plan).size();
  slabs_.push_back({particles_, particles, sums_, plan.sums});
  particles_ += particles;
  sums_ += plan.sums;
}

Snapshot FormFlight::beginning() const {
  Snapshot out;
  out.particles = particles_;
  out.sums.size = sums_;
  return out;
}

bool FormFlight::fits(const Snapshot& snapshot) const {
  if (!form_.flies_in_slabs()) return rabiline::fits(snapshot, form_.plan);
  const auto [begin, end] = snapshot.shard.places(particles_);
  return snapshot.particles == particles_ && snapshot.sums.size == sums_ && snapshot.stragglers.empty() &&
         (snapshot.finished.empty() ||
          (snapshot.finished.front().first >= begin && snapshot.finished.back().second <= end));
}

RunOutcome FormFlight::run(const RunOptions& options) const {
  return form_.flies_in_slabs() ? run_slabs(options) : rabiline::run(form_.plan, options);
}

/// Particles that were booked one by one for want of a cell are told for a later scan alone, which no run
/// in slabs has.
RunOutcome FormFlight::run_slabs(const RunOptions& options) const {
  const auto start = Clock::now();
  auto told = start;
  const bool alone = options.ranks == nullptr || options.ranks->size() == 1,
             leads = alone || options.ranks->leads();
  const auto slabs = static_cast<double>(slabs_.size());
  std::optional<double> done_before;  // of all slabs, where the first one flies
  SlabsFlown flown(beginning());
  for (std::size_t k = 0; k < slabs_.size(); ++k) {
    const Slab& slab = slabs_[k];
    const bool is_last = k + 1 == slabs_.size();
    Snapshot whole;
    if (options.start != nullptr) {
      whole.finished = part_of(options.start->finished, slab.place, slab.particles);
      whole.sums = part_of(options.start->sums, slab.sum, slab.sums);
    }
    const Snapshot before = whole;
    RunOptions of_slab = options;
    of_slab.start = options.start != nullptr ? &before : nullptr;
    of_slab.before = slab.place;
    of_slab.of_run = particles_;
    if (options.progress)
      of_slab.progress = [&](Progress now) {
        now.done = (static_cast<double>(k) + now.done) / slabs;
        now.seconds = seconds_since(start);
        const double done_now = now.done - done_before.value_or(0);
        now.seconds_left = done_now > 0 ? now.seconds * (1 - now.done) / done_now : 0;
        options.progress(now);
      };
    if (options.snapshot)
      of_slab.snapshot = [&](const Snapshot& now) {
        const bool goes_on = now.complete && !is_last;
        if (goes_on && seconds_since(told) < options.snapshot_seconds) return;
        Snapshot all = flown.with(now, slab.place, slab.sum);
        all.shard = options.shard;
        all.complete = now.complete && is_last;
        options.snapshot(std::move(all));
        told = Clock::now();
      };
    const auto [begin, end] = of_slab.places(slab.particles);
    if (Intervals(whole.finished).size() < end - begin || is_last) {
      if (!done_before) done_before = static_cast<double>(k) / slabs;
      if (alone && options.stop != nullptr && *options.stop) {  // before a plan that would take seconds
        if (of_slab.snapshot) of_slab.snapshot(before);
        return {};
      }
      std::optional<Plan> own;
      const Plan& plan = k == 0 ? form_.plan : own.emplace(plan_of_slab(slab_of(scan_, form_, k), threads_));
      RunOutcome outcome = rabiline::run(plan, of_slab);
      if (!outcome.finished) return {};
      if (leads) {
        each_group_for_covariance(plan, [&](std::size_t at) {
          std::fill_n(outcome.sums.begin() + static_cast<std::ptrdiff_t>(at), group_count, Sum{0});
        });
        whole.sums = kept(outcome.sums);
      }
      whole.finished.assign(begin < end ? 1 : 0, {begin, end});
    }
    if (leads) flown.add(whole, slab.place, slab.sum);
  }
  RunOutcome outcome;
  outcome.of_slabs = flown.sums();
  outcome.finished = true;
  return outcome;
}

Result FormFlight::finish(RunOutcome outcome, Isa isa, const TakePoints& take) const {
  if (!form_.flies_in_slabs())
    return rabiline::finish(form_, scan_, std::move(outcome.sums), outcome.stragglers, outcome.halvings, isa,
                            threads_, take);
  Result all;
  all.axes = scan_.axes;
  for (std::size_t k = 0; k < slabs_.size(); ++k) {
    const Experiment slab = slab_of(scan_, form_, k);
    const Plan plan = plan_of_slab(slab, threads_);
    Sums sums = sums_of(part_of(outcome.of_slabs, slabs_[k].sum, slabs_[k].sums));
    Result points = rabiline::finish(slab, plan, std::move(sums), threads_);
    for (DetectorResult& detector : points.detectors) detector.transits.clear();  // of this slab alone
    add_points(std::move(points), take, all);
  }
  return all;
}

}  // namespace rabiline
