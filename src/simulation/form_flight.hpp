#pragma once
// The flight of a form: of one plan, or of slabs that fly one behind the other as one run.
#include <vector>

#include "simulation/form.hpp"
#include "simulation/run.hpp"

namespace rabiline {

class FormFlight {
 public:
  /// Both must outlive it. Slabs that fly by themselves are planned here once, to know their sizes.
  FormFlight(const Form&, const Experiment& scan, int threads);
  /// Of the run, but for what has flown: the places in its row, and how many sums.
  Snapshot beginning() const;
  /// Whether it can go on from the snapshot.
  bool fits(const Snapshot&) const;
  /// As run() of a plan does.
  RunOutcome run(const RunOptions&) const;
  /// All points of the scan, from what that left.
  Result finish(RunOutcome, Isa, const TakePoints&) const;

 private:
  /// What one slab has of the run's row and sums, in the order of slabs.
  struct Slab {
    std::uint64_t place = 0, particles = 0;
    std::size_t sum = 0, sums = 0;
  };
  void add(const Plan&);
  RunOutcome run_slabs(const RunOptions&) const;

  const Form& form_;
  const Experiment& scan_;
  const int threads_;
  std::vector<Slab> slabs_;
  std::uint64_t particles_ = 0;
  std::size_t sums_ = 0;
};

/// What is kept of the sums of such a slab when it has flown, at most [bytes]: those that its points need. No
/// scan of so many has a covariance, for which particles are counted in groups.
double bytes_of_kept_sums(const Plan&);

}  // namespace rabiline
