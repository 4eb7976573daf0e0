#include "simulation/finish.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <tuple>

#include <fmt/format.h>

#include "particle/fate.hpp"
#include "section/section.hpp"
#include "simulation/contraction.hpp"
#include "simulation/counting.hpp"
#include "simulation/finish_tallies.hpp"
#include "simulation/tallies.hpp"
#include "simulation/transit_times.hpp"

namespace rabiline {
namespace {

/// Turns the sums of one run into a Result.
class Finisher {
 public:
  Finisher(const Experiment& experiment, const Plan& plan, Sums sums)
      : experiment_(experiment),
        plan_(plan),
        sums_(std::move(sums)),
        covariances_(contract_moments(plan, sums_)),
        tallies_(plan),
        points_(static_cast<std::size_t>(plan.points)),
        screens_(tallies_.screens, points_),
        levels_(tallies_.level_tallies, points_) {}

  Result finish() {
    const Beamline& first = experiment_.points.front();
    result_.title = first.title;
    result_.axes = experiment_.axes;
    result_.particles_mode = experiment_.particles;
    result_.particles = first.particles;
    result_.seed = first.seed;
    for (const Beamline& beamline : experiment_.points) {
      result_.laws.push_back(describe(beamline.law));
      result_.species.push_back(species_of(beamline));
    }
    count_emitted();
    add_detectors();
    finish_tallies({experiment_, plan_, sums_, tallies_, emitted_}, result_);
    add_fates();
    return std::move(result_);
  }

 private:
  static std::string species_of(const Beamline& beamline) {
    if (beamline.species.size() == 1) return beamline.species.front().species.name;
    std::string text;
    for (const Component& c : beamline.species) {
      if (!text.empty()) text += " + ";
      text += fmt::format("{:g} {}", c.fraction, c.species.name);
    }
    return text;
  }

  void count_emitted() {
    emitted_.assign(points_, {});
    for (const PlanTree& tree : plan_.trees)
      for (const int p : tree.points) {
        emitted_[static_cast<std::size_t>(p)].q += sums_[tree.sums + EmissionSums::q()];
        emitted_[static_cast<std::size_t>(p)].q2 += sums_[tree.sums + EmissionSums::q2()];
      }
    for (const Moments& m : emitted_) {
      result_.emitted.push_back(particles(m.q));
      result_.emitted_quanta_high.push_back(static_cast<std::uint64_t>(m.q >> 64));
      result_.emitted_quanta_low.push_back(static_cast<std::uint64_t>(m.q));
    }
    const Aperture& target = plan_.trees.front().source.target;
    if (plan_.trees.front().source.direction.kind == DirectionKind::aimed) {
      result_.solid_angle = area_of(target) / (target.y * target.y);
    }
    add_absolute_numbers();
  }

  void add_absolute_numbers() {
    result_.rate = experiment_.points.front().source.rate.value_or(0);
    const auto is_aimed = [](const Beamline& b) {
      return std::holds_alternative<AimedDirection>(b.source.direction);
    };
    if (std::none_of(experiment_.points.begin(), experiment_.points.end(), is_aimed)) return;
    Transmissions known;
    for (const Beamline& b : experiment_.points) result_.aimed_fraction.push_back(aimed_fraction(b, known));
  }

  // ---- detectors ----

  void add_detectors() {
    const ScreenGrids grids = screen_grids(experiment_.points);
    const Beamline& first = experiment_.points.front();
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
      for (std::size_t p = 0; p < points_; ++p) add_counts(p, grid, detector);
      detector.detected_covariance = covariance_of(
          deviations_[detector.name], experiment_.particles,
          [&](std::size_t a, std::size_t b) { return covariance_by_moments(detector.name, a, b); });
      add_detected_of_all(detector);
      add_count_rate(detector);
      add_levels(detector);
      detector.transits = transits_to(number_of(first, detector.name), first, plan_, sums_);
      result_.detectors.push_back(std::move(detector));
    }
  }

