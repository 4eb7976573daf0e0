#pragma once
// Books the paths of particles behind a projection as moments of their slowness.
#include <memory>
#include <vector>

#include "core/zeroed_memory.hpp"
#include "transport/paths.hpp"
#include "transport/transit.hpp"

namespace rabiline {

/// Moments since they were last added to the sums, which comes before they can overflow.
struct MomentBuffer {
  std::vector<CellMoments, ZeroedMemory<CellMoments>> cells;
  std::vector<std::uint64_t> touched;  // which of them may hold anything
};

class TransitBook {
 public:
  /// Moments of one batch: of particles by their numbers in it, whose slowness is in the cells. `tallies`: of
  /// each link.
  void add(const TransitLayout&, const Paths&, const std::vector<std::unique_ptr<PathTally>>& tallies,
           const BatchView& batch, const std::vector<int>& particles, Isa, MomentBuffer&);
  /// What a part caught, as rows of rank 0 of one bin. Whether all of it was in the cells.
  bool add_catch(const TransitLayout&, const BatchView& batch, int part, Isa, MomentBuffer&);

 private:
  /// The particle at hand.
  struct Particle {
    std::size_t from, number, group;
    std::uint64_t cell;
    double t, w, w2;  // in units of 2^-40 particle and of 2^-40 particle^2
  };
  static Particle particle_of(const TransitLayout&, const BatchView& batch, int i);
  void put(const TransitLayout&, const Particle&, std::size_t row, double what);
  void enter_stops(const TransitLayout&, const Paths&, const Particle&);
  void enter_bins(const TransitLayout&, std::size_t link, const Particle&);
  void enter_pair(const TransitLayout&, std::size_t link, const Particle&, std::size_t a, std::size_t b);
  void enter_places(const TransitLayout&, std::size_t link, const PathTally&, const Particle&);
  void add_entries(const TransitLayout&, Isa, MomentBuffer&);

  std::vector<std::uint32_t> bins_;   // [rank] of a link, or PathPlaces::nowhere
  std::vector<std::size_t> path_of_;  // [level]
  std::vector<TransitEntry> entries_;
};

}  // namespace rabiline
