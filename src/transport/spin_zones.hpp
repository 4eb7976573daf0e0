#pragma once
// The fields on a straight way, as spins see them.
#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "transport/kernels.hpp"

namespace rabiline {

/// Zones one behind the other. They are kilobytes, stand in the paths of many scan points and do not change,
/// so that copies share them.
class SpinZones {
 public:
  SpinZones() = default;
  SpinZones(std::vector<SpinZone> zones)
      : zones_(zones.empty() ? nullptr : std::make_shared<const std::vector<SpinZone>>(std::move(zones))) {}

  std::size_t size() const { return zones_ ? zones_->size() : 0; }
  bool empty() const { return !zones_; }
  const SpinZone* data() const { return zones_ ? zones_->data() : nullptr; }
  const SpinZone* begin() const { return data(); }
  const SpinZone* end() const { return data() + size(); }
  const SpinZone& front() const { return zones_->front(); }
  const SpinZone& back() const { return zones_->back(); }
  bool operator==(const SpinZones& other) const {
    return zones_ == other.zones_ || std::equal(begin(), end(), other.begin(), other.end());
  }

 private:
  std::shared_ptr<const std::vector<SpinZone>> zones_;  // null: none
};

}  // namespace rabiline
