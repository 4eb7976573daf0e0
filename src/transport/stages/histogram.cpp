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

/// Adds what one particle has in one bin, the last of which is outside of the axes, to the sums of a
/// histogram.
void add_score(std::size_t bin, std::uint64_t q, Sum* sums) {
  sums[HistogramSums::bin(bin)] += q;
  sums[HistogramSums::bin(bin) + 1] += square(q);
}

/// Where values are on an axis; and what is summed for its moments: steps and their squares, or directions.
struct Marks {
  alignas(64) std::uint64_t bin[Batch::capacity];
  alignas(64) std::uint64_t first[Batch::capacity], second[Batch::capacity];
};

constexpr int axis_steps = static_cast<int>(moment_steps);
Ruler ruler(double low, double high, int divisions) {
  return {low, high, divisions / (high - low), divisions};
}

/// Fills one histogram with one batch.
class Filler {
 public:
  Filler(const Histogram& histogram, StageContext& context)
      : histogram_(histogram), batch_(context.batch.view()), context_(context), layout_(sums_of(histogram)) {}

  void fill() {
    if (!weigh()) return;
    mark();
    if (!measured_) return score_all();
    for (int i = 0; i < batch_.count; ++i)
      if (weights_[i] != 0) score_outcomes(i);
  }

  /// As long as no measurement has several outcomes.
  void find_places(PathPlaces& places) {
    places.bin.fill(PathPlaces::nowhere);
    if (!weigh()) return;
    mark();
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
    const std::size_t bin = bin_of(i, found);
    places.bin[static_cast<std::size_t>(i)] = static_cast<std::uint32_t>(bin);
    std::size_t ranged = 0;
    for (std::size_t a = 0; a < axes() && bin != layout_.bins; ++a)
      if (has_moments(a))
        places.steps[ranged++][static_cast<std::size_t>(i)] =
            static_cast<std::uint32_t>(marks_[a].first[mark_of(a, i, found)]);
  }

  std::size_t axes() const { return histogram_.axes.size(); }
  bool has_moments(std::size_t axis) const { return !is_categorical(histogram_.axes[axis].quantity); }

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

  /// Where all particles are on all axes; on one of a measured spin, where its outcomes are.
  void mark() {
    SpinGauge spin;
    spin.path = histogram_.spins.view(context_.key);
    alignas(64) double values[Batch::capacity] = {};
    for (std::size_t a = 0; a < axes(); ++a) {
      const HistogramAxis& axis = histogram_.axes[a];
      of_outcomes_[a] = histogram_.spins.levels > 0 && asks_for_spin(axis.quantity);
      spin.quantity = axis.quantity;
      std::copy_n(axis.direction, 3, spin.axis);
      if (of_outcomes_[a]) {
        if (!measured_) measure_outcomes(spin);  // the checks let pass one direction only
        for (int k = 0; k < histogram_.spins.levels; ++k) values[k] = outcome(axis, k);
      } else if (asks_for_spin(axis.quantity)) {
        kernel::measure_spin(context_.isa)(spin, batch_, weights_, values);
      } else {
        kernel::measure(context_.isa)(
            {axis.quantity, histogram_.face.y, histogram_.mass, context_.key, histogram_.pulse}, batch_,
            weights_, values);
      }
      mark_axis(axis, values, marks_[a], spin);
    }
  }
  void mark_axis(const HistogramAxis& axis, const double* values, Marks& marks, const SpinGauge& spin) {
    const bool ranged = !is_categorical(axis.quantity);
    mark(ranged ? ruler(axis.low, axis.high, axis.bins) : ruler(0, axis.bins, axis.bins), values, marks.bin);
    if (is_circular(axis.quantity)) return mark_directions(spin, marks);
    if (!ranged) return;
    mark(ruler(axis.low, axis.high, axis_steps), values, marks.first);
    for (int i = 0; i < most_marks(); ++i) marks.second[i] = marks.first[i] * marks.first[i];
  }
  void mark(const Ruler& ruler, const double* values, std::uint64_t* divisions) const {
    kernel::mark(context_.isa)(ruler, values, most_marks(), divisions);
  }
  int most_marks() const { return std::max(batch_.padded, most_levels); }
  void measure_outcomes(const SpinGauge& spin) {
    measured_ = true;
    if (histogram_.spins.of_atom)
      share_levels(histogram_.spins, context_.key, context_.isa, batch_, weights_, shares_);
    else
      kernel::measure_spin(context_.isa)(spin, batch_, weights_, probabilities_);
  }

