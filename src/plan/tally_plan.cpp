#include "plan/tally_plan.hpp"

#include <algorithm>
#include <cassert>

#include "spin/majorana.hpp"

namespace rabiline {

bool asks_for_spin(const Tally& tally) {
  return std::any_of(tally.axes.begin(), tally.axes.end(),
                     [](const TallyAxis& axis) { return asks_for_spin(axis.quantity); });
}

Histogram histogram_of(const Tally& tally, int number, const Species& species, int levels) {
  assert(!tally.axes.empty() && tally.axes.size() <= most_tally_axes);
  Histogram histogram;
  histogram.tally = number;
  histogram.mass = species.mass;
  histogram.spins.levels = levels;
  for (const TallyAxis& axis : tally.axes) {
    HistogramAxis made;
    made.quantity = axis.quantity;
    if (is_categorical(axis.quantity)) {
      made.bins = levels;
      made.high = levels;
    } else {
      made.low = axis.from->value;
      made.high = axis.to->value;
      made.bins = static_cast<int>(*axis.bins);
    }
    if (axis.axis) {
      made.direction[0] = axis.axis->x;
      made.direction[1] = axis.axis->y;
      made.direction[2] = axis.axis->z;
    }
    histogram.axes.push_back(made);
  }
  if (levels > 0 && asks_for_spin(tally) && !species.structure)
    histogram.spins.polynomials = majorana_table(levels - 1).coefficients;
  return histogram;
}

std::uint64_t bins_of(const Tally& tally, int levels) {
  std::uint64_t product = 1;
  for (const TallyAxis& axis : tally.axes)
    product *= is_categorical(axis.quantity) ? static_cast<std::uint64_t>(levels) : axis.bins.value_or(1);
  return product;
}

}  // namespace rabiline
