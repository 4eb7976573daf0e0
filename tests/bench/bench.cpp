// The program against hand-written loops on this machine: one table of rates and their ratios. Repetitions of
// all benchmarks are interleaved, so that a drift of the machine's speed cancels.
#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cmath>
#include "bench/checks.hpp"
#include "bench/experiments.hpp"
#include "bench/table.hpp"

#include "simulation/finish.hpp"
#include "simulation/run.hpp"

namespace rabiline::bench {
namespace {

constexpr int frequencies = 101;
constexpr std::uint64_t beam_particles = 1 << 20, scan_particles = 1 << 16, dorado_particles = 1 << 13;
constexpr std::uint64_t rabi_particles = 1 << 16;
constexpr std::uint64_t wire_particles = 10'000'000, image_particles = 1'000'000, clock_particles = 1'000'000;
constexpr int dorado_points = 8, rabi_points = 201;

template <class Work>
void time_it(benchmark::State& state, double items, Work work) {
  for (auto _ : state) benchmark::DoNotOptimize(work());
  state.SetItemsProcessed(static_cast<std::int64_t>(static_cast<double>(state.iterations()) * items));
}

/// From the first particle to the result.
void program(benchmark::State& state, const Experiment& experiment, double items, int threads = 1) {
  const Plan plan = make_plan(experiment);
  RunOptions options;
  options.isa = best_isa();
  options.threads = threads;
  time_it(state, items, [&] { return finish(experiment, plan, run(plan, options).sums).emitted[0]; });
}

double dorado_steps() {
  const Experiment experiment = suggested_experiment(dorado_points, dorado_particles);
  double steps = 0;
  for (const Beamline& point : experiment.points) {
    Experiment one;
    one.points = {point};
    const Plan plan = make_plan(one);
    steps += steps_through(region_of(plan), emission_of(plan).speed.mean) * dorado_particles;
  }
  return steps;
}

// ---- the program ----

void beam_program(benchmark::State& state) {
  program(state, two_level_beamline(1, beam_particles), beam_particles);
}
void scan_program(benchmark::State& state) {
  program(state, two_level_beamline(frequencies, scan_particles), double{scan_particles} * frequencies);
}
void dorado_program(benchmark::State& state) {
  program(state, suggested_experiment(dorado_points, dorado_particles), dorado_steps());
}
void period_program(benchmark::State& state) {
  program(state, oscillating_field(beam_particles), beam_particles);
}
void rabi_program(benchmark::State& state, int points, int twice_spin) {
  program(state, rabis_apparatus(points, rabi_particles, twice_spin, {20, 20}),
          double{rabi_particles} * points);
}
/// One item is the whole scan.
void whole_scan(benchmark::State& state, int points, std::uint64_t particles, int twice_spin, Bins bins) {
  program(state, rabis_apparatus(points, particles, twice_spin, bins), 1);
}
void clock_program(benchmark::State& state) {
  program(state, clock(rabi_points, clock_particles), double{clock_particles} * rabi_points);
}
/// By processor time all threads' times count together: on a machine that others use too, the clock shows
/// them as well.
void dorado_threads(benchmark::State& state, int threads, bool processor_time) {
  program(state, suggested_experiment(dorado_points, dorado_particles),
          dorado_steps() * (processor_time ? threads : 1), threads);
}

void profile_program(benchmark::State& state) {
  const Experiment experiment = profiled_field(dorado_particles);
  const Plan plan = make_plan(experiment);
  const SpinZone& zone = zone_of(plan, ZoneKind::profiled);
  program(state, experiment,
          std::ceil((zone.end - zone.begin) / emission_of(plan).speed.mean / zone.step) * dorado_particles);
}

// ---- the limits ----

#if defined(RABILINE_HAS_LIMITS)
void beam_limit(benchmark::State& state, FlipSums (*limit)(const Emission&, const RabiLine&, std::uint64_t)) {
  const Plan plan = make_plan(two_level_beamline(1, beam_particles));
  const RabiLine line = lines_of(plan).at(0);
  time_it(state, beam_particles, [&] { return limit(emission_of(plan), line, beam_particles); });
}
void period_limit(benchmark::State& state) {
  const Plan plan = make_plan(oscillating_field(beam_particles));
  const SpinZone& zone = zone_of(plan, ZoneKind::periodic);
  const PeriodTable table(zone.spin_rate, zone.drive[0].spin_rate, zone.drive[0].omega);
  time_it(state, beam_particles, [&] {
    return oscillating_beam(emission_of(plan), table, zone.drive[0], zone.begin, zone.end, beam_particles).p;
  });
}
void scan_limit(benchmark::State& state) {
  const Plan plan = make_plan(two_level_beamline(frequencies, scan_particles));
  const std::vector<RabiLine> lines = lines_of(plan);
  std::vector<FlipSums> sums(lines.size());
  time_it(state, double{scan_particles} * frequencies, [&] {
    scan_of_normal_beam(emission_of(plan), lines, scan_particles, sums.data());
    return sums.back().p;
  });
}
void dorado_limit(benchmark::State& state) {
  const Plan plan = make_plan(suggested_experiment(1, 1));
  const RegionZone& zone = region_of(plan).zones.back();
  const Particle start{{0, 0.35, 0}, {0, 1000, 0}, {0, 0, -1}};
  constexpr int steps = 500, packs = 100;
  time_it(state, 8.0 * steps * packs,
          [&] { return turning_flight(zone.field, zone.step, 0, start, steps, packs).place[1]; });
}
void spin_limit(benchmark::State& state) {
  constexpr int steps = 875, packs = 100;
  time_it(state, 8.0 * steps * packs, [&] { return magnus_spin(1.8e5, 3e3, 1.83e5, 1.2e-6, steps, packs); });
}
void wires_flight(benchmark::State& state,
                  double (*fly)(const MagnetShape&, double, double, double, double, int, int)) {
  constexpr int steps = 400, packs = 100;
  time_it(state, 8.0 * steps * packs, [&] { return fly(two_wires(), 142, 1e-3, 6e-3, 1e-6, steps, packs); });
}
void map_flight(benchmark::State& state, double (*fly)(const MapShape&, int, int)) {
  const FieldMap map = map_of_64();
  constexpr int steps = 400, packs = 20;
  time_it(state, 8.0 * steps * packs, [&] { return fly(map.shape(1, MapOutside::zero), steps, packs); });
}
#endif

void register_all() {
#if defined(RABILINE_HAS_LIMITS)
  if (!supported(Isa::avx512)) {
    std::fputs("no AVX-512 here: the hand-written limits are left out\n", stderr);
  } else {
    check_limits();
    benchmark::RegisterBenchmark("beam/limit", beam_limit, normal_beam);
    benchmark::RegisterBenchmark("beam/paired limit", beam_limit, paired_normal_beam);
    benchmark::RegisterBenchmark("beam/flux-weighted limit", beam_limit, flux_weighted_beam);
    benchmark::RegisterBenchmark("scan/limit", scan_limit);
    benchmark::RegisterBenchmark("period/limit", period_limit);
    benchmark::RegisterBenchmark("dorado/limit", dorado_limit);
    benchmark::RegisterBenchmark("spin/limit", spin_limit);
    benchmark::RegisterBenchmark("wires/limit", wires_flight, wires_by_hand);
    benchmark::RegisterBenchmark("wires/program", wires_flight, wires_as_flown);
    benchmark::RegisterBenchmark("map/limit", map_flight, leapfrog_by_hand);
    benchmark::RegisterBenchmark("map/program", map_flight, leapfrog_as_flown);
  }
#endif
  // A run flies in threads of its own, so that the time of the one that waits for it tells nothing.
  const auto flown = [](const std::string& name, auto f, auto... of) {
    return benchmark::RegisterBenchmark(name.c_str(), f, of...)->MeasureProcessCPUTime();
  };
  flown("beam/program", beam_program);
  flown("scan/program", scan_program);
  flown("period/program", period_program);
  flown("dorado/program", dorado_program);
  flown("spin/program", profile_program);
  for (const int twice_spin : {1, 3}) {
    flown(fmt::format("rabi {}/2/one", twice_spin), rabi_program, 1, twice_spin);
    flown(fmt::format("rabi {}/2/scan", twice_spin), rabi_program, rabi_points, twice_spin);
  }
  for (const int points : {2, rabi_points, 1001}) {
    for (const int twice_spin : {1, 3})
      flown(fmt::format("wire {}/2/{}", twice_spin, points), whole_scan, points, wire_particles, twice_spin,
            Bins{1, 1})
          ->Repetitions(5);
    if (points <= rabi_points)
      flown(fmt::format("image/{}", points), whole_scan, points, image_particles, 1, Bins{20, 20})
          ->Repetitions(5);
  }
  flown("clock/program", clock_program)->Repetitions(5);
  for (const bool busy : {false, true}) {
    const std::string by = busy ? "by processor time" : "by the clock";
    for (const int threads : {1, 2}) {
      auto* timed = benchmark::RegisterBenchmark(fmt::format("threads {}/{}", by, threads).c_str(),
                                                 dorado_threads, threads, busy);
      busy ? timed->MeasureProcessCPUTime() : timed->UseRealTime();
    }
  }
}

const std::vector<Row> rows{
    {"two-level beamline, closed form [particles]", "beam/limit", "beam/program", 0.3, 0.5},
    {"  against a draw for two particles, as in the program [particles]", "beam/paired limit",
     "beam/program"},
    {"  against flux-weighted speeds [particles]", "beam/flux-weighted limit", "beam/program"},
    {"frequency scan, tracks reused [particles x frequencies]", "scan/limit", "scan/program", 0.25, 0.6},
    {"whole oscillating field at random phases, by its period [particles]", "period/limit", "period/program",
     0.4, 0.7},
    {"Rabi's apparatus, 201 points against one, spin 1/2", "rabi 1/2/one", "rabi 1/2/scan"},
    {"  spin 3/2 [particles x frequencies]", "rabi 3/2/one", "rabi 3/2/scan"},
    {"Rabi's apparatus, 1e7 particles, one slit: 201 points over 2, spin 1/2", "wire 1/2/2", "wire 1/2/201",
     1 / 1.5, 1 / 1.1},
    {"  1,001 points over 2 [scans]", "wire 1/2/2", "wire 1/2/1001", 1 / 2., 1 / 1.2},
    {"  201 points over 2, spin 3/2 [scans]", "wire 3/2/2", "wire 3/2/201", 1 / 1.5, 1 / 1.1},
    {"  1,001 points over 2, spin 3/2 [scans]", "wire 3/2/2", "wire 3/2/1001", 1 / 2., 1 / 1.2},
    {"  201 points [particles x frequencies]", "", "wire 1/2/201", 0, 0,
     double{wire_particles} * rabi_points},
    {"20 x 20 bins, 1e6 particles: 201 points over 2 [scans]", "image/2", "image/201", 1 / 3., 1 / 1.5},
    {"caesium clock, 1e6 atoms, by processor time [atoms x frequencies]", "", "clock/program"},
    {"dorado region [steps]", "dorado/limit", "dorado/program", 0.4, 0.7},
    {"spins in a field with a profile, Magnus' fourth order [steps]", "spin/limit", "spin/program", 0.4, 0.7},
    {"between two wires, leapfrog in grad |B| [steps]", "wires/limit", "wires/program", 0.3, 0.6},
    {"a map of 64^3 nodes, leapfrog in grad |B| [steps]", "map/limit", "map/program", 0.6, 0.7},
    {"dorado scan, two threads against one, by the clock [steps]", "threads by the clock/1",
     "threads by the clock/2", 1.85, 1.95},
    {"  by processor time [steps]", "threads by processor time/1", "threads by processor time/2"},
};

}  // namespace
}  // namespace rabiline::bench

int main(int argc, char** argv) {
  using namespace rabiline::bench;
  std::vector<char*> arguments(argv, argv + argc);
  std::string repetitions = "--benchmark_repetitions=15",
              interleaving = "--benchmark_enable_random_interleaving=true", time = "--benchmark_min_time=0.1";
  arguments.insert(arguments.begin() + 1, {repetitions.data(), interleaving.data(), time.data()});
  int count = static_cast<int>(arguments.size());
  benchmark::Initialize(&count, arguments.data());
  if (benchmark::ReportUnrecognizedArguments(count, arguments.data())) return 2;
  register_all();
  Table table(rows);
  benchmark::RunSpecifiedBenchmarks(&table);
  return 0;
}
