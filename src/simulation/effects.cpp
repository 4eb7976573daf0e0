#include "simulation/effects.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

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

/// NaN, where nothing was detected, is like NaN, and -0 like 0. (The finalizer of MurmurHash3, A. Appleby.)
std::uint64_t mixed(std::uint64_t digest, double number) {
  digest ^= std::bit_cast<std::uint64_t>(std::isnan(number) ? std::numeric_limits<double>::quiet_NaN()
                                                            : number + 0.0);
  digest = (digest ^ (digest >> 33)) * 0xff51afd7ed558ccd;
  digest = (digest ^ (digest >> 33)) * 0xc4ceb9fe1a85ec53;
  return digest ^ (digest >> 33);
}

}  // namespace

void Effects::add(const Result& points) {
  const Seen seen = seen_in(points);
  anything_ = anything_ || !seen.empty();
  for (const DetectorResult& d : points.detectors)
    detected_ =
        detected_ || std::any_of(d.detected.begin(), d.detected.end(), [](double x) { return x > 0; });
  const std::size_t count = points.emitted.size();
  for (std::size_t point = 0; point < count; ++point) {
    std::uint64_t digest = 0;
    for (const std::vector<double>* numbers : seen) {
      const std::size_t each = numbers->size() / count;
      for (std::size_t i = point * each; i < (point + 1) * each; ++i) digest = mixed(digest, (*numbers)[i]);
    }
    seen_.push_back(digest);
  }
}

std::vector<std::string> Effects::warnings(const Result& result) const {
  std::vector<std::string> out;
  if (const auto& check = result.field_check; check && check->largest() > check->tolerance)
    out.push_back(fmt::format(
        "flights through fields are off by up to {:.2g} in place, {:.2g} in direction, {:.2g} in "
        "spin and {:.2g} in probabilities of levels, by an independent integration of {} "
        "particles: more than the tolerance of {:.2g}\n"
        "  help: a smaller `tolerance` of the law takes shorter steps",
        check->place, check->direction, check->spin, check->levels, check->particles, check->tolerance));
  const std::size_t points = seen_.size();
  if (!anything_) return out;
  if (!result.detectors.empty() && !detected_)
    out.emplace_back(
        "nothing was detected: no particle came to a detector\n"
        "  help: `rabiline summary` of the result tells where they ended, `rabiline draw` shows paths");
  std::size_t stride = points;
  for (const ScanAxis& axis : result.axes) {
    const std::size_t length = axis.values.size();
    stride /= length;
    bool no_effect = length > 1;
    for (std::size_t point = 0; point < points && no_effect; ++point)
      if (point / stride % length != 0) no_effect = seen_[point] == seen_[point - stride];
    if (no_effect)
      out.push_back(
          fmt::format("the scan of `{}` had no effect: all its points agree to the bit in every detector\n"
                      "  help: look with `rabiline check` for what acts on the particles, and when",
                      axis.parameter));
  }
  return out;
}

}  // namespace rabiline
