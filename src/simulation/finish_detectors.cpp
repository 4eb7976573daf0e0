#include "simulation/finish_detectors.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "simulation/counting.hpp"
#include "simulation/transit_times.hpp"

namespace rabiline {
namespace {

class DetectorFinisher {
 public:
  DetectorFinisher(const Summed& run, Result& result)
      : run_(run),
        result_(result),
        points_(run.experiment.points.size()),
        screens_(run.tallies.screens, points_),
        levels_(run.tallies.level_tallies, points_) {}

  void finish() {
    const ScreenGrids grids = screen_grids(run_.experiment.points);
    const Beamline& first = run_.experiment.points.front();
    for (const PlacedPart& part : first.parts) {
      const Detector* screen = detector_in(part.part);
      if (!screen) continue;
      DetectorResult detector;
      detector.name = part.placement.name;
      detector.label = part.placement.label.value_or(detector.name);
      detector.y = part.placement.at;
      detector.background = screen->background;
      const ScreenGrid& grid = grids.at(detector.name);
      detector.x = {"x", edges_of(grid.low_x, grid.high_x, screen->bins.x)};
      detector.z = {"z", edges_of(grid.low_z, grid.high_z, screen->bins.z)};
      const std::size_t bins = (detector.x.edges.size() - 1) * (detector.z.edges.size() - 1);
      detector.counts.reserve(points_ * bins);
      detector.counts_errors.reserve(points_ * bins);
      for (std::size_t p = 0; p < points_; ++p) add_counts(p, grid, detector);
      detector.detected_covariance = covariance_of(
          deviations_[detector.name], detector.detected_errors, run_.experiment.particles,
          [&](std::size_t a, std::size_t b) { return run_.covariance_by_moments(detector.name, 0, a, b); });
      add_detected_of_all(detector);
      add_count_rate(detector);
      add_levels(detector);
      detector.transits = transits_to(run_.parts.of(detector.name, 0), first, run_.plan, run_.sums);
      result_.detectors.push_back(std::move(detector));
    }
  }

 private:
  /// Of all that leave an aimed source, what is detected: the emitted weight per particle, which is below 1
  /// where fewer start towards a place of the target than to where most do, times the share that weight 1
  /// stands for. The emitted weight varies, too.
  void add_detected_of_all(DetectorResult& detector) const {
    for (std::size_t p = 0; p < result_.aimed_fraction.size(); ++p) {
      const double share =
          result_.aimed_fraction[p] / static_cast<double>(run_.experiment.points[p].particles);
      detector.detected_of_all.push_back(share * particles(run_.emitted[p].q) * detector.detected[p]);
      detector.detected_of_all_errors.push_back(share * rate_errors_.at(detector.name)[p]);
    }
  }

  /// What a real run would count each second: the counted part of all that leave the source, and the
  /// background.
  void add_count_rate(DetectorResult& detector) const {
    if (result_.rate == 0) return;
    for (std::size_t p = 0; p < points_; ++p) {
      const double weight =
          particles(run_.emitted[p].q) / static_cast<double>(run_.experiment.points[p].particles);
      const double aimed = result_.aimed_fraction.empty() ? 1 : result_.aimed_fraction[p];
      const double leaving = result_.rate * aimed * weight;
      detector.count_rate.push_back(leaving * detector.detected[p] + detector.background);
      detector.count_rate_errors.push_back(result_.rate * aimed * rate_errors_.at(detector.name)[p] /
                                           static_cast<double>(run_.experiment.points[p].particles));
    }
  }

  void add_counts(std::size_t p, const ScreenGrid& grid, DetectorResult& detector) {
    const Beamline& beamline = run_.experiment.points[p];
    const int part = run_.parts.of(detector.name, p);
    const auto& screen_part = std::get<Detector>(beamline.parts[static_cast<std::size_t>(part)].part);
    const std::uint64_t each = counted_of_one(screen_part.efficiency);
    if (grid.moves) {
      detector.offset_x.push_back(screen_part.offset.x);
      detector.offset_z.push_back(screen_part.offset.z);
    }
    const std::size_t nx = detector.x.edges.size() - 1, nz = detector.z.edges.size() - 1;
    Counts bins(nx * nz), along_x(nx), along_z(nz), total(1);
    Moments all;
    std::vector<double> deviations(group_count, 0.0);
    for (const ScreenTally& screen : screens_[p]) {
      if (screen.part != part) continue;
      const Sum* s = &run_.sums[screen.at];
      // A particle's shares in several bins are one score: its square is not the sum of theirs.
      const Moments whole{s[screen.layout.total()], s[screen.layout.total() + 1]};
      std::vector<Moments> own(nx * nz), own_x(nx), own_z(nz), own_total{whole};
      all.q += whole.q;
      all.q2 += whole.q2;
      for (std::size_t x = 0; x < nx; ++x)
        for (std::size_t z = 0; z < nz; ++z) {
          const std::size_t b = x * nz + z;
          const Moments here{s[ScreenSums::bin(b)], s[ScreenSums::bin(b) + 1]};
          if (here.q == 0) continue;
          for (Moments* m : {&own[b], &own_x[x], &own_z[z]}) {
            m->q += here.q;
            m->q2 += here.q2;
          }
        }
      for (std::size_t x = 0; x < nx; ++x) own_x[x].q2 += s[screen.layout.across_column(x)];
      for (std::size_t z = 0; z < nz; ++z) own_z[z].q2 += s[screen.layout.across_row(z)];
      const double n = static_cast<double>(screen.tree->last - screen.tree->first);
      bins.add(own, n, each);
      along_x.add(own_x, n, each);
      along_z.add(own_z, n, each);
      total.add(own_total, n, each);
      if (!screen.by_moments)
        add_deviations(*screen.tree, run_.sums, s + screen.layout.group(0), own_total[0], deviations);
      component_weights_[detector.name][p][screen.tree->component] = own_total[0];
    }
    bins.put(detector.counts, detector.counts_errors);
    along_x.put(detector.counts_x, detector.counts_x_errors);
    along_z.put(detector.counts_z, detector.counts_z_errors);
    const Moments& emitted = run_.emitted[p];
    const double fraction = particles(all.q) / particles(emitted.q);
    detector.detected.push_back(fraction);
    for (double& d : deviations) d /= particles(emitted.q);
    const double by_moments = run_.covariance_by_moments(detector.name, 0, p, p);
    detector.detected_errors.push_back(
        fraction_error(all, total.variances[0], emitted, covariance_of(deviations, deviations) + by_moments));
    rate_errors_[detector.name].push_back(std::sqrt(total.variances[0]));
    if (points_ <= most_points_of_covariance) deviations_[detector.name].push_back(std::move(deviations));
    totals_[detector.name].push_back(all);
  }

