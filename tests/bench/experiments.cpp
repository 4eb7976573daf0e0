#include "bench/experiments.hpp"

#include <fmt/format.h>

#include <cmath>

#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"

#include "physics/suggested.hpp"
#include "scan/experiment.hpp"

namespace rabiline::bench {
namespace {

constexpr double field = 10e-3;
const double larmor = std::abs(test::neutron().gyromagnetic_ratio) * field / (2 * std::numbers::pi);

/// All stages of a plan, depth first.
void list_stages(const std::vector<PlanNode>& nodes, std::vector<const Stage*>& stages) {
  for (const PlanNode& node : nodes) {
    if (node.reweightings.empty()) stages.push_back(&node.stage);
    for (const PlanNode::Reweighting& one : node.reweightings) stages.push_back(&one.stage);
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
    Beamline point = beamline;
    for (PlacedPart& placed : point.parts)
      if (auto* rotating = std::get_if<RotatingField>(&placed.part))
        rotating->frequency = larmor + range * (i - points / 2) / points;
    experiment.points.push_back(std::move(point));
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

Experiment rabis_apparatus(int points, std::uint64_t particles, int twice_spin, Bins bins) {
  Beamline b = test::suggested(larmor);
  b.law = QuantumLaw{};
  // LiCl at 850 K with the moment of Li-7, whatever its spin here.
  constexpr double gamma = 2 * std::numbers::pi * 16.54828e6;
  b.species = {{{"LiCl", 42.4 * 1.66053906892e-27, 0, {twice_spin}, gamma, ""}, 1}};
  b.source = {EffusiveSpeed{850}, Rectangle{2e-3, 20e-6}, BoxDirection{0.5e-3, 30e-6}};
  b.chamber.reset();
  b.particles = particles;
  GradientMagnet a;
  a.length = 0.52;
  a.field = 1;
  a.gradient = 300;
  a.gap = Rectangle{4e-3, 1e-3};
  GradientMagnet undo = a;
  undo.length = 0.58;
  undo.gradient = -813.457;
  RotatingField drive;
  drive.length = 0.04;
  drive.amplitude = 0.525e-3;
  drive.sense = Sense::co;
  b.parts = {test::place("first", 0.05, Slit{Rectangle{4e-3, 30e-6}, {}}),
             test::place("A", 0.10, a),
             test::place("second", 0.65, Slit{Rectangle{4e-3, 60e-6}, {}}),
             test::place("C", 0.68, UniformField{0.16, 0.2126, {}}),
             test::place("RF", 0.74, drive),
             test::place("B", 0.90, undo),
             test::place("wire", 1.60, Detector{Rectangle{10e-3, 80e-6}, bins, {}})};
  Experiment experiment;
  for (int i = 0; i < points; ++i) {
    Beamline point = b;
    std::get<RotatingField>(point.parts[4].part).frequency = 3.518e6 + 100e3 * (i - points / 2) / points;
    experiment.points.push_back(std::move(point));
  }
  return experiment;
}

Experiment suggested_experiment(int points, std::uint64_t particles) {
  // A large tip and a weak kappa are flown by steps that follow every turn, on a path that is nearly
  // straight.
  Beamline b = test::suggested(larmor, 85.73e-6);
  b.law = DoradoLaw{Closure::torque, 1e-3};
  b.particles = particles;
  return scan(b, points, 12e3);
}

namespace {

/// The suggested beam with spins along the field B, which `drive` follows instead of H0.
Beamline polarised(Law law, SpeedLaw speed, std::uint64_t particles, Part drive) {
  Beamline b = test::suggested(larmor);
  b.law = law;
  b.source.speed = speed;
  b.source.spin = PolarisedSpin{{0, 0, 1}, 1};
  b.chamber.reset();
  b.particles = particles;
  b.parts = {b.parts.at(1), test::place("drive", 0.35, std::move(drive)), b.parts.at(3)};
  return b;
}
Experiment of_one(const Beamline& b) {
  Experiment experiment;
  experiment.points = {b};
  return experiment;
}

}  // namespace

Experiment profiled_field(std::uint64_t particles) {
  RotatingField h0 = std::get<RotatingField>(test::suggested(larmor).parts.at(2).part);
  h0.amplitude = 3e-3;
  h0.profile = HalfSineProfile{};
  Beamline b = polarised(ClassicalLaw{}, SingleSpeed{1000}, particles, h0);
  SpinFilter filter;
  filter.up = 1;
  filter.down = 0;
  b.parts.insert(b.parts.end() - 1, test::place("A", 0.6, filter));
  return of_one(b);
}

Experiment oscillating_field(std::uint64_t particles) {
  OscillatingField rf;
  rf.length = 0.2;
  rf.amplitude = 0.3e-3;
  rf.frequency = 1.001 * larmor;
  rf.approximation = Approximation::none;
  rf.phase = {Phase::Kind::random, 0};
  return of_one(polarised(QuantumLaw{}, GaussianSpeed{1000, 100}, particles, rf));
}

const SpinZone& zone_of(const Plan& plan, ZoneKind kind) {
  for (const SpinStretch* stretch : stages_of<SpinStretch>(plan))
    for (const SpinZone& zone : stretch->spins.zones)
      if (zone.kind == kind) return zone;
  for (const Precession* stage : stages_of<Precession>(plan))
    for (const SpinZone& zone : stage->zones)
      if (zone.kind == kind) return zone;
  throw std::logic_error("no such zone");
}

MagnetShape two_wires() {
  MagnetShape shape;
  shape.kind = MagnetKind::two_wire;
  shape.field = 12e-3;
  shape.half_distance = 5e-3;
  shape.height = 6e-3;
  return shape;
}

Experiment clock(int points, std::uint64_t particles) {
  Changes changes;
  changes.particles = fmt::format("{}", particles);
  changes.scan = {fmt::format("first.frequency=9192631271.5 Hz:9192632271.5 Hz:{}", points)};
  return load_experiment(load_file(RABILINE_BEAMLINES "/caesium-clock.yaml"), changes).experiment;
}

std::vector<RabiLine> lines_of(const Plan& plan) {
  std::vector<RabiLine> lines;
  for (const SpinStretch* stretch : stages_of<SpinStretch>(plan)) {
    const SpinZone& zone = stretch->spins.zones.front();
    const double w1 = zone.drive[0].spin_rate, rate = std::hypot(w1, zone.spin_rate - zone.drive[0].omega);
    lines.push_back({w1 * w1 / (rate * rate), 0.5 * rate * (zone.end - zone.begin)});
  }
  return lines;
}

FieldMap map_of_64() {
  constexpr int n = 64;
  const LoopShape ring{6e-3, 1e-3};
  MapNodes nodes{{3, MapAxis{n, 0, 0.016 / (n - 1)}}, {}};
  nodes.axes[0].begin = nodes.axes[1].begin = -8e-3;
  nodes.axes[2].begin = 5e-3;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k) {
        const FieldHere<double> here = field_of<HostMaths>(ring, nodes.axes[0].begin + i * nodes.axes[0].step,
                                                           nodes.axes[1].begin + j * nodes.axes[1].step,
                                                           nodes.axes[2].begin + k * nodes.axes[2].step);
        nodes.field.insert(nodes.field.end(), here.field, here.field + 3);
      }
  return {std::move(nodes), {}, "a ring"};
}

const Emission& emission_of(const Plan& plan) { return plan.trees.at(0).source; }

const TurningRegion& region_of(const Plan& plan) { return *stages_of<TurningRegion>(plan).at(0); }

double steps_through(const TurningRegion& region, double speed) {
  double steps = 0;
  for (const RegionZone& zone : region.zones)
    if (zone.course == ZoneCourse::steps) steps += (zone.field.end - zone.field.begin) / speed / zone.step;
  return steps;
}

}  // namespace rabiline::bench
