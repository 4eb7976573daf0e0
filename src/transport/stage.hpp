#pragma once
// The closed list of stages: what a batch passes, one after the other. Plain values, compared with == where
// scan points may share them. A new kind stands here and nowhere else; StageKind says what it must state.
#include <memory>
#include <string>
#include <variant>

#include "transport/spin_path.hpp"
#include "transport/stage_concept.hpp"
#include "transport/stages/alignment.hpp"
#include "transport/stages/attenuation.hpp"
#include "transport/stages/bounds.hpp"
#include "transport/stages/census.hpp"
#include "transport/stages/chopping.hpp"
#include "transport/stages/deflection.hpp"
#include "transport/stages/drift.hpp"
#include "transport/stages/exit.hpp"
#include "transport/stages/filter.hpp"
#include "transport/stages/filter_stop.hpp"
#include "transport/stages/histogram.hpp"
#include "transport/stages/level_filter.hpp"
#include "transport/stages/level_projection.hpp"
#include "transport/stages/passage.hpp"
#include "transport/stages/precession.hpp"
#include "transport/stages/score.hpp"
#include "transport/stages/sorting_field.hpp"
#include "transport/stages/spin_stretch.hpp"
#include "transport/stages/steering.hpp"
#include "transport/stages/turning_region.hpp"
#include "transport/stages/velocity_selection.hpp"
#include "transport/stages/wall_stop.hpp"

namespace rabiline {

template <StageKind... Kinds>
using StageList = std::variant<Kinds...>;
using Stage =
    StageList<Drift, Passage, Alignment, Precession, Filter, FilterStop, LevelFilter, LevelProjection,
              Deflection, Steering, TurningRegion, Score, Exit, SpinStretch, Census, Histogram, Attenuation,
              Chopping, VelocitySelection, SortingField, Bounds, WallStop>;

// What every stage states (StageKind).
const StageTraits& traits_of(const Stage&);
std::size_t sums_needed(const Stage&);
void advance(const Stage&, StageContext&);
void list_sums(const Stage&, SumSink&);
double place_of(const Stage&);
double cost_of(const Stage&, double speed);
void explain(const Stage&, PlanReport&);
bool follows_paths(const Stage&);

// What some have.
const SpinPath* path_of(const Stage&);  // null where it asks for no spins
/// The same stage behind other fields.
Stage with_path(Stage, const SpinPath&);
int part_of(const Stage&);  // that it belongs to, or no_part
bool splits(const Stage&);
int catches(const Stage&);  // or no_part
double counted_share(const Stage&);
int reads_catch_of(const Stage&);  // or no_part
std::unique_ptr<PathTally> tally_paths(const Stage&);
std::size_t own_memory(const Stage&);

}  // namespace rabiline
