#pragma once
// Whether a part of a run's particles tells enough.
#include <atomic>

#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// The experiment with the particles of a part alone (part_of, simulation/work.hpp).
Experiment part_of(const Experiment&, const Plan&, int halvings);

/// What is known after a flight.
struct Reached {
  double detected_error = 0;  // the largest over all detectors and scan points, as it may be
  double centre_error = 0;    // the smallest over all detectors; 0 where it is not wanted
  /// The largest ratio of an error to what is wanted: 1 or less is enough.
  double over(const Until&) const;
};
Reached reached_by(const Result&, const Until&);

/// Of an experiment with `until`, which must live as long.
class Precision {
 public:
  explicit Precision(const Experiment& experiment) : experiment_(experiment) {}
  bool is_wanted() const { return experiment_.points.front().until.has_value(); }
  /// How often the particles may be halved.
  int halvings() const;
  /// Whether the result of a part is as precise as is wanted.
  bool is_enough(const Result&);
  /// What was found last, or zeros; to be asked from any thread.
  Reached reached() const { return {detected_error_, centre_error_}; }

 private:
  const Experiment& experiment_;
  std::atomic<double> detected_error_{0}, centre_error_{0};
};

}  // namespace rabiline
