#include "simulation/part_numbers.hpp"

#include <algorithm>
#include <stdexcept>

namespace rabiline {
namespace {

bool stand_so(const Beamline& beamline, const std::vector<std::string>& names) {
  return std::ranges::equal(beamline.parts, names, {},
                            [](const PlacedPart& part) -> const std::string& { return part.placement.name; });
}

}  // namespace

PartNumbers::PartNumbers(const ScanPoints& points) {
  order_of_.reserve(points.size());
  std::size_t last = 0;
  for (const Beamline& beamline : points) {
    if (orders_.empty() || !stand_so(beamline, orders_[last].names)) {
      const auto same =
          std::ranges::find_if(orders_, [&](const Order& order) { return stand_so(beamline, order.names); });
      last = static_cast<std::size_t>(same - orders_.begin());
      if (same == orders_.end()) {
        Order& order = orders_.emplace_back();
        for (const PlacedPart& part : beamline.parts) {
          order.numbers.emplace(part.placement.name, static_cast<int>(order.names.size()));
          order.names.push_back(part.placement.name);
        }
      }
    }
    order_of_.push_back(last);
  }
}

int PartNumbers::of(const std::string& name, std::size_t point) const {
  const std::map<std::string, int>& numbers = orders_[order_of_[point]].numbers;
  const auto found = numbers.find(name);
  if (found == numbers.end()) throw std::logic_error("a part is missing at a scan point");
  return found->second;
}

}  // namespace rabiline
