#include "transport/stages/score.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/screen_paths.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

ScreenSums sums_of(const Screen& s) {
  return {static_cast<std::size_t>(s.bins_x), static_cast<std::size_t>(s.bins_z)};
}

void add_caught(const ScreenSums& layout, Sum* sums, std::uint64_t bin, std::uint64_t weight,
                std::uint64_t particle) {
  const Sum squared = square(weight);
  sums[ScreenSums::bin(bin)] += weight;
  sums[ScreenSums::bin(bin) + 1] += squared;
  sums[layout.total()] += weight;
  sums[layout.total() + 1] += squared;
  sums[layout.group(particle % group_count)] += weight;
}

void list_screen(const Screen& screen, std::size_t at, SumSink& sink) {
  const ScreenSums layout = sums_of(screen);
  sink.screen(screen.part, layout, at);
  sink.fate(fate::detected, screen.part, at + layout.total());
  if (screen.efficiency != 1 || screen.has_dead_area)
    sink.fate(fate::stopped, screen.part, at + ScreenSums::lost());
}

std::size_t Score::sums() const { return sums_of(screen).size(); }
void Score::list_sums(SumSink& sink) const { list_screen(screen, 0, sink); }
double Score::y() const { return screen.y; }
double Score::cost(double) const { return cost::plane; }
bool Score::follows_paths() const { return true; }
int Score::catches() const { return screen.part; }
std::unique_ptr<PathTally> Score::tally_paths() const { return std::make_unique<ScreenPaths>(screen); }

void Score::pass(StageContext& context) const {
  BatchView& batch = context.batch.view();
  std::uint64_t caught[Batch::capacity + 8];
  const Caught taken = kernel::screen(context.isa)(screen, batch, caught);
  const ScreenSums layout = sums_of(screen);
  context.sums[ScreenSums::lost()] += taken.lost;
  if (taken.counted == 0) return;
  const int count = taken.particles;
  context.sums[layout.total()] += taken.counted;
  // Weights are one at most. Of whole particles, numbers that are known beforehand: the square's lower half
  // is zero.
  if (taken.counted == static_cast<std::uint64_t>(count) * quanta_per_particle) {
    for (int k = 0; k < count; ++k) {
      const std::size_t bin = ScreenSums::bin(batch.scratch[caught[k]]);
      context.sums[bin] += quanta_per_particle;
      context.sums[bin + 1] += square(quanta_per_particle);
      context.sums[layout.group(batch.particle[caught[k]] % group_count)] += quanta_per_particle;
    }
    context.sums[layout.total() + 1] += static_cast<Sum>(count) * square(quanta_per_particle);
    return;
  }
  Sum squares = 0;  // the total of a batch stays in registers
  for (int k = 0; k < count; ++k) {
    const std::uint64_t i = caught[k];
    const std::uint64_t weight = batch.weight[i];
    const Sum squared = square(weight);
    context.sums[ScreenSums::bin(batch.scratch[i])] += weight;
    context.sums[ScreenSums::bin(batch.scratch[i]) + 1] += squared;
    context.sums[layout.group(batch.particle[i] % group_count)] += weight;
    squares += squared;
  }
  context.sums[layout.total() + 1] += squares;
}

void Score::explain(PlanReport& report) const {
  report.line("{}  {}: catches and histograms, {} x {} bins{}{}{}", PlanReport::metres(screen.y),
              report.name_of(screen.part), screen.bins_x, screen.bins_z,
              screen.efficiency == 1 ? "" : fmt::format(", counts {:g} of each", screen.efficiency),
              screen.has_dead_area ? ", nothing in its dead area" : "", report.reuse);
}

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

Caught screen(const Screen& screen, BatchView& batch, std::uint64_t* list) {
  const Aperture rim = rim_of(screen);
  words counted_weight = words{}, lost_weight = words{};
  int particles = 0;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const OnPlane there = to_plane(screen.y, batch, i);
    const real x = there.x, z = there.z;
    const words flying = load(batch.flying + i), hit = (words)inside(rim, x, z) & flying;
    const words caught = hit & ~(words)in_dead_area(screen, x, z);
    const words weight = load(batch.weight + i);
    words counted = weight;
    if (screen.efficiency != 1) {
      counted = weight_of(floor(number_of(weight) * screen.efficiency));
      store(batch.weight + i, select((mask)caught, counted, weight));
    }
    store(batch.scratch + i, bin_on(screen, x, z) | ~caught);
    store(batch.caught_by + i,
          select((mask)caught, broadcast_word(static_cast<unsigned long long>(screen.part) + 1),
                 load(batch.caught_by + i)));
    store(batch.flying + i, flying & ~hit);
    particles += pack(lane_numbers() + static_cast<unsigned long long>(i), (mask)caught, list + particles);
    counted_weight = counted_weight + (counted & caught);
    lost_weight = lost_weight + (weight & hit) - (counted & caught);
  }
  return {sum_of_lanes(counted_weight), sum_of_lanes(lost_weight), particles};
}

}  // namespace rabiline::RABILINE_ISA

#endif
