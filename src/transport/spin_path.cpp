#include "transport/spin_path.hpp"

#include <algorithm>

#include "transport/cost.hpp"

namespace rabiline {
namespace {

Transitions view_of(const DrivenLevels* driven) {
  if (driven == nullptr) return {};
  return {driven->blocks().data(), driven->block_of().data(), driven->levels_of_blocks().data(),
          driven->numbers().data()};
}

}  // namespace

SpinPathView SpinPath::view(const RandomKey& key) const {
  return {key,
          levels,
          from_level,
          zones.data(),
          static_cast<int>(zones.size()),
          polynomials.data(),
          view_of(transitions),
          way != nullptr ? &way->course() : nullptr};
}

double cost_of(const std::vector<SpinZone>& zones, double speed) {
  double sum = 0;
  for (const SpinZone& zone : zones)
    sum += zone.step > 0 ? (zone.end - zone.begin) / speed / zone.step * 4 * cost::step : cost::zone;
  return sum;
}

double SpinPath::cost(double speed) const {
  const double levels_mixed = transitions != nullptr ? cost::operation * transitions->work() : 0;
  return cost::closed_form * std::max(2, levels) + cost_of(zones, speed) + levels_mixed +
         (way != nullptr ? way->cost() : 0);
}

void share_levels(const SpinPath& path, const RandomKey& key, Isa isa, const BatchView& batch,
                  const std::uint64_t* weights, std::uint64_t* shares) {
  if (!path.is_idle()) return kernel::outcomes(isa)(path.view(key), batch, weights, shares);
  std::fill_n(shares, path.levels * batch.padded, 0);
  for (int i = 0; i < batch.count; ++i)
    shares[static_cast<int>(batch.level[i]) * batch.padded + i] = weights[i];
}

}  // namespace rabiline
