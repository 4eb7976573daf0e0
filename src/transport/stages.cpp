#include "transport/stages.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline {
namespace {

// ---- how many sums ----

std::size_t needed(const Drift&) { return 0; }
std::size_t needed(const Passage&) { return 1; }
std::size_t needed(const Alignment&) { return 0; }
std::size_t needed(const Precession&) { return 0; }
std::size_t needed(const Filter&) { return 1; }
std::size_t needed(const LevelProjection&) { return 0; }
std::size_t needed(const Deflection&) { return 1; }
std::size_t needed(const Steering&) { return 1; }
std::size_t needed(const TurningRegion& region) {
  std::size_t sums = sums_before_sights(region);
  for (const Sight& sight : region.sights) {
    sums += CensusSums::size();
    for (const Histogram& tally : sight.tallies) sums += sums_of(tally).size();
  }
  return sums;
}
std::size_t needed(const Score& score) { return sums_of(score.screen).size(); }
std::size_t needed(const Exit&) { return 1; }
std::size_t needed(const Census&) { return CensusSums::size(); }
std::size_t needed(const Histogram& histogram) { return sums_of(histogram).size(); }
std::size_t needed(const SpinStretch& stretch) {
  return LevelLayout{static_cast<std::size_t>(stretch.levels)}.size();
}

// ---- tallying ----

Sum square(std::uint64_t q) { return static_cast<Sum>(q) * q; }

void catch_particle(const ScreenSums& layout, Sum* sums, std::uint64_t bin, std::uint64_t weight,
                    std::uint64_t particle) {
  const Sum squared = square(weight);
  sums[layout.bin(bin)] += weight;
  sums[layout.bin(bin) + 1] += squared;
  sums[layout.total()] += weight;
  sums[layout.total() + 1] += squared;
  sums[layout.group(particle % group_count)] += weight;
}

/// What a screen counts of a weight up to 2^40, as its kernel does.
std::uint64_t counted_of(const Screen& screen, std::uint64_t weight) {
  return static_cast<std::uint64_t>(std::floor(static_cast<double>(weight) * screen.efficiency));
}

// ---- one batch ----

void pass(const Drift& drift, Flight& flight) { flight.kernels.drift(drift.y, flight.batch.view()); }

void pass(const Passage& passage, Flight& flight) {
  flight.sums[0] += flight.kernels.pass(passage.aperture, flight.batch.view());
}

void pass(const Alignment& alignment, Flight& flight) {
  flight.kernels.align(alignment, flight.key, flight.batch.view());
}

void pass(const Precession& precession, Flight& flight) {
  flight.kernels.precess(precession.zones.data(), static_cast<int>(precession.zones.size()), flight.key,
                         flight.batch.view());
}

void pass(const Filter& filter, Flight& flight) {
  flight.sums[0] += flight.kernels.filter(filter, flight.batch.view());
}

void pass(const LevelProjection& projection, Flight& flight) {
  flight.kernels.collapse(question_of(projection, flight.key), projection.part, flight.batch.view());
}

void pass(const Deflection& deflection, Flight& flight) {
  flight.sums[0] += flight.kernels.deflect(deflection, flight.batch.view());
}

void pass(const Steering& steering, Flight& flight) {
  flight.sums[0] += flight.kernels.steer(steering, flight.batch.view());
}

void pass(const Score& score, Flight& flight) {
  BatchView& batch = flight.batch.view();
  const Caught taken = flight.kernels.screen(score.screen, batch);
  const ScreenSums layout = sums_of(score.screen);
  flight.sums[layout.lost()] += taken.lost;
  if (taken.counted == 0) return;
  // Listed first, since whether a particle was caught cannot be foretold as a branch.
  int caught[Batch::capacity], count = 0;
  for (int i = 0; i < batch.count; ++i) {
    caught[count] = i;
    count += batch.scratch[i] != ~std::uint64_t{0} ? 1 : 0;
  }
  for (int k = 0; k < count; ++k) {
    const int i = caught[k];
    catch_particle(layout, flight.sums, batch.scratch[i], batch.weight[i], batch.particle[i]);
  }
}

/// The weights of a batch add up to less than 2^64.
void pass(const Exit&, Flight& flight) {
  BatchView& batch = flight.batch.view();
  std::uint64_t passed = 0;
  for (int i = 0; i < batch.count; ++i) {
    passed += batch.weight[i] & batch.flying[i];
    batch.flying[i] = 0;
  }
  flight.sums[0] += passed;
}

/// Books the end of one particle's flight through a region; returns whether it flies on.
bool book(const TurningRegion& region, Sum* sums, BatchView& batch, int i) {
  const RegionSums layout{region.zones.size()};
  const std::uint64_t end = batch.scratch[i] & 0xffffffffULL, weight = batch.weight[i];
  if (end == region_end::forward) return true;
  if (end == region_end::backwards) {
    sums[RegionSums::backwards()] += weight;
  } else if (end == region_end::gave_up) {
    sums[RegionSums::gave_up()] += weight;
  } else if ((end & region_end::caught_at_edge) != 0) {
    const std::size_t edge = end & 0xffffULL;
    Sum* at = sums + layout.screens();
    for (std::size_t k = 0; k < edge; ++k)
      if (region.edges[k].kind == EdgeKind::screen) at += sums_of(region.edges[k].screen).size();
    const Screen& screen = region.edges[edge].screen;
    batch.weight[i] = counted_of(screen, weight);
    catch_particle(sums_of(screen), at, batch.scratch[i] >> 32, batch.weight[i], batch.particle[i]);
    sums[layout.edge(edge)] += weight - batch.weight[i];
    batch.caught_by[i] = static_cast<std::uint64_t>(screen.part) + 1;
  } else if ((end & region_end::stopped_at_edge) != 0) {
    sums[layout.edge(end & 0xffffULL)] += weight;
  } else {
    sums[layout.wall(end - region_end::wall_of_zone)] += weight;
  }
  return false;
}

/// Batches for what a region's sights see, one for each; nobody is in them yet.
std::vector<Batch> batches_for(const TurningRegion& region, const BatchView& batch) {
  std::vector<Batch> seen(region.sights.size());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    BatchView& view = seen[k].view();
    view.count = batch.count;
    view.padded = batch.padded;
    view.y = region.sights[k].census.face.y;
    std::fill_n(view.flying, view.padded, 0);
  }
  return seen;
}

