#pragma once
// A tally of a monitor or a detector.
#include <memory>
#include <vector>

#include "transport/spin_path.hpp"
#include "transport/stage_concept.hpp"
#include "transport/sum_layout.hpp"

namespace rabiline {

/// An axis with equal bins from `low` to `high`, which belongs to the last one; of levels: one bin for each
/// from I down to -I.
struct HistogramAxis {
  Quantity quantity = Quantity::x;
  double low = 0, high = 1;  // [SI]
  int bins = 1;
  double direction[3] = {0, 0, 1};  // that a spin is projected on
  bool operator==(const HistogramAxis&) const = default;
};

/// One tally of a monitor, where it stands, or of a detector, behind everything: then of what it caught.
/// Under `quantum` a spin is measured: the weight of a particle is split over the outcomes by their
/// probabilities, floored, and the largest share takes the rest.
struct Histogram {
  int part = 0;
  int tally = 0;        // its number in the part's list
  int plane = 0;        // of the monitor
  bool caught = false;  // of what the detector `part` caught, else of what flies through `face`
  Aperture face;        // of a detector only its place along the beam
  std::vector<HistogramAxis> axes;
  double mass = 0;    // [kg]
  PulseDraw pulse{};  // of the source
  SpinPath spins;     // before the plane, where an axis asks for them; its levels also where none does
  bool operator==(const Histogram&) const = default;

  static constexpr StageTraits traits{.only_reads = true};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  const SpinPath* path() const { return &spins; }
  int reads_catch_of() const { return caught ? part : no_part; }
  std::unique_ptr<PathTally> tally_paths() const;
};
static_assert(StageKind<Histogram>);

HistogramSums sums_of(const Histogram&);

}  // namespace rabiline