  // ---- levels ----

  /// What a level got of the weight w of each particle: sums of q, q^2 and q w.
  struct LevelMoments {
    Sum q = 0, q2 = 0, qw = 0;
  };
  LevelMoments moments_of(const LevelTally& tally, std::size_t level, const Moments& weights) const {
    const LevelLayout layout{static_cast<std::size_t>(tally.levels)};
    const auto sum = [&](std::size_t at) { return run_.sums[tally.at + at]; };
    LevelMoments m{sum(LevelLayout::q(level)), sum(LevelLayout::squares(level)), 0};
    // Two levels share the weight: (q1 + q2)^2 = w^2 tells q1 q2.
    const Sum squares = sum(LevelLayout::squares(0)) + sum(LevelLayout::squares(1));
    m.qw = layout.has_products() ? sum(layout.products(level))
                                 : m.q2 + (std::max(weights.q2, squares) - squares) / 2;
    return m;
  }
  /// Error of a level's share f of all that was detected: sum (q - f w)^2 over the particles.
  static double share_error(const LevelMoments& level, const Moments& all, double f) {
    const double sum = static_cast<double>(level.q2) - 2 * f * static_cast<double>(level.qw) +
                       f * f * static_cast<double>(all.q2);
    // What rounding leaves of numbers that cancel is no error.
    const double noise = 1e-12 * static_cast<double>(level.q2);
    return sum > noise ? std::sqrt(sum) / static_cast<double>(all.q) : 0;
  }

  /// One row for every label that occurs; NaN at points that do not have it.
  void add_levels(DetectorResult& detector) {
    std::vector<std::map<std::string, LevelMoments>> found(points_);
    for (std::size_t p = 0; p < points_; ++p) {
      const int part = run_.parts.of(detector.name, p);
      const Beamline beamline = run_.experiment.points[p];
      for (const LevelTally& tally : levels_[p]) {
        if (tally.part != part) continue;
        const Moments& weights = component_weights_[detector.name][p][tally.component];
        const std::vector<std::string> labels = labels_of(beamline, tally.component, tally.levels);
        for (std::size_t level = 0; level < static_cast<std::size_t>(tally.levels); ++level) {
          const std::string& label = labels[level];
          if (std::find(detector.level_labels.begin(), detector.level_labels.end(), label) ==
              detector.level_labels.end())
            detector.level_labels.push_back(label);
          found[p][label] = moments_of(tally, level, weights);
        }
      }
    }
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    for (std::size_t p = 0; p < points_; ++p) {
      const Moments& all = totals_[detector.name][p];
      for (const std::string& label : detector.level_labels) {
        const auto m = found[p].find(label);
        const bool there = m != found[p].end() && all.q > 0;
        const double fraction = there ? static_cast<double>(m->second.q) / static_cast<double>(all.q) : none;
        detector.levels.push_back(fraction);
        detector.levels_errors.push_back(there ? share_error(m->second, all, fraction) : none);
      }
    }
  }

  const Summed& run_;
  Result& result_;
  const std::size_t points_;
  const AtPoints<ScreenTally> screens_;
  const AtPoints<LevelTally> levels_;
  std::map<std::string, std::vector<std::vector<double>>> deviations_;  // detector: [points][groups]
  std::map<std::string, std::vector<Moments>> totals_;                  // detector: [points]
  std::map<std::string, std::vector<double>> rate_errors_;  // detector: [points] of what was counted
  std::map<std::string, std::map<std::size_t, std::map<int, Moments>>>
      component_weights_;  // of what was counted
};

}  // namespace

void finish_detectors(const Summed& run, Result& result) { DetectorFinisher(run, result).finish(); }

}  // namespace rabiline
