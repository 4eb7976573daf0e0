#include "simulation/finish.hpp"

#include <algorithm>
#include <functional>
#include <utility>

#include <fmt/format.h>

#include "simulation/contraction.hpp"
#include "simulation/counting.hpp"
#include "simulation/finish_detectors.hpp"
#include "simulation/finish_fates.hpp"
#include "simulation/finish_tallies.hpp"
#include "simulation/interpolation.hpp"

namespace rabiline {
namespace {

std::string species_of(const Beamline& beamline) {
  if (beamline.species.size() == 1) return beamline.species.front().species.name;
  std::string text;
  for (const Component& c : beamline.species) {
    if (!text.empty()) text += " + ";
    text += fmt::format("{:g} {}", c.fraction, c.species.name);
  }
  return text;
}

/// One text where all points agree.
std::vector<std::string> agreed(std::vector<std::string> texts) {
  if (std::ranges::adjacent_find(texts, std::not_equal_to{}) == texts.end()) texts.resize(1);
  return texts;
}

/// Of each scan point.
std::vector<Moments> emitted_of(const Plan& plan, const Sums& sums) {
  std::vector<Moments> emitted(static_cast<std::size_t>(plan.points));
  for (const PlanTree& tree : plan.trees)
    for (const int p : tree.points) {
      emitted[static_cast<std::size_t>(p)].q += sums[tree.sums + EmissionSums::q()];
      emitted[static_cast<std::size_t>(p)].q2 += sums[tree.sums + EmissionSums::q2()];
    }
  return emitted;
}

void add_emitted(const Summed& run, Result& result) {
  for (const Moments& m : run.emitted) {
    result.emitted.push_back(particles(m.q));
    result.emitted_quanta_high.push_back(static_cast<std::uint64_t>(m.q >> 64));
    result.emitted_quanta_low.push_back(static_cast<std::uint64_t>(m.q));
  }
  const Emission& source = run.plan.trees.front().source;
  if (source.direction.kind == DirectionKind::aimed)
    result.solid_angle = area_of(source.target) / (source.target.y * source.target.y);
}

/// The rate at which the source emits, and what part of it is emitted into the target that it is aimed at.
void add_absolute_numbers(const ScanPoints& points, Result& result) {
  result.rate = points.front().source.rate.value_or(0);
  const auto is_aimed = [](const Beamline& b) {
    return std::holds_alternative<AimedDirection>(b.source.direction);
  };
  if (std::none_of(points.begin(), points.end(), is_aimed)) return;
  Transmissions known;
  for (const Beamline& b : points) result.aimed_fraction.push_back(aimed_fraction(b, known));
}

}  // namespace

double Summed::covariance_by_moments(const std::string& part, int plane, std::size_t a, std::size_t b) const {
  double sum = 0;
  for (const CountCovariance& c : covariances)
    if (c.plane == plane &&
        experiment.points.front().parts[static_cast<std::size_t>(c.part)].placement.name == part)
      sum += c.between(a, b);
  return sum / (particles(emitted[a].q) * particles(emitted[b].q));
}

Result finish(const Experiment& experiment, const Plan& plan, Sums sums, int threads) {
  interpolate(plan, threads, sums);
  const std::vector<CountCovariance> covariances = contract_moments(plan, threads, sums);
  const Tallies tallies(plan);
  const std::vector<Moments> emitted = emitted_of(plan, sums);
  const Summed run{experiment, plan, sums, tallies, emitted, covariances, PartNumbers(experiment.points)};

  const Beamline& first = experiment.points.front();
  Result result;
  result.title = first.title;
  result.axes = experiment.axes;
  result.particles_mode = experiment.particles;
  result.particles = first.particles;
  result.seed = first.seed;
  for (const Beamline& beamline : experiment.points) {
    result.laws.push_back(describe(beamline.law));
    result.species.push_back(species_of(beamline));
  }
  result.laws = agreed(std::move(result.laws));
  result.species = agreed(std::move(result.species));
  add_emitted(run, result);
  add_absolute_numbers(experiment.points, result);
  finish_detectors(run, result);
  finish_tallies(run, result);
  finish_fates(run, result);
  return result;
}

}  // namespace rabiline
