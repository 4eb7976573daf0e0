#include "models/motion.hpp"

#include <algorithm>
#include <limits>

namespace rabiline {

std::vector<FoundAtPoints> findings_of(const std::vector<ModelResult>& points) {
  std::vector<FoundAtPoints> out;
  const std::vector<double> none(points.size(), std::numeric_limits<double>::quiet_NaN());
  for (std::size_t i = 0; i < points.size(); ++i)
    for (const Finding& f : points[i].findings) {
      auto known =
          std::find_if(out.begin(), out.end(), [&](const FoundAtPoints& row) { return row.name == f.name; });
      if (known == out.end())
        known = out.insert(out.end(), {f.name, f.unit, f.meaning, f.expectation, none, none});
      known->expectation = std::max(known->expectation, f.expectation);
      known->values[i] = f.value;
      known->expected[i] = f.expected;
    }
  return out;
}

}  // namespace rabiline
