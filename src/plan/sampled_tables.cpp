#include "plan/sampled_tables.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "core/portable_math.hpp"
#include "core/processors.hpp"

namespace rabiline {

const DrivenLevels& SampledTables::transitions(const Structure& structure,
                                               const std::vector<LevelZone>& zones, double largest_slowness) {
  const auto found = std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) {
    return d.largest_slowness == largest_slowness && d.structure == structure && d.zones == zones;
  });
  if (found != driven_.end()) return found->levels;
  driven_.push_back({structure, zones, largest_slowness, {}});
  return driven_.back().levels;
}

const SampledTables::Driven& SampledTables::driven_by(const DrivenLevels* levels) const {
  const auto found =
      std::find_if(driven_.begin(), driven_.end(), [&](const Driven& d) { return &d.levels == levels; });
  assert(found != driven_.end());
  return *found;
}

void SampledTables::work_out_transitions(int threads) {
  std::vector<Driven*> open;
  for (Driven& driven : driven_)
    if (driven.levels.levels() == 0) open.push_back(&driven);
  std::exception_ptr error;
  std::mutex lock;
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i = next++; i < open.size(); i = next++) try {
        Driven& d = *open[i];
        d.levels = DrivenLevels(coupled_spins(d.structure), d.zones, d.largest_slowness);
      } catch (...) {
        const std::lock_guard guard(lock);
        error = std::current_exception();
      }
  };
  const auto workers = static_cast<std::size_t>(threads > 0 ? threads : processors());
  {
    std::vector<std::jthread> others;
    try {
      while (others.size() + 1 < std::min(workers, open.size())) others.emplace_back(work);
    } catch (const std::system_error&) {  // fewer will do
    }
    work();
  }
  if (error) std::rethrow_exception(error);
}

const MomentTable& SampledTables::moments(const Structure& structure) {
  const auto found = std::find_if(moments_.begin(), moments_.end(),
                                  [&](const auto& entry) { return entry.first == structure; });
  if (found != moments_.end()) return found->second;
  return moments_.emplace_back(structure, MomentTable(coupled_spins(structure))).second;
}

const LevelWay& SampledTables::way(const Structure& structure, const LevelFields& fields) {
  const CoupledSpins spins = coupled_spins(structure);
  const std::vector<int> manifolds = manifolds_of(spins, fields.apart);
  const bool driven = !fields.waves.empty();
  auto made = std::ranges::find_if(manifolds_, [&](const Manifolds& m) {
    return m.structure == structure && m.of == manifolds && m.driven == driven;
  });
  if (made == manifolds_.end())
    made = manifolds_.insert(manifolds_.end(), {structure, manifolds, driven,
                                                std::make_shared<LevelTable>(spins, manifolds, driven)});
  const auto found = std::ranges::find_if(ways_, [&](const LevelWay& way) {
    return &way.table() == made->table.get() && way.fields() == fields;
  });
  return found != ways_.end() ? *found : ways_.emplace_back(fields, made->table);
}

}  // namespace rabiline
