#pragma once
// From sums of quanta to counts with their variances.
#include <algorithm>
#include <cmath>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/portable_math.hpp"
#include "plan/plan.hpp"
#include "spin/level_names.hpp"

namespace rabiline {

inline constexpr double quanta = static_cast<double>(quanta_per_particle);
/// What is calculated of quanta, or of their squares.
inline Sum rounded(double x) { return static_cast<Sum>(std::floor(std::max(0.0, x) + 0.5)); }
inline double particles(Sum q) { return static_cast<double>(q) / quanta; }

/// What is counted of a particle that weighs one, as the screens' kernels do [quanta].
inline std::uint64_t counted_of_one(double efficiency) {
  return static_cast<std::uint64_t>(std::floor(quanta * efficiency));
}

/// Half the width of Wilson's interval (1927) at one standard deviation, for k of n: never zero, never
/// outside.
inline double wilson_error(double k, double n) {
  const double p = k / n;
  return std::sqrt(p * (1 - p) / n + 1 / (4 * n * n)) / (1 + 1 / n);
}

/// Variance of what was counted of n particles of one species, in particles^2: Wilson's where everything that
/// was counted weighs `each`, the most that it can; else the standard one. Species are drawn in fixed shares,
/// so their variances add up. Shares of a particle between levels are rounded to quanta, 1e-12 of it each.
inline double variance_of(const Moments& m, double n, std::uint64_t each = quanta_per_particle) {
  const double sum2 = static_cast<double>(m.q2);
  if (std::abs(sum2 - static_cast<double>(m.q) * static_cast<double>(each)) <= 1e-10 * sum2) {
    const double weight = particles(each);
    return weight == 0 ? 0 : portable::pow(weight * n * wilson_error(particles(m.q) / weight, n), 2);
  }
  const double q = particles(m.q);
  if (n < 2) return q * q;  // by one particle nothing is known of how they scatter
  return std::max(0.0, static_cast<double>(m.q2) / (quanta * quanta) - q * q / n);
}

/// A histogram over all species: counts and their variances.
struct Counts {
  explicit Counts(std::size_t bins) : counts(bins, 0.0), variances(bins, 0.0) {}
  std::vector<double> counts, variances;
  void add(const std::vector<Moments>& species, double n, std::uint64_t each = quanta_per_particle) {
    const double of_none = variance_of({}, n, each);
    for (std::size_t b = 0; b < species.size(); ++b) {
      if (species[b].q == 0 && species[b].q2 == 0) {
        variances[b] += of_none;
        continue;
      }
      counts[b] += particles(species[b].q);
      variances[b] += variance_of(species[b], n, each);
    }
  }
  void put(std::vector<double>& to, std::vector<double>& errors) const {
    to.insert(to.end(), counts.begin(), counts.end());
    const std::size_t before = errors.size();
    errors.resize(before + variances.size());
    std::transform(variances.begin(), variances.end(), errors.begin() + static_cast<std::ptrdiff_t>(before),
                   [](double variance) { return std::sqrt(variance); });
  }
};

/// How many particles of a tree are in a group.
inline double members(const PlanTree& tree, std::uint64_t group) {
  const auto below = [&](std::uint64_t n) { return n / group_count + (group < n % group_count ? 1 : 0); };
  return static_cast<double>(below(tree.last) - below(tree.first));
}

/// Adds how far what was counted of each group is from what its size, or the weight emitted in it, lets
/// expect.
inline void add_deviations(const PlanTree& tree, const Sums& sums, const Sum* groups, const Moments& total,
                           std::vector<double>& deviations) {
  const bool weighted = sums_of(tree.source).weights_differ;
  const double emitted =
      weighted ? particles(sums[tree.sums + EmissionSums::q()]) : static_cast<double>(tree.last - tree.first);
  for (std::size_t g = 0; g < group_count; ++g) {
    const double size = weighted ? particles(sums[tree.sums + EmissionSums::group(g)]) : members(tree, g);
    deviations[g] += particles(groups[g]) - particles(total.q) / emitted * size;
  }
}

inline double covariance_of(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t g = 0; g < group_count; ++g) sum += a[g] * b[g];
  return sum * static_cast<double>(group_count) / (group_count - 1);
}

