#pragma once
// What the stages have in common that stop weight in one plane and count how much.
#include "transport/cost.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

struct PlaneStage {
  int part = 0;
  double at = 0;  // [m]
  bool operator==(const PlaneStage&) const = default;

  static constexpr StageTraits traits{.ends_particles = true};
  std::size_t sums() const { return 1; }
  double y() const { return at; }
  double cost(double /*speed*/) const { return cost::plane; }
};

}  // namespace rabiline
