#pragma once
// Books the paths of particles behind a projection as moments of their slowness.
#include <vector>

#include "transport/paths.hpp"
#include "transport/transit.hpp"

namespace rabiline {

/// Moments since they were last added to the sums, which comes before they can overflow.
struct MomentBuffer {
  std::vector<CellMoments> cells;
  std::vector<std::uint64_t> touched;  // which of them may hold anything
};

class TransitBook {
 public:
  /// Moments of one batch: of particles by their numbers in it, whose slowness is in the cells.
  void add(const TransitLayout&, const Paths&, const BatchView& batch, const std::vector<int>& particles, Isa,
           MomentBuffer&);
  /// What a part caught, as rows of rank 0 of one bin. Whether all of it was in the cells.
  bool add_catch(const TransitLayout&, const BatchView& batch, int part, Isa, MomentBuffer&);

 private:
  /// Where a particle ends on the path of a rank.
  struct End {
    std::size_t link;
    std::uint32_t bin;  // or PathEnds::not_caught
  };
  void find_ends(const TransitLayout&, const Paths&, std::size_t from, std::size_t number);
  void enter(const TransitLayout&, std::size_t from, std::uint64_t weight, double slowness);
  void add_entries(const TransitLayout&, Isa, MomentBuffer&);

  std::vector<End> ends_;             // [rank]
  std::vector<std::size_t> path_of_;  // [level]
  std::vector<TransitEntry> entries_;
};

}  // namespace rabiline
