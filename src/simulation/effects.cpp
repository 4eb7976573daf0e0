#include "simulation/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rabiline {
namespace {

/// Numbers of each scan point, one point behind the other.
using Seen = std::vector<const std::vector<double>*>;

Seen seen_in(const Result& result) {
  Seen out;
  for (const DetectorResult& d : result.detectors) out.insert(out.end(), {&d.counts, &d.detected, &d.levels});
  for (const MonitorResult& m : result.monitors) out.push_back(&m.passed);
  for (const TallyResult& t : result.tallies) out.insert(out.end(), {&t.counts, &t.outside});
  return out;
}

/// NaN, where nothing was detected, is like NaN.
bool alike(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

bool points_agree(const Seen& seen, std::size_t points, std::size_t a, std::size_t b) {
  return std::all_of(seen.begin(), seen.end(), [&](const std::vector<double>* numbers) {
    const auto each = static_cast<std::ptrdiff_t>(numbers->size() / points);
    const auto at = [&](std::size_t point) {
      return numbers->begin() + static_cast<std::ptrdiff_t>(point) * each;
    };
    return std::equal(at(a), at(a) + each, at(b), alike);
  });
}

}  // namespace

std::vector<std::string> warnings_of(const Result& result) {
  std::vector<std::string> out;
  if (const auto& check = result.field_check; check && check->largest() > check->tolerance)
    out.push_back(fmt::format(
        "flights through fields are off by up to {:.2g} in place, {:.2g} in direction, {:.2g} in "
        "spin and {:.2g} in probabilities of levels, by an independent integration of {} "
        "particles: more than the tolerance of {:.2g}\n"
        "  help: a smaller `tolerance` of the law takes shorter steps",
        check->place, check->direction, check->spin, check->levels, check->particles, check->tolerance));
  const Seen seen = seen_in(result);
  const std::size_t points = result.emitted.size();
  if (seen.empty()) return out;
  std::size_t stride = points;
  for (const ScanAxis& axis : result.axes) {
    const std::size_t length = axis.values.size();
    stride /= length;
    bool no_effect = length > 1;
    for (std::size_t point = 0; point < points && no_effect; ++point)
      if (point / stride % length != 0) no_effect = points_agree(seen, points, point, point - stride);
    if (no_effect)
      out.push_back(
          fmt::format("the scan of `{}` had no effect: all its points agree to the bit in every detector\n"
                      "  help: look with `rabiline check` for what acts on the particles, and when",
                      axis.parameter));
  }
  return out;
}

}  // namespace rabiline
