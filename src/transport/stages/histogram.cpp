#include "transport/stages/histogram.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "tally/tally.hpp"
#include "transport/cost.hpp"
#include "transport/paths.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

constexpr std::size_t most_axes = most_tally_axes;
constexpr int outside_axis = -1;
constexpr auto last_step = static_cast<std::int64_t>(moment_steps) - 1;

/// Adds what one particle has in one bin, the last of which is outside of the axes, to the sums of a
/// histogram.
void add_score(std::size_t bin, std::uint64_t q, Sum* sums) {
  sums[HistogramSums::bin(bin)] += q;
  sums[HistogramSums::bin(bin) + 1] += square(q);
}

/// Where a value is on an axis.
struct Mark {
  int bin;                      // or outside_axis
  std::uint64_t u;              // in steps
  std::uint64_t first, second;  // what is summed for the axis' moments: u and its square, or a direction
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
    if (of_levels_) return {static_cast<int>(value), 0, 0, 0};
    if (!(value >= low_ && value <= high_)) return {outside_axis, 0, 0, 0};
    // Conversion to an integer rounds down, since nothing is negative.
    const double from_low = value - low_;
    const auto u = static_cast<std::uint64_t>(
        std::min(static_cast<std::int64_t>(from_low * steps_per_unit_), last_step));
    return {std::min(static_cast<int>(from_low * bins_per_unit_), bins_ - 1), u, u, u * u};
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
  Filler(const Histogram& histogram, StageContext& context)
      : histogram_(histogram), batch_(context.batch.view()), context_(context), layout_(sums_of(histogram)) {
    for (const HistogramAxis& axis : histogram.axes) rulers_.emplace_back(axis);
  }

  void fill() {
    if (!weigh()) return;
    measure();
    for (int i = 0; i < batch_.count; ++i)
      if (weights_[i] != 0) score(i);
  }

  /// As long as no measurement has several outcomes.
  void find_places(PathPlaces& places) {
    places.bin.fill(PathPlaces::nowhere);
    if (!weigh()) return;
    measure();
    for (int i = 0; i < batch_.count; ++i)
      if (weights_[i] != 0) find_place(i, places);
  }

