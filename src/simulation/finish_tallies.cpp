#include "simulation/finish_tallies.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "core/portable_math.hpp"
#include "plan/tally_plan.hpp"
#include "simulation/counting.hpp"

namespace rabiline {
namespace {

class TallyFinisher {
 public:
  TallyFinisher(const Summed& run, Result& result)
      : run_(run),
        result_(result),
        points_(run.experiment.points.size()),
        screens_(run.tallies.screens, points_),
        censuses_(run.tallies.censuses, points_),
        histograms_(run.tallies.histograms, points_) {}

  void finish() {
    for (const PlacedPart& part : run_.experiment.points.front().parts) {
      if (monitor_in(part.part)) add_monitor(part);
      const std::vector<Tally>* tallies = tallies_of(part.part);
      for (std::size_t i = 0; tallies && i < tallies->size(); ++i) add_tally(part, (*tallies)[i], i);
    }
  }

 private:
  // ---- monitors ----

  void add_monitor(const PlacedPart& part) {
    MonitorResult monitor;
    monitor.name = part.placement.name;
    monitor.label = part.placement.label.value_or(monitor.name);
    monitor.y = part.placement.at;
    const auto& own = std::get<Monitor>(part.part);
    for (std::size_t i = 0; own.planes > 1 && i < own.planes; ++i)
      monitor.planes.push_back(place_of_plane(own, part.placement, i));
    monitor.passed.resize(points_ * own.planes);
    monitor.passed_errors.resize(points_ * own.planes);
    for (std::size_t plane = 0; plane < own.planes; ++plane) add_plane(plane, own.planes, monitor);
    result_.monitors.push_back(std::move(monitor));
  }

  void add_plane(std::size_t plane, std::size_t planes, MonitorResult& monitor) {
    std::vector<std::vector<double>> deviations(points_, std::vector<double>(group_count, 0.0));
    const auto by_moments = [&](std::size_t a, std::size_t b) {
      return run_.covariance_by_moments(monitor.name, static_cast<int>(plane), a, b);
    };
    std::vector<double> errors(points_);
    for (std::size_t p = 0; p < points_; ++p) {
      const int number = run_.parts.of(monitor.name, p);
      const Moments& emitted = run_.emitted[p];
      Counts total(1);
      Moments all;
      for (const CensusTally& census : censuses_[p]) {
        if (census.part != number || static_cast<std::size_t>(census.plane) != plane) continue;
        const Sum* s = &run_.sums[census.at];
        const Moments own{s[CensusSums::total()], s[CensusSums::total() + 1]};
        const double n = static_cast<double>(census.tree->last - census.tree->first);
        total.add({own}, n);
        all.q += own.q;
        all.q2 += own.q2;
        if (!census.by_moments)
          add_deviations(*census.tree, run_.sums, s + CensusSums::group(0), own, deviations[p]);
      }
      for (double& d : deviations[p]) d /= particles(emitted.q);
      monitor.passed[p * planes + plane] = particles(all.q) / particles(emitted.q);
      monitor.passed_errors[p * planes + plane] = errors[p] = fraction_error(
          all, total.variances[0], emitted, covariance_of(deviations[p], deviations[p]) + by_moments(p, p));
    }
    const std::vector<double> covariance =
        covariance_of(deviations, errors, run_.experiment.particles, by_moments);
    monitor.passed_covariance.insert(monitor.passed_covariance.end(), covariance.begin(), covariance.end());
  }

  // ---- tallies ----

  static TallyAxisResult axis_of(const TallyAxis& axis, const Species& species, int levels) {
    TallyAxisResult made;
    made.quantity = word_of(axis.quantity);
    made.dimension = dimension_of(axis.quantity);
    if (axis.axis) made.direction = {axis.axis->x, axis.axis->y, axis.axis->z};
    if (is_categorical(axis.quantity)) {
      made.labels = names_of_levels(species, levels);
      for (int level = 0; level <= levels; ++level) made.edges.push_back(level - 0.5);
      return made;
    }
    made.edges = edges_of(axis.from->value, axis.to->value, static_cast<std::int64_t>(*axis.bins));
    return made;
  }

  /// One bin for each plane, which stands in its middle.
  static TallyAxisResult axis_of_planes(const Monitor& monitor, const Placement& place) {
    TallyAxisResult made;
    made.quantity = word_of(Quantity::y);
    made.dimension = dimension_of(Quantity::y);
    const double half = monitor.length / static_cast<double>(2 * (monitor.planes - 1));
    for (std::size_t i = 0; i < monitor.planes; ++i)
      made.edges.push_back(place_of_plane(monitor, place, i) - half);
    made.edges.push_back(place.at + monitor.length + half);
    return made;
  }

