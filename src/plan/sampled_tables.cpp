#include "plan/sampled_tables.hpp"

#include <omp.h>

#include <algorithm>
#include <cassert>
#include <exception>

#include "core/portable_math.hpp"

namespace rabiline {

const TransitionTable& SampledTables::transitions(const Structure& structure,
                                                  const std::vector<LevelZone>& zones, double from,
                                                  double to) {
  const auto found = std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) {
    return d.from == from && d.to == to && d.structure == structure && d.zones == zones;
  });
  if (found != driven_.end()) return found->table;
  driven_.push_back({structure, zones, from, to, {}});
  return driven_.back().table;
}

const SampledTables::Driven& SampledTables::driven_by(const TransitionTable* table) const {
  const auto found =
      std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) { return &d.table == table; });
  assert(found != driven_.end());
  return *found;
}

void SampledTables::tabulate_transitions(int threads) {
  std::vector<Driven*> open;
  for (Driven& driven : driven_)
    if (driven.table.points == 0) open.push_back(&driven);
  std::exception_ptr error;
  const int workers = threads > 0 ? threads : omp_get_max_threads();
#pragma omp parallel for schedule(dynamic) num_threads(workers)
  for (std::size_t i = 0; i < open.size(); ++i) {
    try {
      Driven& d = *open[i];
      const DrivenLevels driven(coupled_spins(d.structure), d.zones, d.to);
      d.table = tabulate(driven, d.from, d.to, transition_tolerance);
      d.neglected = driven.neglected();
    } catch (...) {
#pragma omp critical
      error = std::current_exception();
    }
  }
  if (error) std::rethrow_exception(error);
}

const MomentTable& SampledTables::moments(const Structure& structure) {
  const auto found = std::find_if(moments_.begin(), moments_.end(),
                                  [&](const auto& entry) { return entry.first == structure; });
  if (found != moments_.end()) return found->second;
  return moments_.emplace_back(structure, MomentTable(coupled_spins(structure))).second;
}

}  // namespace rabiline
