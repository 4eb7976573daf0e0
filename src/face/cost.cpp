#include "face/cost.hpp"

#include <algorithm>
#include <ctime>
#include <vector>

#include <fmt/format.h>

#include "simulation/field_check.hpp"
#include "simulation/run.hpp"

namespace rabiline {
namespace {

constexpr double start_up = 0.012,  // [s] of the program
    each_bin = 9e-8;                // [s] to finish and write its count and error
constexpr std::uint64_t first_particles = 8;
constexpr double enough = 5e-3, plenty = 0.25;  // [s] to time a difference well; to time anything well
constexpr double longest = 0.5;  // [s] of the first particles: what takes more is told as it is reckoned
constexpr double too_long = 2;   // [s] of them, whatever was reckoned
constexpr std::size_t most_sums = 1U << 23;  // 128 MiB: beyond that, nothing is flown for a line of text

double bins_of(const Experiment& experiment) {
  double bins = 0;
  for (const PlacedPart& part : experiment.points.front().parts)
    if (const Detector* detector = detector_in(part.part))
      bins += static_cast<double>(detector->bins.x) * static_cast<double>(detector->bins.z);
  return bins * static_cast<double>(experiment.points.size());
}

/// What the plan estimates for all of its particles [s].
double estimate_of(const Plan& plan) {
  double seconds = 0;
  for (const PlanTree& tree : plan.trees) seconds += tree.cost * static_cast<double>(tree.last - tree.first);
  return seconds;
}

/// The first particles of some trees.
Plan sample_of(const Plan& plan, std::uint64_t particles, const std::vector<std::size_t>& trees) {
  Plan sample = plan;
  for (PlanTree& tree : sample.trees) tree.last = tree.first;
  for (const std::size_t k : trees)
    sample.trees[k].last = std::min(plan.trees[k].last, plan.trees[k].first + particles);
  return sample;
}

template <class Work>
double time_of(Work work) {
  const double begin = processor_time();
  work();
  return processor_time() - begin;
}
/// CalledOff where it takes too long.
double time_to_fly(const Plan& plan) {
  RunOptions options;
  options.isa = best_isa();
  options.latest = call_after(too_long).latest;
  return time_of([&] {
    if (!run(plan, options).finished) throw CalledOff();
  });
}

/// Sums are made and added up once, however many particles fly: what one more takes is told from two flights.
template <class TimeToFly>
double time_of_flights(const Plan& plan, TimeToFly time_to_fly) {
  constexpr std::size_t many_trees = 64;  // each of which few particles fly through
  const double all = estimate_of(plan);
  const double clearing = static_cast<double>(plan.sums * sizeof(Sum)) / 2e9;  // [s], once more or less
  if (plan.sums > most_sums) return all;
  const std::size_t last = plan.trees.size() - 1;
  if (estimate_of(sample_of(plan, first_particles, {last / 2})) > longest) return all;
  if (plan.trees.size() > many_trees && all < plenty) return time_to_fly(plan);
  std::uint64_t particles = first_particles;
  double flown = 0, seconds = 0;
  const std::vector<std::size_t> one{last / 2}, three{0, last / 2, last};
  for (const auto* trees : {&one, &three}) {
    const Plan sample = sample_of(plan, particles, *trees);
    flown = estimate_of(sample);
    seconds = time_to_fly(sample);
    if (seconds <= plenty) continue;
    // Either each particle takes that long, or what is done once for all of them.
    const double twice =
        flown > 0.1 * seconds ? 2 * seconds : time_to_fly(sample_of(plan, 2 * particles, *trees));
    if (twice > 1.5 * seconds) return seconds + (twice - seconds) * (all - flown) / flown;
    break;
  }
  for (;;) {
    const double unsure = std::max({enough, 0.5 * seconds, clearing});
    const double further = std::clamp(2 * unsure / flown, 4.0, unsure > enough ? 64.0 : 4.0);
    const Plan sample = sample_of(plan, particles *= static_cast<std::uint64_t>(further), three);
    const double more = estimate_of(sample);
    if (more == flown) return seconds * std::max(1.0, all / flown);
    const double longer = time_to_fly(sample);
    if (longer - seconds > unsure || more == all)
      return longer + std::max(0.0, longer - seconds) * (all - more) / (more - flown);
    flown = more;
    seconds = longer;
  }
}

/// At least, where some of the particles take too long.
double time_of_flight(const Plan& plan) {
  double flown = 1;
  try {
    return time_of_flights(plan, [&](const Plan& sample) {
      flown = estimate_of(sample);
      return time_to_fly(sample);
    });
  } catch (const CalledOff&) {
    return std::max(1.0, too_long / flown) * estimate_of(plan);
  }
}

}  // namespace

double processor_time() {
  std::timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

Cost cost_of(const Experiment& experiment, const Form& form, double planning) {
  const Plan& plan = form.plan;
  constexpr double of_field_check = 0.3;  // [s] about the most that it takes: what is longer hides it
  // Points that follow are planned once more. Of slabs that fly four parts as long as one have been planned,
  // and each is planned three times.
  const bool in_slabs = form.slabs > 1, fly = form.flies_in_slabs();
  const double flights = fly ? static_cast<double>(form.slabs) : 1;
  const double plans = fly ? 0.75 * flights : in_slabs ? 2 : 1;
  double seconds =
      start_up + plans * planning + flights * time_of_flight(plan) + each_bin * bins_of(experiment);
  if (seconds < of_field_check) seconds += time_of([&] { check_fields(plan, best_isa()); });
  return {seconds, static_cast<double>(plan.sums * sizeof(Sum) + bytes_of_stages(plan))};
}

std::string told(const Cost& cost, const Experiment& experiment, const Form& form) {
  const std::size_t points = experiment.points.size();
  return fmt::format(
      "\ncost       about {:.2g} s on one core{}; {:.0f} MiB of memory for each thread\n{}", cost.seconds,
      points > 1 ? fmt::format(", {:.2g} s for each of {} scan points",
                               cost.seconds / static_cast<double>(points), points)
                 : "",
      cost.memory / 1048576,
      form.slabs > 1 ? fmt::format("           scan points {} in {} slabs, one behind the other\n",
                                   form.flies_in_slabs() ? "fly" : "follow from one flight", form.slabs)
                     : "");
}

}  // namespace rabiline
