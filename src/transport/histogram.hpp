#pragma once
// Tallies as stages: read the batch and change nothing in it.
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "spin/transition_table.hpp"
#include "tally/sums.hpp"
#include "tally/tally.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// Counts what flies through a monitor's face in one of its planes.
struct Census {
  Aperture face;
  int part = 0;
  int plane = 0;
  bool operator==(const Census&) const = default;
};

/// An axis with equal bins from `low` to `high`, which belongs to the last one; of levels: one bin for each
/// from -I to I.
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
  double mass = 0;                  // [kg]
  PulseDraw pulse{};                // of the source
  int levels = 0;                   // quantum: how many; 0: a vector law
  std::vector<SpinZone> zones;      // that turn spins before the plane, where an axis asks for them
  std::vector<double> polynomials;  // MajoranaTable::coefficients
  bool of_atom = false;             // whose levels are asked for
  const TransitionTable* transitions = nullptr;  // of an atom that fields drive
  bool operator==(const Histogram&) const = default;
};

/// The sums of a census: q and q^2, then q of every group of particles.
struct CensusSums {
  static std::size_t total() { return 0; }
  static std::size_t group(std::size_t g) { return 2 + g; }
  static std::size_t size() { return 2 + group_count; }
};

/// Particles are put in so many groups for the errors of means and standard deviations.
inline constexpr std::size_t moment_groups = 64;
/// Places on an axis are rounded down to 2^24 steps: q u^2 <= 2^88, so 10^12 particles fit into 128 bits.
inline constexpr double moment_steps = 0x1p24;

/// The sums of a histogram: q and q^2 of every bin and of what is outside of the axes; then of every axis
/// that is not one of levels, for each group, q, q u and q u^2, u the place on the axis in steps. Of an axis
/// that goes in a circle: q, q (1 + cos)/2 and q (1 + sin)/2, these in steps.
struct HistogramSums {
  std::size_t bins = 1, axes = 0;
  std::size_t bin(std::size_t i) const { return 2 * i; }
  std::size_t outside() const { return 2 * bins; }
  std::size_t moments(std::size_t axis, std::size_t group) const {
    return 2 * bins + 2 + 3 * (axis * moment_groups + group);
  }
  std::size_t size() const { return moments(axes, 0); }
};
HistogramSums sums_of(const Histogram&);

/// Where each particle of a batch stands in a histogram, as long as no measurement has several outcomes.
struct HistogramPlaces {
  static constexpr std::uint32_t beyond = ~std::uint32_t{0};       // the range of an axis
  static constexpr std::uint32_t nowhere = ~std::uint32_t{0} - 1;  // does not count
  std::array<std::uint32_t, Batch::capacity> bin;
  std::array<std::array<std::uint32_t, Batch::capacity>, most_tally_axes>
      steps;  // of the axes that have moments
};

struct Flight;
void find_places(const Histogram&, Flight&, HistogramPlaces&);
/// Adds what one particle has in one bin, or beyond an axis, to the sums of a histogram.
void add_score(const HistogramSums&, std::uint32_t bin, std::uint64_t q, Sum* sums);
void pass(const Census&, Flight&);
void pass(const Histogram&, Flight&);

}  // namespace rabiline
