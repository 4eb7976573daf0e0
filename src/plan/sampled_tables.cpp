#include "plan/sampled_tables.hpp"

#include <algorithm>
#include <deque>
#include <functional>
#include <mutex>
#include <vector>

#include "core/in_parallel.hpp"
#include "core/portable_math.hpp"

namespace rabiline {

namespace {

/// Of what scan points mostly differ in.
std::size_t hash_of(const std::vector<LevelZone>& zones) {
  std::size_t hash = 0;
  const auto mix = [&](double number) { hash = hash * 31 + std::hash<double>()(number); };
  for (const LevelZone& zone : zones) {
    mix(zone.begin);
    mix(zone.field);
    if (!zone.drive) continue;
    mix(zone.drive->oscillator.frequency);
    mix(zone.drive->amplitude);
  }
  return hash;
}

/// A table takes longer than a small flight: the last ones are kept for all plans of the process.
std::shared_ptr<const MomentTable> moment_table(const Structure& structure) {
  constexpr std::size_t most_kept = 8;
  static std::mutex lock;
  static std::deque<std::pair<Structure, std::shared_ptr<const MomentTable>>> kept;
  const std::lock_guard guard(lock);
  for (const auto& [of, table] : kept)
    if (of == structure) return table;
  if (kept.size() == most_kept) kept.pop_front();
  return kept.emplace_back(structure, std::make_shared<MomentTable>(coupled_spins(structure))).second;
}

}  // namespace

const DrivenLevels& SampledTables::transitions(const Structure& structure,
                                               const std::vector<LevelZone>& zones, double largest_slowness) {
  const std::size_t hash = hash_of(zones);
  const auto [begin, end] = alike_.equal_range(hash);
  for (auto known = begin; known != end; ++known)
    if (const Driven& d = *known->second;
        d.largest_slowness == largest_slowness && d.structure == structure && d.zones == zones)
      return d.levels;
  Driven& made = driven_.emplace_back(Driven{structure, zones, largest_slowness});
  alike_.emplace(hash, &made);
  driven_by_.emplace(&made.levels, &made);
  return made.levels;
}

const SampledTables::Driven& SampledTables::driven_by(const DrivenLevels* levels) const {
  return *driven_by_.at(levels);
}

void SampledTables::work_out_transitions(int threads) {
  std::vector<Driven*> open;
  for (Driven& driven : driven_)
    if (driven.levels.levels() == 0) open.push_back(&driven);
  in_parallel(open.size(), threads, [&](std::size_t i) {
    Driven& d = *open[i];
    d.levels = DrivenLevels(coupled_spins(d.structure), d.zones, d.largest_slowness);
  });
}

const MomentTable& SampledTables::moments(const Structure& structure) {
  const auto found = std::find_if(moments_.begin(), moments_.end(),
                                  [&](const auto& entry) { return entry.first == structure; });
  if (found != moments_.end()) return *found->second;
  return *moments_.emplace_back(structure, moment_table(structure)).second;
}

const LevelWay& SampledTables::way(const Structure& structure, const LevelFields& fields) {
  const CoupledSpins spins = coupled_spins(structure);
  const std::vector<int> manifolds = manifolds_of(spins, fields.apart);
  const bool driven = fields.need_pairs();
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
