#pragma once
// What every stage states about itself: the contract of the kinds that transport/stage.hpp lists.
#include <concepts>
#include <cstddef>
#include <limits>

#include "core/isa.hpp"
#include "particle/batch.hpp"
#include "tally/sums.hpp"

namespace rabiline {

struct RandomKey;
struct Species;
struct StepRecorder;
class SumSink;     // transport/sum_sink.hpp
class PathTally;   // transport/paths.hpp
class PlanReport;  // transport/plan_report.hpp
struct SpinPath;   // transport/spin_path.hpp

/// A batch on its way, with what every stage needs: the instruction set, the random key and the stage's own
/// sums.
struct StageContext {
  Isa isa;
  const RandomKey& key;
  Batch& batch;
  Sum* sums;
  const StepRecorder* recorder = nullptr;
};

/// What a stage does to spins. `carried`: behind it the batch's spins are those of the particles at its end,
/// fields up to there included; `set`: the state itself is another one.
enum class SpinEffect { none, carried, set };
/// What a stage does to levels. `separated`: paths behind it depend on the level; `replaced`: particles no
/// longer are in the level that they were emitted in.
enum class LevelEffect { none, separated, replaced };

struct StageTraits {
  /// Leaves the batch as it is, so that it may stand beside what follows.
  bool only_reads = false;
  /// Particles end here. Where it follows paths, the first of its sums counts the weight of what ends and is
  /// not detected.
  bool ends_particles = false;
  /// All that it counts are the levels of what a screen caught.
  bool counts_levels = false;
  SpinEffect spins = SpinEffect::none;
  LevelEffect levels = LevelEffect::none;
};

/// Where a stage stands that comes behind everything [m].
inline constexpr double behind_everything = std::numeric_limits<double>::infinity();

/// A kind of stage. Its behaviour depends on nothing but its own parameters, the batch and the random key;
/// equal stages do the same, which is how scan points share them.
template <class S>
concept StageKind = std::equality_comparable<S> &&
    requires(const S& stage, StageContext& context, SumSink& sink, PlanReport& report, double speed) {
  // What the plan must know before it runs.
  { S::traits } -> std::convertible_to<const StageTraits&>;
  // How many sums it keeps.
  { stage.sums() } -> std::same_as<std::size_t>;
  // How a batch passes it, with its kernels.
  { stage.pass(context) } -> std::same_as<void>;
  // Names the fates and the tallies among its sums.
  { stage.list_sums(sink) } -> std::same_as<void>;
  // Where it stands or begins [m]: tracks are recorded up to there; or behind_everything.
  { stage.y() } -> std::same_as<double>;
  // About how long one particle of that speed [m/s] keeps one core busy [s].
  { stage.cost(speed) } -> std::same_as<double>;
  // What `check` tells of it.
  { stage.explain(report) } -> std::same_as<void>;
  // Whether it may stand behind a projection that splits weights: paths are then flown once in each level
  // and their shares of the weight are known later only. No stage can that changes weights.
  { stage.follows_paths() } -> std::same_as<bool>;
};
// What only some stages have, asked by the functions of transport/stage.hpp:
//   const SpinPath* path()     the fields that act on spins before it
//   bool splits()              shares the weight over the levels at the end of its path
//   S piece(begin, end)        a part of it along the beam, for tracks
//   int catches()              the part whose screen it is
//   double counted_share()     what that screen counts of each weight
//   int reads_catch_of()       the part whose catch it tallies, or no_part
//   unique_ptr<PathTally> tally_paths()   what it keeps of paths and counts of their shares
//   size_t own_memory()        what each thread keeps while a batch passes it [bytes]

/// Where a part stands that is a stage of its own, for one species: its stage is stage_of(part, site),
/// declared beside the stage.
struct StageSite {
  double y = 0;  // [m]
  int part = 0;
  const Species& species;
};

/// Stands for no part of the beamline where one may be named; the chamber is part -1.
inline constexpr int no_part = -2;

}  // namespace rabiline