  void add_tally(const PlacedPart& part, const Tally& tally, std::size_t number) {
    const Species& species = run_.experiment.points.front().species.front().species;
    const int levels = species.levels();
    TallyResult out;
    out.part = part.placement.name;
    out.part_label = part.placement.label.value_or(out.part);
    out.name = tally.name;
    const Monitor* monitor = monitor_in(part.part);
    out.of_monitor = monitor != nullptr;
    out.asks_for_spin = asks_for_spin(tally);
    if (monitor != nullptr) out.planes = monitor->planes;
    if (out.planes > 1) out.axes.push_back(axis_of_planes(*monitor, part.placement));
    for (const TallyAxis& axis : tally.axes) out.axes.push_back(axis_of(axis, species, levels));
    const HistogramSums layout{static_cast<std::size_t>(bins_of(tally, levels)), 0};
    for (std::size_t p = 0; p < points_; ++p) {
      const int at = run_.parts.of(out.part, p);
      const std::vector<Found> found = found_in_planes(at, number, out.planes, p);
      const std::vector<Sum> crossed = crossed_in_planes(at, out.planes, p);
      for (std::size_t plane = 0; plane < out.planes; ++plane) {
        add_counts(layout, found[plane], crossed[plane], p, out);
        add_moments(tally, found[plane], out);
      }
    }
    result_.tallies.push_back(std::move(out));
  }

  using Found = std::vector<const HistogramTally*>;
  std::vector<Found> found_in_planes(int part, std::size_t number, std::size_t planes, std::size_t p) const {
    std::vector<Found> out(planes);
    for (const HistogramTally& tally : histograms_[p])
      if (tally.part == part && static_cast<std::size_t>(tally.tally) == number)
        out[static_cast<std::size_t>(tally.plane)].push_back(&tally);
    return out;
  }

  void add_counts(const HistogramSums& layout, const Found& found, Sum crossed, std::size_t p,
                  TallyResult& out) {
    const int part = run_.parts.of(out.part, p);
    std::uint64_t each = quanta_per_particle;
    if (!out.of_monitor) {
      const Beamline beamline = run_.experiment.points[p];
      each = counted_of_one(detector_in(beamline.parts[static_cast<std::size_t>(part)].part)->efficiency);
    }
    Counts bins(layout.bins), outside(1);
    Sum sum = 0;
    for (const HistogramTally* tally : found) {
      const Sum* s = &run_.sums[tally->at];
      const double n = static_cast<double>(tally->tree->last - tally->tree->first);
      std::vector<Moments> own(layout.bins);
      for (std::size_t b = 0; b < layout.bins; ++b) {
        own[b] = {s[HistogramSums::bin(b)], s[HistogramSums::bin(b) + 1]};
        sum += own[b].q;
      }
      const Moments beyond{s[layout.outside()], s[layout.outside() + 1]};
      sum += beyond.q;
      bins.add(own, n, each);
      outside.add({beyond}, n, each);
    }
    bins.put(out.counts, out.counts_errors);
    outside.put(out.outside, out.outside_errors);
    if (sum != crossed)
      throw std::logic_error(
          fmt::format("the tally {} of {} does not add up to what crossed its plane at scan point {}",
                      out.name, out.part, p));
  }

  /// What a detector counted or a monitor let pass.
  std::vector<Sum> crossed_in_planes(int part, std::size_t planes, std::size_t p) const {
    std::vector<Sum> out(planes, 0);
    for (const ScreenTally& screen : screens_[p])
      if (screen.part == part) out.front() += run_.sums[screen.at + screen.layout.total()];
    for (const CensusTally& census : censuses_[p])
      if (census.part == part)
        out[static_cast<std::size_t>(census.plane)] += run_.sums[census.at + CensusSums::total()];
    return out;
  }

  void add_moments(const Tally& tally, const Found& all, TallyResult& out) {
    std::size_t ranged = 0;
    for (std::size_t a = 0; a < tally.axes.size(); ++a) {
      if (is_categorical(tally.axes[a].quantity)) continue;
      std::vector<MomentSums> groups(moment_groups);
      for (const HistogramTally* found : all) {
        for (std::size_t g = 0; g < moment_groups; ++g) {
          const Sum* s = &run_.sums[found->at + found->layout.moments(ranged, g)];
          groups[g].q += s[0];
          groups[g].qu += s[1];
          groups[g].quu += s[2];
        }
      }
      ++ranged;
      TallyAxisResult& axis = out.axes[a + (out.planes > 1 ? 1 : 0)];
      if (is_circular(tally.axes[a].quantity)) {
        put(direction_of(groups), axis);
        continue;
      }
      MeanAndDeviation m = moments_of(groups);
      const double step = (axis.edges.back() - axis.edges.front()) / moment_steps;
      m.mean = std::fma(m.mean + 0.5, step, axis.edges.front());  // from the middle of the step
      m.mean_error *= step;
      m.deviation *= step;
      m.deviation_error *= step;
      put(m, axis);
    }
  }
  static void put(const MeanAndDeviation& m, TallyAxisResult& axis) {
    axis.mean.push_back(m.mean);
    axis.mean_errors.push_back(m.mean_error);
    axis.deviation.push_back(m.deviation);
    axis.deviation_errors.push_back(m.deviation_error);
  }

