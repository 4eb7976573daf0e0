#pragma once
// The suggested experiment under standard physics, and what points of it are warned of.
#include <vector>

#include "physics/suggested.hpp"
#include "rules/warnings.hpp"

namespace rabiline::test {

inline std::vector<Fault> warned(std::vector<Beamline> points) {
  Experiment e;
  e.points = std::move(points);
  return warnings_of(e, make_plan(e));
}
inline Beamline standard() {
  Beamline b = suggested(291.6e3);
  b.law = QuantumLaw{};
  return b;
}

}  // namespace rabiline::test
