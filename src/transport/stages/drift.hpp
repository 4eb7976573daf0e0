#pragma once
// Straight flight to a plane.
#include "transport/kernels.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// The batch is then referred to that plane.
struct Drift {
  double end = 0;  // [m]
  bool operator==(const Drift&) const = default;

  static constexpr StageTraits traits{};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
};
static_assert(StageKind<Drift>);

RABILINE_KERNEL(drift, void(double y, BatchView&))

}  // namespace rabiline
