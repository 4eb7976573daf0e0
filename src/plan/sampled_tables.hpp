#pragma once
// Tables that kernels read, made once for a plan however many scan points and species use them.
#include <list>
#include <utility>
#include <vector>

#include "particle/law_tables.hpp"
#include "particle/species.hpp"
#include "spin/moment_table.hpp"
#include "spin/transition_table.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// Of the probabilities in a table of transitions, where no more points than 2^14 are needed.
inline constexpr double transition_tolerance = 1e-5;

/// Each table once, at an address that stays.
class SampledTables {
 public:
  LawTables laws;  // of the source

  /// Transitions along driven zones, filled in by tabulate_transitions().
  const TransitionTable& transitions(const Structure&, const std::vector<LevelZone>&, double from, double to);
  /// A table of transitions with what it was made for.
  struct Driven {
    Structure structure;
    std::vector<LevelZone> zones;
    double from = 0, to = 0;  // [s/m]
    TransitionTable table{};
    double neglected = 0;  // DrivenLevels::neglected()
  };
  /// The one that a stage has the table of; it must be of these tables.
  const Driven& driven_by(const TransitionTable*) const;
  /// Works out the tables that were asked for, on so many threads; 0: on all cores.
  void tabulate_transitions(int threads);
  const MomentTable& moments(const Structure&);

 private:
  std::list<Driven> driven_;
  std::list<std::pair<Structure, MomentTable>> moments_;
};

}  // namespace rabiline
