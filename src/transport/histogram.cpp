#include "transport/histogram.hpp"

#include <algorithm>

#include "tally/tally.hpp"
#include "transport/stages.hpp"

namespace rabiline {
namespace {

Sum square(std::uint64_t q) { return static_cast<Sum>(q) * q; }

constexpr std::size_t most_axes = most_tally_axes;
constexpr int outside_axis = -1;
constexpr auto last_step = static_cast<std::int64_t>(moment_steps) - 1;

/// Where a value is on an axis.
struct Mark {
  int bin = 0;                              // or outside_axis
  std::uint64_t u = 0;                      // in steps
  std::uint64_t first = u, second = u * u;  // what is summed for the axis' moments
};

/// Finds bins; one for each axis, so that divisions are made once.
class Ruler {
 public:
  explicit Ruler(const HistogramAxis& axis)
      : low_(axis.low),
        high_(axis.high),
        bins_(axis.bins),
        bins_per_unit_(axis.bins / (axis.high - axis.low)),
        steps_per_unit_(moment_steps / (axis.high - axis.low)),
        of_levels_(is_categorical(axis.quantity)) {}

  Mark mark(double value) const {
    if (of_levels_) return {bins_ - 1 - static_cast<int>(value), 0};  // levels count down from m = I
    if (!(value >= low_ && value <= high_)) return {outside_axis, 0};
    // Conversion to an integer rounds down, since nothing is negative.
    const double from_low = value - low_;
    return {std::min(static_cast<int>(from_low * bins_per_unit_), bins_ - 1),
            static_cast<std::uint64_t>(
                std::min(static_cast<std::int64_t>(from_low * steps_per_unit_), last_step))};
  }
  bool of_levels() const { return of_levels_; }
  int bins() const { return bins_; }

 private:
  double low_, high_;
  int bins_;
  double bins_per_unit_, steps_per_unit_;
  bool of_levels_;
};

/// Fills one histogram with one batch.
class Filler {
 public:
  Filler(const Histogram& histogram, Flight& flight)
      : histogram_(histogram), batch_(flight.batch.view()), flight_(flight), layout_(sums_of(histogram)) {
    for (const HistogramAxis& axis : histogram.axes) rulers_.emplace_back(axis);
  }

  void fill() {
    if (!weigh()) return;
    measure();
    for (int i = 0; i < batch_.count; ++i)
      if (weights_[i] != 0) score(i);
  }

  void find_places(HistogramPlaces& places) {
    places.bin.fill(HistogramPlaces::nowhere);
    if (!weigh()) return;
    measure();
    for (int i = 0; i < batch_.count; ++i)
      if (weights_[i] != 0) find_place(i, places);
  }

 private:
  void find_place(int i, HistogramPlaces& places) {
    std::int64_t shares[most_levels];
    int found = 0;
    if (measured_) {
      share(i, shares);
      found = static_cast<int>(std::max_element(shares, shares + histogram_.levels) - shares);
    }
    const auto at = static_cast<std::size_t>(i);
    std::size_t bin = 0, ranged = 0;
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      const Mark mark = rulers_[a].mark(is_measured(histogram_.axes[a]) ? outcome(a, found) : values_[a][i]);
      if (mark.bin == outside_axis) {
        places.bin[at] = HistogramPlaces::beyond;
        return;
      }
      bin = bin * static_cast<std::size_t>(rulers_[a].bins()) + static_cast<std::size_t>(mark.bin);
      if (!rulers_[a].of_levels()) places.steps[ranged++][at] = static_cast<std::uint32_t>(mark.u);
    }
    places.bin[at] = static_cast<std::uint32_t>(bin);
  }

  bool is_measured(const HistogramAxis& axis) const {
    return histogram_.levels > 0 && asks_for_spin(axis.quantity);
  }

