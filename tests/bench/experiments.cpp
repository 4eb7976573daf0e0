#include "bench/experiments.hpp"

#include <cmath>

#include "physics/suggested.hpp"

namespace rabiline::bench {
namespace {

constexpr double field = 10e-3;
const double larmor = std::abs(test::neutron().gyromagnetic_ratio) * field / (2 * std::numbers::pi);

/// All stages of a plan, depth first.
void list_stages(const std::vector<PlanNode>& nodes, std::vector<const Stage*>& stages) {
  for (const PlanNode& node : nodes) {
    stages.push_back(&node.stage);
    list_stages(node.next, stages);
  }
}
template <class T>
std::vector<const T*> stages_of(const Plan& plan) {
  std::vector<const Stage*> all;
  for (const PlanTree& tree : plan.trees) list_stages(tree.next, all);
  std::vector<const T*> chosen;
  for (const Stage* stage : all)
    if (const T* t = std::get_if<T>(stage)) chosen.push_back(t);
  return chosen;
}

Experiment scan(const Beamline& beamline, int points, double range) {
  Experiment experiment;
  for (int i = 0; i < points; ++i) {
    experiment.points.push_back(beamline);
    for (PlacedPart& placed : experiment.points.back().parts)
      if (auto* rotating = std::get_if<RotatingField>(&placed.part))
        rotating->frequency = larmor + range * (i - points / 2) / points;
  }
  return experiment;
}

}  // namespace

Experiment two_level_beamline(int points, std::uint64_t particles, bool polarised) {
  Beamline b = test::suggested(larmor, 40e-6);
  b.law = QuantumLaw{};
  b.source.speed = GaussianSpeed{1000, 100};
  b.source.opening = Rectangle{1e-3, 2e-3};
  b.chamber.reset();
  b.particles = particles;
  std::vector<PlacedPart> parts{test::place("first", 0.10, Slit{Rectangle{0.8e-3, 2e-3}, {}})};
  parts.insert(parts.end(), b.parts.begin() + (polarised ? 0 : 1), b.parts.end());
  parts.insert(parts.end() - 1, test::place("second", 1.0, Slit{Rectangle{0.8e-3, 1.8e-3}, {}}));
  b.parts = parts;
  if (polarised) std::get<Polarizer>(b.parts[1].part).length = 0.05;
  if (polarised) b.parts[1].placement.at = 0.15;
  return scan(b, points, 20e3);
}

Experiment suggested_experiment(int points, std::uint64_t particles) {
  Beamline b = test::suggested(larmor);
  b.particles = particles;
  return scan(b, points, 12e3);
}

std::vector<RabiLine> lines_of(const Plan& plan) {
  std::vector<RabiLine> lines;
  for (const SpinStretch* stretch : stages_of<SpinStretch>(plan)) {
    const SpinZone& zone = stretch->zones.at(0);
    const double w1 = zone.drive[0].spin_rate, rate = std::hypot(w1, zone.spin_rate - zone.drive[0].omega);
    lines.push_back({w1 * w1 / (rate * rate), 0.5 * rate * (zone.end - zone.begin)});
  }
  return lines;
}

const Emission& emission_of(const Plan& plan) { return plan.trees.at(0).source; }

const TurningRegion& region_of(const Plan& plan) { return *stages_of<TurningRegion>(plan).at(0); }

double steps_through(const TurningRegion& region, double speed) {
  double steps = 0;
  for (const RegionZone& zone : region.zones)
    steps += (zone.field.end - zone.field.begin) / speed / zone.step;
  return steps;
}

}  // namespace rabiline::bench
