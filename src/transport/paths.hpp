#pragma once
// Behind a projection that splits weights: particles are flown once in each level, and what each reweighting
// comes to is tallied from these paths.
#include <array>
#include <cstdint>
#include <vector>

#include "tally/tally.hpp"
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// How the particles of a batch end on one path, by their numbers in it.
struct PathEnds {
  static constexpr std::uint16_t not_flown = 0xffff;
  static constexpr std::uint32_t not_caught = ~std::uint32_t{0};
  std::array<std::uint16_t, Batch::capacity> link;  // at which stage, or not_flown
  std::array<std::uint8_t, Batch::capacity> level;  // in which level
  std::array<std::uint32_t, Batch::capacity> bin;   // on a screen, or not_caught
};

/// Where the particles on one path are when a stage looks at them, by their numbers in the batch.
struct PathPlaces {
  static constexpr std::uint32_t nowhere = PathEnds::not_caught;  // that the stage looks at
  std::array<std::uint32_t, Batch::capacity> bin;
  std::array<std::array<std::uint32_t, Batch::capacity>, most_tally_axes>
      steps;  // along the axes that have means, of what is inside them
};

/// Particles of `asked`, one after the other, that were prepared in one level.
struct PreparedGroup {
  int begin, end;
  std::size_t prepared;
};

/// One path for each level that is flown.
struct Paths {
  std::vector<int> levels;                              // [path]
  std::vector<PathEnds> ends;                           // [path]
  bool levels_stay = true;                              // on every path, to its end
  Batch asked;                                          // the particles whose end depends on the level
  std::array<std::uint16_t, Batch::capacity> number{};  // of each of them in the batch
  std::vector<PreparedGroup> groups;

  std::size_t count() const { return static_cast<std::size_t>(asked.view().count); }
  std::size_t padded() const { return static_cast<std::size_t>(asked.view().padded); }
};

/// What of the weight of each particle asked follows each path.
struct PathWeights {
  std::array<const std::uint64_t*, most_levels> of{};  // [path], a column of quanta each
  const std::uint64_t* shares = nullptr;               // [level][padded] what they were divided into
  // of what a screen counted
  const std::uint64_t* totals = nullptr;  // of each particle
  const LevelSums* by_path = nullptr;
};

/// Masks over the particles asked, a column for each of several paths, aligned as kernels want them.
class PathMasks {
 public:
  PathMasks() = default;
  PathMasks(std::size_t columns, std::size_t padded)
      : columns_(columns), padded_(padded), lines_(columns * padded / 8) {}
  std::size_t columns() const { return columns_; }
  std::size_t padded() const { return padded_; }
  std::uint64_t* column(std::size_t i) {
    return reinterpret_cast<std::uint64_t*>(lines_.data()) + i * padded_;
  }
  const std::uint64_t* column(std::size_t i) const {
    return reinterpret_cast<const std::uint64_t*>(lines_.data()) + i * padded_;
  }

 private:
  struct alignas(64) Line {
    std::uint64_t words[8] = {};
  };
  std::size_t columns_ = 0, padded_ = 0;
  std::vector<Line> lines_;
};

/// What one stage keeps of the paths, and adds to its sums for each reweighting.
class PathTally {
 public:
  virtual ~PathTally() = default;
  /// The particles on a path come to the stage; `numbers`: of each of them in the batch. Only stages that
  /// read.
  virtual void see(std::size_t /*path*/, StageContext&, const std::uint16_t* /*numbers*/) {}
  /// What it has seen of a path; nothing where it does not look.
  virtual const PathPlaces* places(std::size_t /*path*/) const { return nullptr; }
  /// All paths are flown; the stage is that link of the chain.
  virtual void gather(const Paths&, std::size_t /*link*/, Isa) {}
  /// Adds to the stage's sums, and to its ledger by prepared level where it has one.
  virtual void add(const Paths&, const PathWeights&, Sum* sums, Sum* ledger) = 0;
  /// What it caught of the weights added last; nothing where it is no screen.
  virtual const PathWeights* caught() const { return nullptr; }
};

}  // namespace rabiline
