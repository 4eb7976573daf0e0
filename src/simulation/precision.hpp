#pragma once
// Whether a part of a run's particles tells enough.
#include <atomic>

#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// The experiment with the particles of a part alone (part_of, simulation/work.hpp).
Experiment part_of(const Experiment&, const Plan&, int halvings);

/// Of `detected`, over all detectors and scan points.
double largest_error(const Result&);

/// Of an experiment with `until`. Keeps both, which must live as long.
class Precision {
 public:
  Precision(const Experiment& experiment, const Plan& plan) : experiment_(experiment), plan_(plan) {}
  bool is_wanted() const { return experiment_.points.front().until.has_value(); }
  /// How often the particles may be halved.
  int halvings() const;
  /// Whether the sums of a part are as precise as is wanted.
  bool is_enough(const Sums&, int halvings);
  /// The largest error of `detected` that was found last, or 0; to be asked from any thread.
  double error() const { return error_; }

 private:
  const Experiment& experiment_;
  const Plan& plan_;
  std::atomic<double> error_{0};
};

}  // namespace rabiline
