#pragma once
// Moments aligned with a field.
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// Every spin comes out along the axis or against it, drawn with a probability.
struct Alignment {
  double probability = 1;      // that S comes out along `spin_sign` times the axis
  double spin_sign = 1;        // +1 or -1: S along the axis that puts the moment along the field
  double axis[3] = {0, 0, 1};  // unit vector
  int levels = 0;              // quantum: how many levels; 0: a vector law
  int along = 0, against = 0;  // quantum: the levels with S along the axis and against it
  int part = 0;
  double at = 0;  // [m]
  bool operator==(const Alignment&) const = default;

  static constexpr StageTraits traits{.spins = SpinEffect::set, .levels = LevelEffect::replaced};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Alignment>);

RABILINE_KERNEL(align, void(const Alignment&, const RandomKey&, BatchView&))

}  // namespace rabiline