  /// The weight of each particle that counts; whether there is any.
  bool weigh() {
    if (histogram_.caught)
      for (int i = 0; i < batch_.padded; ++i)
        weights_[i] =
            batch_.caught_by[i] == static_cast<std::uint64_t>(histogram_.part) + 1 ? batch_.weight[i] : 0;
    else
      flight_.kernels.cross(histogram_.face, batch_, weights_);
    return std::any_of(weights_, weights_ + batch_.padded, [](std::uint64_t w) { return w != 0; });
  }

  void measure() {
    SpinGauge spin;
    spin.key = flight_.key;
    spin.levels = histogram_.levels;
    spin.zones = histogram_.zones.data();
    spin.zone_count = static_cast<int>(histogram_.zones.size());
    spin.polynomials = histogram_.polynomials.data();
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      const HistogramAxis& axis = histogram_.axes[a];
      if (!asks_for_spin(axis.quantity)) {
        flight_.kernels.measure(
            {axis.quantity, histogram_.face.y, histogram_.mass, flight_.key, histogram_.pulse}, batch_,
            weights_, values_[a]);
        continue;
      }
      std::copy_n(axis.direction, 3, spin.axis);
      if (is_measured(axis) && measured_) continue;  // the checks let pass one direction only
      measured_ = is_measured(axis);
      if (histogram_.of_atom) {
        share_levels(histogram_.levels, histogram_.transitions, flight_, weights_, shares_);
        continue;
      }
      spin.quantity = axis.quantity;
      flight_.kernels.measure_spin(spin, batch_, weights_, measured_ ? probabilities_ : values_[a]);
      if (is_circular(axis.quantity)) measure_across(spin);
    }
  }

  /// What the spin has along x and y.
  void measure_across(SpinGauge spin) {
    spin.quantity = Quantity::spin;
    for (std::size_t k = 0; k < 2; ++k) {
      std::fill_n(spin.axis, 3, 0.0);
      spin.axis[k] = 1;
      flight_.kernels.measure_spin(spin, batch_, weights_, across_[k]);
    }
  }

  void score(int i) {
    Mark marks[most_axes];
    for (std::size_t a = 0; a < rulers_.size(); ++a)
      if (!is_measured(histogram_.axes[a])) marks[a] = mark(a, i);
    if (!measured_) {
      add(i, marks, weights_[i]);
    } else {
      std::int64_t shares[most_levels];
      share(i, shares);
      for (int k = 0; k < histogram_.levels; ++k) {
        if (shares[k] == 0) continue;
        for (std::size_t a = 0; a < rulers_.size(); ++a)
          if (is_measured(histogram_.axes[a])) marks[a] = rulers_[a].mark(outcome(a, k));
        add(i, marks, static_cast<std::uint64_t>(shares[k]));
      }
    }
    flush();
  }

  /// Angles that go in a circle have the mean of their directions.
  Mark mark(std::size_t axis, int i) const {
    Mark made = rulers_[axis].mark(values_[axis][i]);
    if (!is_circular(histogram_.axes[axis].quantity)) return made;
    const double x = across_[0][i], y = across_[1][i], length = std::sqrt(x * x + y * y);
    made.first = in_steps(length > 0 ? x / length : 1);
    made.second = in_steps(length > 0 ? y / length : 0);
    return made;
  }
  /// A number from -1 to 1.
  static std::uint64_t in_steps(double number) {
    return static_cast<std::uint64_t>(
        std::min(static_cast<std::int64_t>((1 + number) * (moment_steps / 2)), last_step));
  }

  /// What an axis shows of outcome k: the level's number, or m/I.
  double outcome(std::size_t axis, int k) const {
    if (rulers_[axis].of_levels()) return k;
    const int twice = histogram_.levels - 1;
    return static_cast<double>(twice - 2 * k) / twice;
  }

