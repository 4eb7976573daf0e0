#pragma once
// What a screen counts of paths that share a particle's weight.
#include "transport/paths.hpp"
#include "transport/sum_layout.hpp"

namespace rabiline {

class ScreenPaths : public PathTally {
 public:
  explicit ScreenPaths(const Screen& screen);
  void gather(const Paths&, std::size_t link, Isa) override;
  void add(const Paths&, const PathWeights&, Sum* sums, Sum* ledger) override;
  const PathWeights* caught() const override { return &caught_; }

 private:
  /// What one particle has in one bin: the sum over one to all of its paths.
  struct Cell {
    std::uint32_t bin;
    std::uint16_t particle;
    std::uint16_t paths;  // how many; cell_paths_ lists them
  };
  /// Two cells of one particle in one column or one row of bins, and the sum that (a + b)^2 adds 2ab to.
  struct Neighbours {
    std::uint32_t first, second;
    std::size_t sum;
  };
  void find_neighbours();
  void find_eights();

  const Screen& screen_;
  const ScreenSums layout_;
  Isa isa_ = Isa::baseline;
  PathMasks hits_;                        // a column for each path
  PathMasks counts_;                      // likewise, then one for the totals [quanta]
  std::vector<std::uint16_t> eights_;     // of particles, some of which a path has here
  std::vector<std::size_t> first_eight_;  // [path], and where those of the last end
  std::vector<std::uint16_t> scored_;     // particles that some path has here
  std::vector<Cell> cells_;
  std::vector<std::uint8_t> cell_paths_;
  std::vector<Neighbours> neighbours_;
  std::vector<std::uint64_t> scores_;  // of each cell
  LevelSums by_path_;
  PathWeights caught_;
};

}  // namespace rabiline