void tally(const TurningRegion& region, std::vector<Batch>& seen, Flight& flight) {
  Sum* sums = flight.sums + sums_before_sights(region);
  for (std::size_t k = 0; k < seen.size(); ++k) {
    Flight there{flight.kernels, flight.key, seen[k], sums};
    pass(region.sights[k].census, there);
    there.sums += CensusSums::size();
    for (const Histogram& tally : region.sights[k].tallies) {
      pass(tally, there);
      there.sums += sums_of(tally).size();
    }
    sums = there.sums;
  }
}

void pass(const TurningRegion& region, Flight& flight) {
  BatchView& batch = flight.batch.view();
  std::vector<Batch> seen = batches_for(region, batch);
  std::vector<BatchView> views;
  views.reserve(seen.size());
  for (Batch& there : seen) views.push_back(there.view());
  Region view = region_view(region, flight.key);
  view.seen = views.data();
  view.sight_count = static_cast<int>(views.size());
  flight.kernels.turn(view, batch, flight.recorder);
  tally(region, seen, flight);
  for (int i = 0; i < batch.count; ++i)
    if (batch.flying[i] != 0 && !book(region, flight.sums, batch, i)) batch.flying[i] = 0;
}

/// The levels of atoms: those that they are in, or by their transitions.
void project_atoms(const SpinStretch& stretch, Flight& flight) {
  const BatchView& batch = flight.batch.view();
  alignas(64) std::uint64_t weights[Batch::capacity], shares[most_levels * Batch::capacity];
  for (int i = 0; i < batch.padded; ++i)
    weights[i] = batch.caught_by[i] == static_cast<std::uint64_t>(stretch.part) + 1 ? batch.weight[i] : 0;
  share_levels(stretch.levels, stretch.transitions, flight, weights, shares);
  const LevelLayout layout{static_cast<std::size_t>(stretch.levels)};
  for (int i = 0; i < batch.count; ++i) {
    if (weights[i] == 0) continue;
    for (std::size_t level = 0; level < layout.levels; ++level) {
      const std::uint64_t q =
          shares[level * static_cast<std::size_t>(batch.padded) + static_cast<std::size_t>(i)];
      if (q == 0) continue;
      flight.sums[layout.q(level)] += q;
      flight.sums[layout.squares(level)] += square(q);
      if (layout.has_products()) flight.sums[layout.products(level)] += static_cast<Sum>(q) * weights[i];
    }
  }
}