  /// All shares are floored, the largest takes what is missing.
  void share(int i, std::int64_t* shares) const {
    if (histogram_.of_atom) {
      for (int k = 0; k < histogram_.levels; ++k)
        shares[k] = static_cast<std::int64_t>(shares_[k * batch_.padded + i]);
      return;
    }
    const double weight = static_cast<double>(weights_[i]);
    auto rest = static_cast<std::int64_t>(weights_[i]);
    int largest = 0;
    for (int k = 0; k < histogram_.levels; ++k) {
      shares[k] = static_cast<std::int64_t>(weight * probabilities_[k * batch_.padded + i]);
      if (shares[k] > shares[largest]) largest = k;
      rest -= shares[k];
    }
    shares[largest] += rest;
  }

  /// Outcomes come in order of m, so those of one particle in one bin come one after the other.
  void add(int i, const Mark* marks, std::uint64_t q) {
    std::size_t bin = 0;
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      if (marks[a].bin == outside_axis) {
        outside_ += q;
        return;
      }
      bin = bin * static_cast<std::size_t>(rulers_[a].bins()) + static_cast<std::size_t>(marks[a].bin);
    }
    if (bin != bin_) {
      flush_bin();
      bin_ = bin;
    }
    inside_ += q;
    Sum* sums = flight_.sums;
    std::size_t axis = 0;
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      if (rulers_[a].of_levels()) continue;
      Sum* at = sums + layout_.moments(axis++, batch_.particle[i] % moment_groups);
      at[0] += q;
      at[1] += static_cast<Sum>(q) * marks[a].first;
      at[2] += static_cast<Sum>(q) * marks[a].second;
    }
  }
  void flush_bin() {
    add_score(layout_, static_cast<std::uint32_t>(bin_), inside_, flight_.sums);
    inside_ = 0;
  }
  void flush() {
    if (inside_ != 0) flush_bin();
    add_score(layout_, HistogramPlaces::beyond, outside_, flight_.sums);
    outside_ = 0;
  }

  const Histogram& histogram_;
  const BatchView& batch_;
  Flight& flight_;
  const HistogramSums layout_;
  std::vector<Ruler> rulers_;
  bool measured_ = false;  // the spin has outcomes
  std::size_t bin_ = 0;    // of the particle at hand
  std::uint64_t inside_ = 0, outside_ = 0;
  alignas(64) std::uint64_t weights_[Batch::capacity];
  alignas(64) double values_[most_axes][Batch::capacity];
  alignas(64) double across_[2][Batch::capacity];  // of the spin, along x and y
  union {
    alignas(64) double probabilities_[most_levels * Batch::capacity];
    alignas(64) std::uint64_t shares_[most_levels * Batch::capacity];  // of an atom
  };
};

}  // namespace

HistogramSums sums_of(const Histogram& histogram) {
  HistogramSums layout;
  for (const HistogramAxis& axis : histogram.axes) {
    layout.bins *= static_cast<std::size_t>(axis.bins);
    layout.axes += is_categorical(axis.quantity) ? 0 : 1;
  }
  return layout;
}

void pass(const Census& census, Flight& flight) {
  const BatchView& batch = flight.batch.view();
  alignas(64) std::uint64_t weights[Batch::capacity];
  flight.kernels.cross(census.face, batch, weights);
  for (int i = 0; i < batch.count; ++i) {
    flight.sums[CensusSums::total()] += weights[i];
    flight.sums[CensusSums::total() + 1] += square(weights[i]);
    flight.sums[CensusSums::group(batch.particle[i] % group_count)] += weights[i];
  }
}

void add_score(const HistogramSums& layout, std::uint32_t bin, std::uint64_t q, Sum* sums) {
  Sum* at = sums + (bin == HistogramPlaces::beyond ? layout.outside() : layout.bin(bin));
  at[0] += q;
  at[1] += square(q);
}

void find_places(const Histogram& histogram, Flight& flight, HistogramPlaces& places) {
  Filler(histogram, flight).find_places(places);
}

void pass(const Histogram& histogram, Flight& flight) { Filler(histogram, flight).fill(); }

}  // namespace rabiline
