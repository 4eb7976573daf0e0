#pragma once
// Which number a part has at each scan point.
#include <map>
#include <string>
#include <vector>

#include "beamline/experiment.hpp"

namespace rabiline {

/// A scan over `at` may change the order of the parts, and one over `enabled` leaves some out. All points are
/// asked once, and share the few orders that there are.
class PartNumbers {
 public:
  explicit PartNumbers(const ScanPoints&);
  /// Throws std::logic_error where the part is missing.
  int of(const std::string& name, std::size_t point) const;
  const std::string& name(int number, std::size_t point) const {
    return orders_[order_of_[point]].names[static_cast<std::size_t>(number)];
  }

 private:
  struct Order {
    std::vector<std::string> names;
    std::map<std::string, int> numbers;
  };
  std::vector<Order> orders_;
  std::vector<std::size_t> order_of_;  // [points]
};

}  // namespace rabiline
