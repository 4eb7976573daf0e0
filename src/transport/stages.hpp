#pragma once
// What a batch passes, one after the other: plain values, compared with == where scan points may share them.
#include <cstddef>
#include <variant>
#include <vector>

#include "spin/transition_table.hpp"
#include "tally/sums.hpp"
#include "transport/histogram.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// A batch on its way, with what every stage needs: the loops, the random key and the stage's own sums.
struct Flight {
  const Kernels& kernels;
  const RandomKey& key;
  Batch& batch;
  Sum* sums;
  const StepRecorder* recorder = nullptr;
};

/// Straight to a plane; the batch is then referred to it.
struct Drift {
  double y = 0;  // [m]
  bool operator==(const Drift&) const = default;
};
/// What misses an opening stops at that part.
struct Passage {
  Aperture aperture;
  int part = 0;
  bool operator==(const Passage&) const = default;
};

/// Carries spins through the fields of a straight flight, for what comes next to ask about them.
struct Precession {
  std::vector<SpinZone> zones;
  bool operator==(const Precession&) const = default;
};
/// A deflecting magnet asks for the level along the field, after the fields of a straight flight. `split`:
/// the weight is shared out over all levels and each is followed on (Walker); else one is drawn.
struct LevelProjection {
  int part = 0;
  int levels = 2;
  bool split = false;
  bool from_level = false;  // no other stage has turned the spin
  std::vector<SpinZone> zones;
  std::vector<double> polynomials;               // MajoranaTable::coefficients
  const TransitionTable* transitions = nullptr;  // of an atom; a plan makes each table once
  bool operator==(const LevelProjection&) const = default;
};
LevelQuestion question_of(const LevelProjection&, const RandomKey&);
/// The weights of atoms shared out over their levels, a column for each: by the transitions, or where there
/// are none by the level that each is in.
void share_levels(int levels, const TransitionTable*, const Flight&, const std::uint64_t* weights,
                  std::uint64_t* shares);
/// The kernel's view of a table, which must outlive it; of none that of no transitions.
Transitions transitions_view(const TransitionTable*);
/// A monitor's plane inside a region: it sees each particle once, where it comes there for the first time,
/// and changes nothing.
struct Sight {
  Census census;
  std::vector<Histogram> tallies;
  bool operator==(const Sight&) const = default;
};
/// Touching fields that turn the velocity; the particle may leave backwards.
struct TurningRegion {
  std::vector<RegionZone> zones;
  std::vector<RegionEdge> edges;  // between neighbouring zones
  std::vector<Sight> sights;      // in the order in which they are passed
  bool take_off_spin_component = false;
  double most_way = 0;  // [m] in one zone at one visit
  bool operator==(const TurningRegion&) const = default;
};
/// What hits a screen is caught and histogrammed.
struct Score {
  Screen screen;
  bool operator==(const Score&) const = default;
};
/// What still flies after the last part has passed.
struct Exit {
  bool operator==(const Exit&) const = default;
};
/// The levels of what a detector caught, after the fields of a straight flight. Changes nothing in the batch,
/// so that scan points that differ only here share everything else.
struct SpinStretch {
  int part = 0;  // the detector
  int levels = 2;
  bool majorana = false;    // quantum
  bool from_level = false;  // quantum, and no other stage has turned the spin
  std::vector<SpinZone> zones;
  std::vector<double> polynomials;               // MajoranaTable::coefficients, for more than two levels
  bool of_atom = false;                          // whose levels no field turns
  const TransitionTable* transitions = nullptr;  // of an atom that fields drive
  bool operator==(const SpinStretch&) const = default;
};

using Stage = std::variant<Drift, Passage, Alignment, Precession, Filter, LevelProjection, Deflection,
                           Steering, TurningRegion, Score, Exit, SpinStretch, Census, Histogram>;

/// Whether a stage leaves the batch as it is, so that it may be asked beside what follows.
inline bool only_reads(const Stage& stage) {
  return std::holds_alternative<SpinStretch>(stage) || std::holds_alternative<Census>(stage) ||
         std::holds_alternative<Histogram>(stage);
}

/// The sums of levels: q and q^2 of each, then, of more than two, q times the whole weight.
struct LevelLayout {
  std::size_t levels;
  bool has_products() const { return levels > 2; }
  static std::size_t q(std::size_t level) { return 2 * level; }
  static std::size_t squares(std::size_t level) { return 2 * level + 1; }
  std::size_t products(std::size_t level) const { return 2 * levels + level; }
  std::size_t size() const { return (has_products() ? 3 : 2) * levels; }
};

/// A sum of products from its pieces; a negative lower one borrows, as unsigned numbers do.
inline Sum joined(std::uint64_t high, std::int64_t low) {
  return (static_cast<Sum>(high) << 40) + static_cast<Sum>(low);
}

/// The sums of a screen: q and q^2 of every bin, then of the whole screen, then q of every group of
/// particles, then q of what hit it and was not counted; then, of each column and each row of bins, what (sum
/// of q)^2 of a particle has beyond the squares of its bins, where it is split over several of them.
struct ScreenSums {
  std::size_t columns, rows;
  std::size_t bins() const { return columns * rows; }
  std::size_t bin(std::size_t i) const { return 2 * i; }
  std::size_t total() const { return 2 * bins(); }
  std::size_t group(std::size_t g) const { return 2 * bins() + 2 + g; }
  std::size_t lost() const { return 2 * bins() + 2 + group_count; }
  std::size_t across_column(std::size_t x) const { return 2 * bins() + 3 + group_count + x; }
  std::size_t across_row(std::size_t z) const { return across_column(columns) + z; }
  std::size_t size() const { return across_row(rows); }
};
inline ScreenSums sums_of(const Screen& s) {
  return {static_cast<std::size_t>(s.bins_x), static_cast<std::size_t>(s.bins_z)};
}

/// The sums of a region: left backwards, gave up, stopped at each zone's wall, stopped at each edge, then one
/// ScreenSums for each edge with a screen, then those of each sight: its census, its tallies.
struct RegionSums {
  std::size_t zones;
  static std::size_t backwards() { return 0; }
  static std::size_t gave_up() { return 1; }
  std::size_t wall(std::size_t zone) const { return 2 + zone; }
  std::size_t edge(std::size_t edge) const { return 2 + zones + edge; }
  std::size_t screens() const { return 2 + zones + zones; }
};

/// The contract of a stage: how many sums it keeps, and how a batch passes it. Depends on nothing but its own
/// parameters, the batch and the random key.
std::size_t sums_needed(const Stage&);
void advance(const Stage&, Flight&);

/// The kernel's view of a region; the region must outlive it.
Region region_view(const TurningRegion&, const RandomKey&);

/// Where the sums of a region's sights begin among its own.
std::size_t sums_before_sights(const TurningRegion&);

}  // namespace rabiline
