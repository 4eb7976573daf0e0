#include "transport/spin_path.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>

#include "transport/cost.hpp"
#include "transport/stages/precession.hpp"

namespace rabiline {
namespace {

Transitions view_of(const DrivenLevels* driven) {
  if (driven == nullptr) return {};
  return {driven->blocks().data(), driven->block_of().data(), driven->levels_of_blocks().data(),
          driven->numbers().data()};
}

/// As a batch that passes the filters one after the other.
void share_behind_filters(const SpinPath& path, const RandomKey& key, Isa isa, const BatchView& batch,
                          const std::uint64_t* weights, std::uint64_t* shares) {
  Batch passing;
  BatchView& b = passing.view();
  b.count = batch.count;
  b.padded = batch.padded;
  b.y = batch.y;
  b.fall = batch.fall;
  for (const auto column : real_columns) std::copy_n(batch.*column, batch.padded, b.*column);
  for (const auto column : word_columns) std::copy_n(batch.*column, batch.padded, b.*column);
  std::copy_n(weights, batch.padded, b.weight);
  for (int i = 0; i < batch.padded; ++i) b.flying[i] = weights[i] != 0 ? ~std::uint64_t{0} : 0;
  std::uint64_t* stopped = shares + static_cast<std::ptrdiff_t>(path.outcomes()) * batch.padded;
  for (const FilteredZones& next : path.filters) {
    stopped -= batch.padded;
    std::copy_n(b.weight, batch.padded, stopped);
    kernel::precess(isa)(next.zones.data(), static_cast<int>(next.zones.size()), key, b);
    kernel::filter(isa)(next.filter, b);
    for (int i = 0; i < batch.padded; ++i) stopped[i] -= b.weight[i];
  }
  require_followed(kernel::outcomes(isa)(path.view(key), b, b.weight, shares));
}

}  // namespace

void require_followed(std::uint64_t lost) {
  if (lost == no_particle) return;
  throw std::invalid_argument(
      fmt::format("the levels of particle {} could not be followed through the fields on its way: steps that "
                  "keep the tolerance became too short to go on\n  help: a looser `tolerance` of the law, or "
                  "look at its fields: `rabiline trace FILE --particle {}`",
                  lost, lost));
}

SpinPathView SpinPath::view(const RandomKey& key) const {
  return {key,
          levels,
          from_level(),
          zones.data(),
          static_cast<int>(zones.size()),
          polynomials.data(),
          view_of(transitions),
          way != nullptr ? &way->course() : nullptr,
          {axis.x, axis.y, axis.z}};
}

double cost_of(const SpinZones& zones, double speed) {
  double sum = 0;
  for (const SpinZone& zone : zones)
    sum += zone.step > 0 ? (zone.end - zone.begin) / speed / zone.step * 4 * cost::step : cost::zone;
  return sum;
}

double SpinPath::cost(double speed) const {
  const double levels_mixed = transitions != nullptr ? cost::operation * transitions->work() : 0;
  double sum = cost::closed_form * std::max(2, levels) + cost_of(zones, speed) + levels_mixed +
               (way != nullptr ? way->cost() : 0);
  for (const FilteredZones& before : filters) sum += cost::plane + cost_of(before.zones, speed);
  return sum;
}

void share_levels(const SpinPath& path, const RandomKey& key, Isa isa, const BatchView& batch,
                  const std::uint64_t* weights, std::uint64_t* shares) {
  if (!path.filters.empty()) return share_behind_filters(path, key, isa, batch, weights, shares);
  if (!path.of_atom || !path.is_idle())
    return require_followed(kernel::outcomes(isa)(path.view(key), batch, weights, shares));
  std::fill_n(shares, path.levels * batch.padded, 0);
  for (int i = 0; i < batch.count; ++i)
    shares[static_cast<int>(batch.level[i]) * batch.padded + i] = weights[i];
}

}  // namespace rabiline