  const Summed& run_;
  Result& result_;
  const std::size_t points_;
  const AtPoints<ScreenTally> screens_;
  const AtPoints<CensusTally> censuses_;
  const AtPoints<HistogramTally> histograms_;
};

}  // namespace

/// Places are taken from a whole step c near the mean: sum q (u - c) and sum q (u - c)^2 follow from the sums
/// exactly, since arithmetic modulo 2^128 does no harm to what fits into it; of sums that follow from moments
/// of the slowness, which are rounded, the second may be less than nothing. Errors of the ratios: the sum
/// over groups of the squares of what each group adds to the numerator beyond its share.
MeanAndDeviation moments_of(const std::vector<MomentSums>& groups) {
  MomentSums all;
  for (const MomentSums& g : groups) {
    all.q += g.q;
    all.qu += g.qu;
    all.quu += g.quu;
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  if (all.q == 0) return {none, none, none, none};
  const Sum centre = all.qu / all.q;
  const auto first = [&](const MomentSums& g) {
    return static_cast<double>(static_cast<SignedSum>(g.qu - centre * g.q));
  };
  const auto second = [&](const MomentSums& g) {
    return static_cast<double>(static_cast<SignedSum>(g.quu - 2 * centre * g.qu + centre * centre * g.q));
  };
  const double q = static_cast<double>(all.q), mean = first(all) / q,
               variance = std::max(0.0, second(all) / q - mean * mean);
  double of_mean = 0, of_variance = 0;
  for (const MomentSums& g : groups) {
    const double weight = static_cast<double>(g.q);
    of_mean += portable::pow(first(g) - mean * weight, 2);
    of_variance += portable::pow(second(g) - 2 * mean * first(g) + (mean * mean - variance) * weight, 2);
  }
  const double n = static_cast<double>(groups.size()), scatter = n / (n - 1), deviation = std::sqrt(variance);
  return {static_cast<double>(centre) + mean, std::sqrt(scatter * of_mean) / q, deviation,
          deviation > 0 ? std::sqrt(scatter * of_variance) / (2 * q * deviation) : 0};
}

/// C and S are the sums of q cos and q sin, R their length over that of q. Errors of ratios as above: what
/// each group adds across the mean direction moves the direction, what it adds along it beyond its share
/// changes R.
MeanAndDeviation direction_of(const std::vector<MomentSums>& groups) {
  const auto number = [](Sum steps, Sum q) {  // from the middle of the step
    return static_cast<double>(static_cast<SignedSum>(2 * steps + q)) / moment_steps - static_cast<double>(q);
  };
  double q = 0, c = 0, s = 0;
  for (const MomentSums& g : groups) {
    q += static_cast<double>(g.q);
    c += number(g.qu, g.q);
    s += number(g.quu, g.q);
  }
  constexpr double none = std::numeric_limits<double>::quiet_NaN();
  const double length = portable::hypot(c, s);
  if (q == 0 || length == 0) return {none, none, none, none};
  // Cosines and sines are known to a step of 2/moment_steps: a deviation of less than 0.02 degrees is none.
  const double r = std::min(1.0, length / q),
               deviation = 1 - r < 2.0 / moment_steps ? 0 : std::sqrt(-2 * portable::log(r));
  double across = 0, along = 0;
  for (const MomentSums& g : groups) {
    const double x = number(g.qu, g.q), y = number(g.quu, g.q);
    across += portable::pow((y * c - x * s) / length, 2);
    along += portable::pow((x * c + y * s) / length - r * static_cast<double>(g.q), 2);
  }
  const double n = static_cast<double>(groups.size()), scatter = n / (n - 1);
  return {portable::atan2(s, c), std::sqrt(scatter * across) / (q * r), deviation,
          deviation > 0 ? std::sqrt(scatter * along) / (q * r * deviation) : 0};
}

void finish_tallies(const Summed& run, Result& result) { TallyFinisher(run, result).finish(); }

}  // namespace rabiline