  /// Of all that leave an aimed source, what is detected: the emitted weight per particle, which is below 1
  /// where fewer start towards a place of the target than to where most do, times the share that weight 1
  /// stands for.
  void add_detected_of_all(DetectorResult& detector) const {
    for (std::size_t p = 0; p < result_.aimed_fraction.size(); ++p) {
      const double share = result_.aimed_fraction[p] * particles(emitted_[p].q) /
                           static_cast<double>(experiment_.points[p].particles);
      detector.detected_of_all.push_back(share * detector.detected[p]);
      detector.detected_of_all_errors.push_back(share * detector.detected_errors[p]);
    }
  }

  /// What a real run would count each second: the counted part of all that leave the source, and the
  /// background.
  void add_count_rate(DetectorResult& detector) const {
    if (result_.rate == 0) return;
    for (std::size_t p = 0; p < points_; ++p) {
      const double weight = particles(emitted_[p].q) / static_cast<double>(experiment_.points[p].particles);
      const double aimed = result_.aimed_fraction.empty() ? 1 : result_.aimed_fraction[p];
      const double leaving = result_.rate * aimed * weight;
      detector.count_rate.push_back(leaving * detector.detected[p] + detector.background);
      detector.count_rate_errors.push_back(result_.rate * aimed * rate_errors_.at(detector.name)[p] /
                                           static_cast<double>(experiment_.points[p].particles));
    }
  }

  void add_counts(std::size_t p, const ScreenGrid& grid, DetectorResult& detector) {
    const Beamline& beamline = experiment_.points[p];
    const int part = number_of(beamline, detector.name);
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
      const Sum* s = &sums_[screen.at];
      // A particle's shares in several bins are one score: its square is not the sum of theirs.
      const Moments whole{s[screen.layout.total()], s[screen.layout.total() + 1]};
      std::vector<Moments> own(nx * nz), own_x(nx), own_z(nz), own_total{whole};
      all.q += whole.q;
      all.q2 += whole.q2;
      for (std::size_t b = 0; b < own.size(); ++b)
        for (Moments* m : {&own[b], &own_x[b / nz], &own_z[b % nz]}) {
          m->q += s[ScreenSums::bin(b)];
          m->q2 += s[ScreenSums::bin(b) + 1];
        }
      for (std::size_t x = 0; x < nx; ++x) own_x[x].q2 += s[screen.layout.across_column(x)];
      for (std::size_t z = 0; z < nz; ++z) own_z[z].q2 += s[screen.layout.across_row(z)];
      const double n = static_cast<double>(screen.tree->last - screen.tree->first);
      bins.add(own, n, each);
      along_x.add(own_x, n, each);
      along_z.add(own_z, n, each);
      total.add(own_total, n, each);
      if (!screen.by_moments)
        add_deviations(*screen.tree, sums_, s + screen.layout.group(0), own_total[0], deviations);
      component_weights_[detector.name][p][screen.tree->component] = own_total[0];
    }
    bins.put(detector.counts, detector.counts_errors);
    along_x.put(detector.counts_x, detector.counts_x_errors);
    along_z.put(detector.counts_z, detector.counts_z_errors);
    const Moments& emitted = emitted_[p];
    const double fraction = particles(all.q) / particles(emitted.q);
    detector.detected.push_back(fraction);
    for (double& d : deviations) d /= particles(emitted.q);
    const double by_moments = covariance_by_moments(detector.name, p, p);
    detector.detected_errors.push_back(
        fraction_error(all, total.variances[0], emitted, covariance_of(deviations, deviations) + by_moments));
    rate_errors_[detector.name].push_back(std::sqrt(total.variances[0]));
    deviations_[detector.name].push_back(std::move(deviations));
    totals_[detector.name].push_back(all);
  }