 private:
  void find_place(int i, PathPlaces& places) {
    std::int64_t shares[most_levels];
    int found = 0;
    if (measured_) {
      share(i, shares);
      found = static_cast<int>(std::max_element(shares, shares + histogram_.spins.levels) - shares);
    }
    const auto at = static_cast<std::size_t>(i);
    std::size_t bin = 0, ranged = 0;
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      const Mark mark = rulers_[a].mark(is_measured(histogram_.axes[a]) ? outcome(a, found) : values_[a][i]);
      if (mark.bin == outside_axis) {
        places.bin[at] = static_cast<std::uint32_t>(layout_.bins);
        return;
      }
      bin = bin * static_cast<std::size_t>(rulers_[a].bins()) + static_cast<std::size_t>(mark.bin);
      if (!rulers_[a].of_levels()) places.steps[ranged++][at] = static_cast<std::uint32_t>(mark.u);
    }
    places.bin[at] = static_cast<std::uint32_t>(bin);
  }

  bool is_measured(const HistogramAxis& axis) const {
    return histogram_.spins.levels > 0 && asks_for_spin(axis.quantity);
  }

  /// The weight of each particle that counts; whether there is any.
  bool weigh() {
    if (histogram_.caught)
      for (int i = 0; i < batch_.padded; ++i)
        weights_[i] =
            batch_.caught_by[i] == static_cast<std::uint64_t>(histogram_.part) + 1 ? batch_.weight[i] : 0;
    else
      kernel::cross(context_.isa)(histogram_.face, batch_, weights_);
    return std::any_of(weights_, weights_ + batch_.padded, [](std::uint64_t w) { return w != 0; });
  }

  void measure() {
    SpinGauge spin;
    spin.path = histogram_.spins.view(context_.key);
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      const HistogramAxis& axis = histogram_.axes[a];
      if (!asks_for_spin(axis.quantity)) {
        kernel::measure(context_.isa)(
            {axis.quantity, histogram_.face.y, histogram_.mass, context_.key, histogram_.pulse}, batch_,
            weights_, values_[a]);
        continue;
      }
      std::copy_n(axis.direction, 3, spin.axis);
      if (is_measured(axis) && measured_) continue;  // the checks let pass one direction only
      measured_ = is_measured(axis);
      if (histogram_.spins.of_atom) {
        share_levels(histogram_.spins, context_.key, context_.isa, batch_, weights_, shares_);
        continue;
      }
      spin.quantity = axis.quantity;
      kernel::measure_spin(context_.isa)(spin, batch_, weights_, measured_ ? probabilities_ : values_[a]);
      if (is_circular(axis.quantity)) measure_across(spin);
    }
  }

  /// What the spin has along x and y.
  void measure_across(SpinGauge spin) {
    spin.quantity = Quantity::spin;
    for (std::size_t k = 0; k < 2; ++k) {
      std::fill_n(spin.axis, 3, 0.0);
      spin.axis[k] = 1;
      kernel::measure_spin(context_.isa)(spin, batch_, weights_, across_[k]);
    }
  }

  void score(int i) {
    Mark marks[most_axes];  // set where they are asked for
    for (std::size_t a = 0; a < rulers_.size(); ++a)
      if (!is_measured(histogram_.axes[a])) marks[a] = mark(a, i);
    if (!measured_) {
      const std::size_t bin = bin_of(marks);
      add_score(bin, weights_[i], context_.sums);
      if (bin != layout_.bins) add_moments(i, marks, weights_[i]);
      return;
    }
    std::int64_t shares[most_levels];
    share(i, shares);
    for (int k = 0; k < histogram_.spins.levels; ++k) {
      if (shares[k] == 0) continue;
      for (std::size_t a = 0; a < rulers_.size(); ++a)
        if (is_measured(histogram_.axes[a])) marks[a] = rulers_[a].mark(outcome(a, k));
      add_share(i, marks, static_cast<std::uint64_t>(shares[k]));
    }
    flush();
  }

  /// The last one where a mark is outside of its axis.
  std::size_t bin_of(const Mark* marks) const {
    std::size_t bin = 0;
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      if (marks[a].bin == outside_axis) return layout_.bins;
      bin = bin * static_cast<std::size_t>(rulers_[a].bins()) + static_cast<std::size_t>(marks[a].bin);
    }
    return bin;
  }
  void add_moments(int i, const Mark* marks, std::uint64_t q) {
    std::size_t axis = 0;
    for (std::size_t a = 0; a < rulers_.size(); ++a) {
      if (rulers_[a].of_levels()) continue;
      Sum* at = context_.sums + layout_.moments(axis++, batch_.particle[i] % moment_groups);
      at[0] += q;
      at[1] += static_cast<Sum>(q) * marks[a].first;
      at[2] += static_cast<Sum>(q) * marks[a].second;
    }
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
    const int twice = histogram_.spins.levels - 1;
    return static_cast<double>(twice - 2 * k) / twice;
  }

  /// All shares are floored, the largest takes what is missing.
  void share(int i, std::int64_t* shares) const {
    if (histogram_.spins.of_atom) {
      for (int k = 0; k < histogram_.spins.levels; ++k)
        shares[k] = static_cast<std::int64_t>(shares_[k * batch_.padded + i]);
      return;
    }
    const double weight = static_cast<double>(weights_[i]);
    auto rest = static_cast<std::int64_t>(weights_[i]);
    int largest = 0;
    for (int k = 0; k < histogram_.spins.levels; ++k) {
      shares[k] = static_cast<std::int64_t>(weight * probabilities_[k * batch_.padded + i]);
      if (shares[k] > shares[largest]) largest = k;
      rest -= shares[k];
    }
    shares[largest] += rest;
  }

  /// Outcomes come in order of m, so those of one particle in one bin come one after the other.
  void add_share(int i, const Mark* marks, std::uint64_t q) {
    const std::size_t bin = bin_of(marks);
    if (bin == layout_.bins) {
      outside_ += q;
      return;
    }
    if (bin != bin_) {
      flush_bin();
      bin_ = bin;
    }
    inside_ += q;
    add_moments(i, marks, q);
  }
  void flush_bin() {
    add_score(bin_, inside_, context_.sums);
    inside_ = 0;
  }
  void flush() {
    if (inside_ != 0) flush_bin();
    if (outside_ != 0) add_score(layout_.bins, outside_, context_.sums);
    outside_ = 0;
  }

  const Histogram& histogram_;
  const BatchView& batch_;
  StageContext& context_;
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

/// Where the particles on each path stand.
class HistogramPaths : public PathTally {
 public:
  explicit HistogramPaths(const Histogram& histogram) : histogram_(histogram), layout_(sums_of(histogram)) {}

