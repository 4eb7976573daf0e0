#pragma once
// Tables that kernels read, made once for a plan however many scan points and species use them.
#include <list>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include "particle/law_tables.hpp"
#include "particle/species.hpp"
#include "spin/driven_levels.hpp"
#include "spin/moment_table.hpp"
#include "transport/kernels.hpp"
#include "transport/level_way.hpp"

namespace rabiline {

/// Each table once, at an address that stays.
class SampledTables {
 public:
  LawTables laws;                                     // of the source
  std::vector<std::shared_ptr<const void>> of_parts;  // keeps alive the maps that stages point into

  /// Transitions along driven zones up to a slowness [s/m], filled in by work_out_transitions().
  const DrivenLevels& transitions(const Structure&, const std::vector<LevelZone>&, double largest_slowness);
  /// Transitions with what they were made for.
  struct Driven {
    Structure structure;
    std::vector<LevelZone> zones;
    double largest_slowness = 0;
    DrivenLevels levels{};
  };
  /// The one that a stage has the transitions of; they must be of these tables.
  const Driven& driven_by(const DrivenLevels*) const;
  /// Works out the transitions that were asked for, on so many threads; 0: on all cores.
  void work_out_transitions(int threads);
  const MomentTable& moments(const Structure&);
  const LevelWay& way(const Structure&, const LevelFields&);

 private:
  std::list<Driven> driven_;
  std::unordered_multimap<std::size_t, const Driven*> alike_;  // by a hash of the zones
  std::unordered_map<const DrivenLevels*, const Driven*> driven_by_;
  std::vector<std::pair<Structure, std::shared_ptr<const MomentTable>>> moments_;
  struct Manifolds {
    Structure structure;
    std::vector<int> of;  // manifolds_of()
    bool driven = false;
    std::shared_ptr<const LevelTable> table;
  };
  std::list<Manifolds> manifolds_;
  std::list<LevelWay> ways_;
};

}  // namespace rabiline
