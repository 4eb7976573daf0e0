#include "field/field_formula.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "field/formula_parser.hpp"

namespace rabiline {
namespace {

/// Mean values over a period at 16 equal times, so that harmonics up to the seventh do not mix with those
/// that are kept.
constexpr int times = 16, kept = 2 * most_field_harmonics + 1;
/// cos(k a) of number 2 k - 1 and sin(k a) of number 2 k, at a = 2 pi f t.
double wave(int number, double angle) {
  const int k = (number + 1) / 2;
  return number % 2 == 1 ? portable::cos(k * angle) : portable::sin(k * angle);
}
/// The harmonics of one value that follows t, and by how much it differs from them at other times, a few
/// periods later.
std::array<double, kept> harmonics_of(FormulaComponent& formula, const std::array<double, 3>& place,
                                      double period, double& left_out) {
  std::array<double, kept> out{};
  for (int i = 0; i < times; ++i) {
    const double value = formula.at(place, period * i / times), angle = 2 * std::numbers::pi * i / times;
    out[0] += value / times;
    for (int n = 1; n < kept; ++n) out[static_cast<std::size_t>(n)] += 2 * wave(n, angle) * value / times;
  }
  for (const double periods : {1.137, 2.447, 5.829}) {
    double sum = out[0];
    for (int n = 1; n < kept; ++n)
      sum += out[static_cast<std::size_t>(n)] * wave(n, 2 * std::numbers::pi * periods);
    left_out = std::max(left_out, std::abs(formula.at(place, period * periods) - sum));
  }
  return out;
}

double largest_of(const MapNodes& nodes) {
  double largest = 0;
  for (const double value : nodes.field) largest = std::max(largest, std::abs(value));
  return largest;
}

/// One component of all harmonics.
class Sampler {
 public:
  Sampler(const FieldFormula& formula, const std::array<MapAxis, 3>& axes) : formula_(formula), axes_(axes) {
    for (std::size_t a = 0; a < 3; ++a) n_[a] = static_cast<std::size_t>(axes[a].nodes);
    harmonics_.push_back(empty(0));
  }

  void add(std::size_t component) {
    FormulaComponent formula(formula_, component);
    const bool moves = formula.moves();
    for (int n = 1; moves && harmonics_.size() < kept; ++n) harmonics_.push_back(empty(n));
    std::size_t to = component;
    for (std::size_t i = 0; i < n_[0]; ++i)
      for (std::size_t j = 0; j < n_[1]; ++j)
        for (std::size_t k = 0; k < n_[2]; ++k, to += 3) {
          const std::array<double, 3> at = place_of(axes_, i, j, k);
          if (!moves) {
            harmonics_[0].nodes.field[to] = formula.at(at, 0);
            continue;
          }
          const auto values = harmonics_of(formula, at, 1 / formula_.frequency, left_out_);
          for (std::size_t n = 0; n < kept; ++n) harmonics_[n].nodes.field[to] = values[n];
        }
  }

  std::vector<FieldHarmonic> result() {
    double largest = 0;
    for (const FieldHarmonic& harmonic : harmonics_) largest = std::max(largest, largest_of(harmonic.nodes));
    const auto fault = [](const char* message, std::string help) {
      FormulaFault out(message, std::move(help));
      out.component = 3;
      return out;
    };
    if (formula_.frequency > 0 && harmonics_.size() == 1)
      throw fault("no component has t: the field stands", "omit `frequency`, or write `t` [s] where it acts");
    if (!(left_out_ <= 1e-6 * largest))
      throw fault(
          "the formulas do not repeat with this frequency in four harmonics",
          "state that of their slowest part; `cos(2*pi*f*t)` repeats with f, its square with 2*f or f");
    std::erase_if(harmonics_, [&](const FieldHarmonic& h) { return largest_of(h.nodes) <= 1e-12 * largest; });
    if (harmonics_.empty()) harmonics_.push_back(empty(0));
    return std::move(harmonics_);
  }

 private:
  FieldHarmonic empty(int number) const {
    FieldHarmonic out{(number + 1) / 2, number > 0 && number % 2 == 0, {{axes_.begin(), axes_.end()}, {}}};
    out.nodes.field.resize(n_[0] * n_[1] * n_[2] * 3);
    return out;
  }
  const FieldFormula& formula_;
  const std::array<MapAxis, 3>& axes_;
  std::array<std::size_t, 3> n_{};
  std::vector<FieldHarmonic> harmonics_;
  double left_out_ = 0;  // [T]
};

}  // namespace

std::vector<FieldHarmonic> sampled(const FieldFormula& formula, const std::array<MapAxis, 3>& axes) {
  Sampler sampler(formula, axes);
  for (std::size_t component = 0; component < 3; ++component) sampler.add(component);
  return sampler.result();
}

}  // namespace rabiline