  void see(std::size_t path, StageContext& here, const std::uint16_t* numbers) override {
    PathPlaces seen;
    Filler(histogram_, here).find_places(seen);
    if (places_.size() <= path) places_.resize(path + 1);
    PathPlaces& places = places_[path];
    places.bin.fill(PathPlaces::nowhere);
    for (std::size_t n = 0; n < static_cast<std::size_t>(here.batch.view().count); ++n) {
      places.bin[numbers[n]] = seen.bin[n];
      for (std::size_t axis = 0; axis < seen.steps.size(); ++axis)
        places.steps[axis][numbers[n]] = seen.steps[axis][n];
    }
  }

  const PathPlaces* places(std::size_t path) const override { return &places_[path]; }

  void add(const Paths& paths, const PathWeights& weights, Sum* sums, Sum*) override {
    for (std::size_t k = 0; k < paths.count(); ++k) {
      const std::size_t at = paths.number[k], group = paths.asked.view().particle[k] % moment_groups;
      std::array<std::uint32_t, most_levels> bins{};
      std::array<std::uint64_t, most_levels> scores{};
      std::size_t found = 0;
      for (std::size_t path = 0; path < paths.levels.size(); ++path) {
        const std::uint32_t bin = places_[path].bin[at];
        const std::uint64_t q = bin == PathPlaces::nowhere ? 0 : weights.of[path][k];
        if (q == 0) continue;
        std::size_t cell = 0;
        while (cell < found && bins[cell] != bin) ++cell;
        if (cell == found) bins[found++] = bin;
        scores[cell] += q;
        if (bin == layout_.bins) continue;
        for (std::size_t axis = 0; axis < layout_.axes; ++axis) {
          Sum* moments = sums + layout_.moments(axis, group);
          const Sum u = places_[path].steps[axis][at];
          moments[0] += q;
          moments[1] += q * u;
          moments[2] += q * u * u;
        }
      }
      for (std::size_t cell = 0; cell < found; ++cell) add_score(bins[cell], scores[cell], sums);
    }
  }

 private:
  const Histogram& histogram_;
  const HistogramSums layout_;
  std::vector<PathPlaces> places_;  // [path]
};

/// The name of a tally, and in how many planes its part has it.
struct Told {
  std::string name;
  std::uint64_t planes = 1;
};
Told told_of(const Part& part, std::size_t number) {
  return std::visit(
      [&](const auto& p) {
        Told told;
        if constexpr (requires { p.tallies; }) told.name = p.tallies[number].name;
        if constexpr (requires { p.planes; }) told.planes = p.planes;
        return told;
      },
      part);
}

}  // namespace

HistogramSums sums_of(const Histogram& histogram) {
  HistogramSums layout;
  for (const HistogramAxis& axis : histogram.axes) {
    layout.bins *= static_cast<std::size_t>(axis.bins);
    layout.axes += is_categorical(axis.quantity) ? 0 : 1;
  }
  return layout;
}

std::size_t Histogram::sums() const { return sums_of(*this).size(); }
void Histogram::pass(StageContext& context) const { Filler(*this, context).fill(); }
void Histogram::list_sums(SumSink& sink) const { sink.histogram(part, tally, plane, sums_of(*this), 0); }
double Histogram::y() const { return face.y; }
double Histogram::cost(double speed) const {
  const bool carries = !spins.zones.empty() || !spins.polynomials.empty();
  return cost::tally * static_cast<double>(axes.size() + 1) + (carries ? spins.cost(speed) : 0);
}
bool Histogram::follows_paths() const {
  return spins.keeps_levels() && std::all_of(axes.begin(), axes.end(), [](const HistogramAxis& axis) {
           return axis.quantity != Quantity::spin || (axis.direction[0] == 0 && axis.direction[1] == 0);
         });
}
std::unique_ptr<PathTally> Histogram::tally_paths() const { return std::make_unique<HistogramPaths>(*this); }

void Histogram::explain(PlanReport& report) const {
  if (plane > 0) return;
  const Told told = told_of(report.part(part).part, static_cast<std::size_t>(tally));
  std::string list;
  for (const HistogramAxis& axis : axes)
    list += fmt::format("{}{} ({} bins)", list.empty() ? "" : ", ", word_of(axis.quantity), axis.bins);
  if (!spins.zones.empty())
    list += fmt::format(", spins turned from {:.4g} to {:.4g} m", spins.zones.front().begin,
                        spins.zones.back().end);
  report.line("            {} tallies {}: {}; {:.4g} KiB of sums{}", report.name_of(part), told.name, list,
              static_cast<double>(told.planes * sums() * sizeof(Sum)) / 1024, report.reuse);
  if (spins.transitions != nullptr && !caught) report.tell_driven(part);
}

}  // namespace rabiline