/// Standard error of the fraction of the emitted weight that was counted: binomial where all particles weigh
/// the same, from the scatter of the groups where they do not. Where nothing was counted there is no scatter,
/// and the binomial error of no count in n is what bounds the fraction. `scatter`: the fraction's variance.
inline double fraction_error(const Moments& counted, double variance, const Moments& emitted,
                             double scatter) {
  const bool alike = emitted.q2 == emitted.q * quanta_per_particle;
  return alike || counted.q == 0 ? std::sqrt(variance) / particles(emitted.q) : std::sqrt(scatter);
}

/// Of more points nobody reads a matrix.
inline constexpr std::size_t most_points_of_covariance = 2048;

/// Between points that fly the same particles: how they vary together is told by how far each group is from
/// what its size lets expect, and by what is `known` otherwise; how much each varies, by its own error, which
/// the scatter of the groups knows to 9 % only. Nothing where there is no such thing. `deviations`:
/// [points][groups], `errors`: [points].
template <class Known>
std::vector<double> covariance_of(const std::vector<std::vector<double>>& deviations,
                                  std::span<const double> errors, ScanParticles mode, Known known) {
  const std::size_t points = deviations.size();
  if (points < 2 || points > most_points_of_covariance || mode != ScanParticles::shared) return {};
  const auto scatter = [&](std::size_t a, std::size_t b) {
    return covariance_of(deviations[a], deviations[b]) + known(a, b);
  };
  std::vector<double> covariance(points * points), scale(points);
  for (std::size_t a = 0; a < points; ++a) {
    const double own = scatter(a, a);
    scale[a] = own > 0 ? errors[a] / std::sqrt(own) : 0;
    covariance[a * points + a] = errors[a] * errors[a];
    for (std::size_t b = 0; b < a; ++b)
      covariance[a * points + b] = covariance[b * points + a] = scale[a] * scale[b] * scatter(a, b);
  }
  return covariance;
}

/// n + 1 edges of equal bins.
inline std::vector<double> edges_of(double low, double high, std::int64_t bins) {
  std::vector<double> edges;
  for (std::int64_t i = 0; i <= bins; ++i)
    edges.push_back(std::lerp(low, high, static_cast<double>(i) / static_cast<double>(bins)));
  return edges;
}

inline std::vector<std::string> names_of_levels(const Species& species, int levels) {
  return species.structure ? names_of_levels(coupled_spins(*species.structure)) : names_of_levels(levels);
}

/// What rows of levels are called: the level, after the species where several fly.
inline std::vector<std::string> labels_of(const Beamline& beamline, int component, int levels) {
  const Species& species = beamline.species[static_cast<std::size_t>(component)].species;
  std::vector<std::string> labels = law_traits(beamline.law).has_levels
                                        ? names_of_levels(species, levels)
                                        : std::vector<std::string>{"(1 + S_z)/2", "(1 - S_z)/2"};
  if (beamline.species.size() > 1)
    for (std::string& label : labels) label.insert(0, species.name + " ");
  return labels;
}

/// The tallies that concern each scan point.
template <class Tally>
class AtPoints {
 public:
  AtPoints(const std::vector<Tally>& tallies, std::size_t points) : at_(points) {
    for (const Tally& tally : tallies)
      for (const int point : *tally.points) at_[static_cast<std::size_t>(point)].emplace_back(tally);
  }
  const std::vector<std::reference_wrapper<const Tally>>& operator[](std::size_t point) const {
    return at_[point];
  }

 private:
  std::vector<std::vector<std::reference_wrapper<const Tally>>> at_;
};

}  // namespace rabiline