void pass(const SpinStretch& stretch, Flight& flight) {
  if (stretch.of_atom) return project_atoms(stretch, flight);
  Projection projection;
  projection.key = flight.key;
  projection.part = stretch.part;
  projection.levels = stretch.levels;
  projection.majorana = stretch.majorana;
  projection.from_level = stretch.from_level;
  projection.zones = stretch.zones.data();
  projection.zone_count = static_cast<int>(stretch.zones.size());
  projection.polynomials = stretch.polynomials.data();
  LevelSums sums;
  flight.kernels.project(projection, flight.batch.view(), sums);
  const LevelLayout layout{static_cast<std::size_t>(stretch.levels)};
  for (std::size_t level = 0; level < layout.levels; ++level) {
    flight.sums[layout.q(level)] += sums.q[level];
    flight.sums[layout.squares(level)] += joined(sums.squares_high[level], sums.squares_low[level]);
    if (layout.has_products())
      flight.sums[layout.products(level)] += joined(sums.products_high[level], sums.products_low[level]);
  }
}

}  // namespace

std::size_t sums_needed(const Stage& stage) {
  return std::visit([](const auto& s) { return needed(s); }, stage);
}

void advance(const Stage& stage, Flight& flight) {
  std::visit([&](const auto& s) { pass(s, flight); }, stage);
}

Transitions transitions_view(const TransitionTable* table) {
  if (table == nullptr) return {};
  return {table->values.data(),
          table->begin.data(),
          table->targets.data(),
          table->first,
          table->step > 0 ? 1 / table->step : 0,
          table->points,
          table->row()};
}

void share_levels(int levels, const TransitionTable* table, const Flight& flight,
                  const std::uint64_t* weights, std::uint64_t* shares) {
  const BatchView& batch = flight.batch.view();
  if (table != nullptr) {
    LevelQuestion question;
    question.levels = levels;
    question.transitions = transitions_view(table);
    flight.kernels.outcomes(question, batch, weights, shares);
    return;
  }
  std::fill_n(shares, levels * batch.padded, 0);
  for (int i = 0; i < batch.count; ++i)
    shares[static_cast<int>(batch.level[i]) * batch.padded + i] = weights[i];
}

LevelQuestion question_of(const LevelProjection& projection, const RandomKey& key) {
  LevelQuestion question;
  question.key = key;
  question.levels = projection.levels;
  question.from_level = projection.from_level;
  question.zones = projection.zones.data();
  question.zone_count = static_cast<int>(projection.zones.size());
  question.polynomials = projection.polynomials.data();
  question.transitions = transitions_view(projection.transitions);
  return question;
}

std::size_t sums_before_sights(const TurningRegion& region) {
  std::size_t sums = RegionSums{region.zones.size()}.screens();
  for (const RegionEdge& edge : region.edges)
    if (edge.kind == EdgeKind::screen) sums += sums_of(edge.screen).size();
  return sums;
}

Region region_view(const TurningRegion& region, const RandomKey& key) {
  Region view;
  view.key = key;
  view.zones = region.zones.data();
  view.edges = region.edges.data();
  view.zone_count = static_cast<int>(region.zones.size());
  view.take_off_spin_component = region.take_off_spin_component;
  view.most_way = region.most_way;
  view.most_visits = 64 + 4 * region.zones.size();
  return view;
}

}  // namespace rabiline
