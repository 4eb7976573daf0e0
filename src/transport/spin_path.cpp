#include "transport/spin_path.hpp"

#include <algorithm>

#include "transport/cost.hpp"

namespace rabiline {
namespace {

Transitions view_of(const TransitionTable* table) {
  if (table == nullptr) return {};
  return {table->values.data(),
          table->begin.data(),
          table->targets.data(),
          table->first,
          table->step > 0 ? 1 / table->step : 0,
          table->points,
          table->row()};
}

}  // namespace

SpinPathView SpinPath::view(const RandomKey& key) const {
  return {key,
          levels,
          from_level,
          zones.data(),
          static_cast<int>(zones.size()),
          polynomials.data(),
          view_of(transitions)};
}

double cost_of(const std::vector<SpinZone>& zones, double speed) {
  double sum = 0;
  for (const SpinZone& zone : zones)
    sum += zone.step > 0 ? (zone.end - zone.begin) / speed / zone.step * 4 * cost::step : cost::zone;
  return sum;
}

double SpinPath::cost(double speed) const {
  return cost::closed_form * std::max(2, levels) + cost_of(zones, speed);
}

void share_levels(const SpinPath& path, Isa isa, const BatchView& batch, const std::uint64_t* weights,
                  std::uint64_t* shares) {
  if (path.transitions != nullptr) return kernel::outcomes(isa)(path.view({}), batch, weights, shares);
  std::fill_n(shares, path.levels * batch.padded, 0);
  for (int i = 0; i < batch.count; ++i)
    shares[static_cast<int>(batch.level[i]) * batch.padded + i] = weights[i];
}

}  // namespace rabiline