  /// Angles that go in a circle have the mean of their directions.
  void mark_directions(SpinGauge spin, Marks& marks) const {
    spin.quantity = Quantity::spin;
    alignas(64) double along[2][Batch::capacity] = {};
    for (std::size_t k = 0; k < 2; ++k) {
      std::fill_n(spin.axis, 3, 0.0);
      spin.axis[k] = 1;
      kernel::measure_spin(context_.isa)(spin, batch_, weights_, along[k]);
    }
    for (int i = 0; i < batch_.count; ++i) {
      const double x = along[0][i], y = along[1][i], length = std::sqrt(x * x + y * y);
      along[0][i] = length > 0 ? std::clamp(x / length, -1.0, 1.0) : 1;
      along[1][i] = length > 0 ? std::clamp(y / length, -1.0, 1.0) : 0;
    }
    mark(ruler(-1, 1, axis_steps), along[0], marks.first);
    mark(ruler(-1, 1, axis_steps), along[1], marks.second);
  }

  void score_all() {
    std::uint64_t bins[Batch::capacity] = {};
    for (std::size_t a = 0; a < axes(); ++a)
      for (int i = 0; i < batch_.count; ++i) bins[i] = joint_bin(bins[i], a, marks_[a].bin[i]);
    for (int i = 0; i < batch_.count; ++i)
      if (weights_[i] != 0)
        add_score(std::min<std::size_t>(bins[i], layout_.bins), weights_[i], context_.sums);
    std::size_t axis = 0;
    for (std::size_t a = 0; a < axes(); ++a) {
      if (!has_moments(a)) continue;
      for (int i = 0; i < batch_.count; ++i)
        if (weights_[i] != 0 && bins[i] != Ruler::outside)
          add_moments(marks_[a], static_cast<std::size_t>(i), weights_[i],
                      context_.sums + layout_.moments(axis, batch_.particle[i] % moment_groups));
      ++axis;
    }
  }
  void score_outcomes(int i) {
    std::int64_t shares[most_levels];
    share(i, shares);
    for (int k = 0; k < histogram_.spins.levels; ++k)
      if (shares[k] != 0) add_share(i, k, static_cast<std::uint64_t>(shares[k]));
    flush();
  }

  std::size_t mark_of(std::size_t axis, int i, int outcome) const {
    return static_cast<std::size_t>(of_outcomes_[axis] ? outcome : i);
  }
  /// The bin of several axes, from that of the first ones and that of the next; also outside.
  std::uint64_t joint_bin(std::uint64_t bin, std::size_t axis, std::uint64_t next) const {
    if (bin == Ruler::outside || next == Ruler::outside) return Ruler::outside;
    return bin * static_cast<std::uint64_t>(histogram_.axes[axis].bins) + next;
  }
  /// The last one where a mark is outside of its axis.
  std::size_t bin_of(int i, int outcome) const {
    std::uint64_t bin = 0;
    for (std::size_t a = 0; a < axes(); ++a) bin = joint_bin(bin, a, marks_[a].bin[mark_of(a, i, outcome)]);
    return std::min<std::size_t>(bin, layout_.bins);
  }
  /// To the sums of one axis and one group of particles.
  static void add_moments(const Marks& marks, std::size_t mark, std::uint64_t q, Sum* sums) {
    sums[0] += q;
    sums[1] += static_cast<Sum>(q) * marks.first[mark];
    sums[2] += static_cast<Sum>(q) * marks.second[mark];
  }

  /// What an axis shows of outcome k: the level's number, or m/I.
  double outcome(const HistogramAxis& axis, int k) const {
    if (is_categorical(axis.quantity)) return k;
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
  void add_share(int i, int outcome, std::uint64_t q) {
    const std::size_t bin = bin_of(i, outcome);
    if (bin == layout_.bins) {
      outside_ += q;
      return;
    }
    if (bin != bin_) {
      flush_bin();
      bin_ = bin;
    }
    inside_ += q;
    std::size_t axis = 0;
    for (std::size_t a = 0; a < axes(); ++a)
      if (has_moments(a))
        add_moments(marks_[a], mark_of(a, i, outcome), q,
                    context_.sums + layout_.moments(axis++, batch_.particle[i] % moment_groups));
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
  bool measured_ = false;             // the spin has outcomes
  bool of_outcomes_[most_axes] = {};  // marks are by outcome, not by particle
  std::size_t bin_ = 0;               // of the particle at hand
  std::uint64_t inside_ = 0, outside_ = 0;
  alignas(64) std::uint64_t weights_[Batch::capacity];
  Marks marks_[most_axes];
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