  /// Between the detected fractions of two points, of what was booked as moments.
  double covariance_by_moments(const std::string& detector, std::size_t a, std::size_t b) const {
    double sum = 0;
    for (const ScreenCovariance& c : covariances_)
      if (experiment_.points.front().parts[static_cast<std::size_t>(c.part)].placement.name == detector)
        sum += c.between(a, b);
    return sum / (particles(emitted_[a].q) * particles(emitted_[b].q));
  }

  // ---- levels ----

  /// What a row of levels is called: the level, after the species where several fly.
  static std::string label_of(const Beamline& beamline, int component, int levels, int level) {
    const Species& species = beamline.species[static_cast<std::size_t>(component)].species;
    const std::string name = name_of_level(beamline, species, levels, level);
    return beamline.species.size() == 1 ? name : species.name + " " + name;
  }
  static std::string name_of_level(const Beamline& beamline, const Species& species, int levels, int level) {
    if (!law_traits(beamline.law).has_levels) return level == 0 ? "(1 + S_z)/2" : "(1 - S_z)/2";
    return names_of_levels(species, levels)[static_cast<std::size_t>(level)];
  }

  /// What a level got of the weight w of each particle: sums of q, q^2 and q w.
  struct LevelMoments {
    Sum q = 0, q2 = 0, qw = 0;
  };
  LevelMoments moments_of(const LevelTally& tally, std::size_t level, const Moments& weights) const {
    const LevelLayout layout{static_cast<std::size_t>(tally.levels)};
    const auto sum = [&](std::size_t at) { return sums_[tally.at + at]; };
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
      const int part = number_of(experiment_.points[p], detector.name);
      for (const LevelTally& tally : levels_[p]) {
        if (tally.part != part) continue;
        const Moments& weights = component_weights_[detector.name][p][tally.component];
        for (int level = 0; level < tally.levels; ++level) {
          const std::string label = label_of(experiment_.points[p], tally.component, tally.levels, level);
          if (std::find(detector.level_labels.begin(), detector.level_labels.end(), label) ==
              detector.level_labels.end())
            detector.level_labels.push_back(label);
          found[p][label] = moments_of(tally, static_cast<std::size_t>(level), weights);
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

  // ---- fates ----

  struct LedgerRow {
    std::vector<Sum> all, by_level;  // [points], [points][levels]
  };

  void add_fates() {
    name_ledger_columns();
    const std::size_t levels = result_.ledger_levels.size();
    std::vector<Sum> left(points_ * levels);
    std::vector<bool> has_ledger(points_ * levels);
    for (const PlanTree& tree : plan_.trees)
      for (const int p : tree.points)
        for (std::size_t level = 0; level < tree.ledger_levels; ++level) {
          const std::size_t at = ledger_place(p, tree.component, level);
          left[at] += sums_[tree.ledger + level];
          has_ledger[at] = true;
        }
    const auto shown = [&](const std::vector<Sum>& sums) {
      std::vector<double> out;
      for (std::size_t at = 0; at < sums.size(); ++at)
        out.push_back(has_ledger[at] ? particles(sums[at]) : std::numeric_limits<double>::quiet_NaN());
      return out;
    };
    result_.emitted_by_level = shown(left);
    std::map<std::pair<std::string, std::string>, LedgerRow> ledger;
    for (const FateTally& tally : tallies_.fates)
      for (const int p : *tally.points) {
        const auto point = static_cast<std::size_t>(p);
        const std::string where =
            tally.part == chamber_number ? "chamber"
            : tally.part == no_part
                ? ""
                : experiment_.points[point].parts[static_cast<std::size_t>(tally.part)].placement.name;
        LedgerRow& row = ledger[{std::string(tally.fate), where}];
        row.all.resize(points_);
        row.by_level.resize(points_ * levels);
        row.all[point] += sums_[tally.at];
        for (std::size_t level = 0; tally.ledger != 0 && level < tally.levels; ++level) {
          const std::size_t at = ledger_place(p, tally.component, level);
          const Sum q = sums_[tally.ledger + (tally.fate == fate::detected ? LedgerSums::caught(level)
                                                                           : LedgerSums::ended(level))];
          row.by_level[at] += q;
          left[at] -= q;
        }
      }
    for (const auto& [key, row] : ledger) {
      FateResult ended{key.first, key.second, {}, {}, {}, shown(row.by_level)};
      for (const Sum q : row.all) {
        ended.quanta_high.push_back(static_cast<std::uint64_t>(q >> 64));
        ended.quanta_low.push_back(static_cast<std::uint64_t>(q));
        ended.particles.push_back(particles(q));
      }
      result_.fates.push_back(std::move(ended));
    }
    for (std::size_t p = 0; p < points_; ++p) {
      Sum all = 0;
      for (const auto& [key, row] : ledger) all += row.all[p];
      if (all != emitted_[p].q)
        throw std::logic_error(
            fmt::format("the fates of scan point {} do not add up to what was emitted", p));
    }
    if (std::any_of(left.begin(), left.end(), [](Sum q) { return q != 0; }))
      throw std::logic_error(
          "the fates of the particles prepared in a level do not add up to what was emitted");
  }

  /// One column of the ledger by level for every label that occurs.
  void name_ledger_columns() {
    using Levels = std::tuple<std::string, int, int, std::size_t>;  // species, I, J, how many
    std::map<std::pair<int, Levels>, std::vector<std::size_t>> known;
    ledger_columns_.resize(points_);
    for (const PlanTree& tree : plan_.trees)
      for (const int p : tree.points) {
        if (tree.ledger_levels == 0) continue;
        const Beamline& beamline = experiment_.points[static_cast<std::size_t>(p)];
        const Species& species = beamline.species[static_cast<std::size_t>(tree.component)].species;
        const Levels key{species.name, species.structure ? species.structure->i.twice : -1,
                         species.spin.twice, tree.ledger_levels};
        std::vector<std::size_t>& columns = known[{tree.component, key}];
        for (std::size_t level = columns.size(); level < tree.ledger_levels; ++level)
          columns.push_back(ledger_column(label_of(
              beamline, tree.component, static_cast<int>(tree.ledger_levels), static_cast<int>(level))));
        ledger_columns_[static_cast<std::size_t>(p)][tree.component] = columns;
      }
  }
  std::size_t ledger_column(const std::string& label) {
    const auto found = std::find(result_.ledger_levels.begin(), result_.ledger_levels.end(), label);
    if (found == result_.ledger_levels.end()) {
      result_.ledger_levels.push_back(label);
      return result_.ledger_levels.size() - 1;
    }
    return static_cast<std::size_t>(found - result_.ledger_levels.begin());
  }
  std::size_t ledger_place(int point, int component, std::size_t level) const {
    const auto p = static_cast<std::size_t>(point);
    return p * result_.ledger_levels.size() + ledger_columns_[p].at(component)[level];
  }

  const Experiment& experiment_;
  const Plan& plan_;
  Sums sums_;
  const std::vector<ScreenCovariance> covariances_;
  const Tallies tallies_;
  const std::size_t points_;
  const AtPoints<ScreenTally> screens_;
  const AtPoints<LevelTally> levels_;
  std::vector<std::map<int, std::vector<std::size_t>>> ledger_columns_;  // [points]: component, [levels]
  std::vector<Moments> emitted_;                                         // [points]
  std::map<std::string, std::vector<std::vector<double>>> deviations_;   // detector: [points][groups]
  std::map<std::string, std::vector<Moments>> totals_;                   // detector: [points]
  std::map<std::string, std::vector<double>> rate_errors_;  // detector: [points] of what was counted
  std::map<std::string, std::map<std::size_t, std::map<int, Moments>>>
      component_weights_;  // of what was counted
  Result result_;
};

}  // namespace

Result finish(const Experiment& experiment, const Plan& plan, Sums sums) {
  return Finisher(experiment, plan, std::move(sums)).finish();
}

}  // namespace rabiline
