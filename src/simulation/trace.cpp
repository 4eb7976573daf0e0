#include "simulation/trace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include <fmt/format.h>

#include "spin/level_labels.hpp"

namespace rabiline {
namespace {

constexpr double points_per_turn = 16, most_points = 2000;  // recorded where a straight flight passes a field

/// Follows one particle through a chain of stages.
class Tracer {
 public:
  Tracer(const Beamline& beamline, const PlanTree& tree, std::uint64_t particle, Isa isa)
      : beamline_(beamline), tree_(tree), kernels_(kernels_for(isa)) {
    track_.particle = particle;
    track_.law = describe(beamline.law);
    track_.species = beamline.species[static_cast<std::size_t>(tree.component)].species.name;
    batch_.view().count = 1;
    batch_.view().padded = 8;
    kernels_.emit(tree.source, particle, batch_.view());
    const Component& component = beamline.species[static_cast<std::size_t>(tree.component)];
    zones_ = zones_along(beamline, component);
    along_ = parts_along(component.species, tree.source.levels);
  }

  Track fly() {
    record_straight(0);
    for (const std::vector<PlanNode>* nodes = &tree_.next; !nodes->empty(); nodes = &nodes->front().next)
      pass(nodes->front());
    return std::move(track_);
  }

 private:
  /// m/I of a point moment, m_F/(I + J) of an atom; empty under a vector law.
  static std::vector<double> parts_along(const Species& species, int levels) {
    std::vector<double> parts;
    if (levels == 0) return parts;
    if (!species.structure) {
      for (int level = 0; level < levels; ++level)
        parts.push_back((species.spin.value() - level) / species.spin.value());
      return parts;
    }
    const CoupledSpins spins = coupled_spins(*species.structure);
    for (const LevelLabel& label : level_labels(spins))
      parts.push_back(static_cast<double>(label.twice_m) / (spins.twice_i + spins.twice_j));
    return parts;
  }

  bool flying() const { return batch_.view().flying[0] != 0; }

  void pass(const PlanNode& node) {
    if (!flying() || std::holds_alternative<Histogram>(node.stage)) return;
    show_plane(node.stage);
    Sums sums(sums_needed(node.stage));
    const auto forward = [](void* self, double t, const double* place, const double* velocity,
                            const double* spin) {
      static_cast<Tracer*>(self)->record(t, place, velocity, spin);
    };
    const StepRecorder recorder{forward, this};
    Flight flight{kernels_, tree_.source.key, batch_, sums.data(), &recorder};
    const auto* precession = std::get_if<Precession>(&node.stage);
    if (precession != nullptr) record_straight(precession->zones.back().end);
    if (const auto* deflection = std::get_if<Deflection>(&node.stage))
      deflect(*deflection, flight);
    else if (const auto* steering = std::get_if<Steering>(&node.stage))
      deflect(*steering, flight);
    else
      advance(node.stage, flight);
    if (std::holds_alternative<Alignment>(node.stage) || std::holds_alternative<Filter>(node.stage) ||
        std::holds_alternative<LevelProjection>(node.stage)) {
      spin_at_ = track_.y.back();
      show_plane(node.stage);  // the same place, another spin
    }
    if (precession != nullptr) spin_at_ = precession->zones.back().end;
    if (std::holds_alternative<TurningRegion>(node.stage)) spin_at_ = batch_.view().y;
    if (!flying()) end(node.stage);
  }

  /// The path in a deflecting magnet, in pieces; where it is stepped, the spin follows the field.
  template <class Magnet>
  void deflect(const Magnet& whole, Flight& flight) {
    constexpr int pieces = 32;
    for (int i = 1; i <= pieces && flying(); ++i) {
      Magnet piece = whole;
      piece.begin = batch_.view().y;
      piece.end =
          i == pieces ? whole.end : std::lerp(whole.begin, whole.end, static_cast<double>(i) / pieces);
      advance(piece, flight);
      if constexpr (std::is_same_v<Magnet, Steering>) spin_at_ = piece.end;
      record_at(piece.end);
    }
  }

  /// Straight flights are recorded where they meet something.
  void show_plane(const Stage& stage) {
    if (const auto* passage = std::get_if<Passage>(&stage)) record_straight(passage->aperture.y);
    if (const auto* score = std::get_if<Score>(&stage)) record_straight(score->screen.y);
    if (const auto* census = std::get_if<Census>(&stage)) record_straight(census->face.y);
    if (const auto* drift = std::get_if<Drift>(&stage)) record_straight(drift->y);
    if (const auto* align = std::get_if<Alignment>(&stage)) record_straight(place_of(align->part));
    if (const auto* filter = std::get_if<Filter>(&stage)) record_straight(place_of(filter->part));
    if (const auto* asked = std::get_if<LevelProjection>(&stage)) record_straight(place_of(asked->part));
  }

  double place_of(int part) const { return beamline_.parts[static_cast<std::size_t>(part)].placement.at; }

  void end(const Stage& stage) {
    const auto name = [&](int part) {
      return part < 0 ? std::string("chamber")
                      : beamline_.parts[static_cast<std::size_t>(part)].placement.name;
    };
    if (const auto* passage = std::get_if<Passage>(&stage)) set_fate("stopped", name(passage->part));
    if (const auto* filter = std::get_if<Filter>(&stage)) set_fate("stopped", name(filter->part));
    if (const auto* magnet = std::get_if<Deflection>(&stage)) set_fate("stopped", name(magnet->part));
    if (const auto* magnet = std::get_if<Steering>(&stage)) set_fate("stopped", name(magnet->part));
    if (const auto* score = std::get_if<Score>(&stage))
      set_fate(batch_.view().caught_by[0] != 0 ? "detected" : "stopped", name(score->screen.part));
    if (std::holds_alternative<Exit>(stage)) set_fate("passed", "");
    if (const auto* region = std::get_if<TurningRegion>(&stage)) {
      const std::uint64_t code = batch_.view().scratch[0] & 0xffffffffULL;
      if (code == region_end::backwards) return set_fate("left_backwards", "");
      if (code == region_end::gave_up) return set_fate("gave_up", "");
      if ((code & region_end::caught_at_edge) != 0)
        return set_fate("detected", name(region->edges[code & 0xffff].screen.part));
      if ((code & region_end::stopped_at_edge) != 0)
        return set_fate("stopped", name(region->edges[code & 0xffff].part));
      set_fate("stopped", name(region->zones[code - region_end::wall_of_zone].wall_part));
    }
  }
  void set_fate(const char* fate, const std::string& where) {
    track_.fate = fate;
    track_.where = where;
  }

  /// A straight flight up to a plane, with the turning of the spin on the way.
  void record_straight(double y) {
    const double last = track_.y.empty() ? y : track_.y.back();
    for (const SpinZone& zone : zones_) {
      const double begin = std::max(zone.begin, last), end = std::min(zone.end, y);
      if (begin >= end) continue;
      double rate = std::abs(zone.spin_rate);
      for (int i = 0; i < zone.drives; ++i) rate += std::abs(zone.drive[i].spin_rate);
      const double turns = rate * (end - begin) / batch_.view().vy[0] / (2 * std::numbers::pi);
      const double points = std::clamp(std::ceil(points_per_turn * turns), 1.0, most_points);
      for (double i = 0; i < points; ++i) record_at(std::lerp(begin, end, i / points));
    }
    record_at(y);
  }
  void record_at(double y) {
    const BatchView& b = batch_.view();
    const double dt = (y - b.y) / b.vy[0];
    const double place[3] = {std::fma(b.vx[0], dt, b.x[0]), y, std::fma(b.vz[0], dt, b.z[0])};
    const double velocity[3] = {b.vx[0], b.vy[0], b.vz[0]};
    Batch there;
    there.copy_from(batch_);
    there.view().flying[0] = ~std::uint64_t{0};
    std::vector<SpinZone> passed;
    for (SpinZone zone : zones_) {
      zone.begin = std::max(zone.begin, spin_at_);
      zone.end = std::min(zone.end, y);
      if (zone.begin < zone.end) passed.push_back(zone);
    }
    kernels_.precess(passed.data(), static_cast<int>(passed.size()), tree_.source.key, there.view());
    const double spin[3] = {there.view().sx[0], there.view().sy[0], there.view().sz[0]};
    record(b.t[0] + dt, place, velocity, spin);
  }
  /// `spin` is the vector itself, or under `quantum` the image of the axis that the level m belongs to.
  void record(double t, const double* place, const double* velocity, const double* spin) {
    const double part = along_.empty() ? 1 : along_[batch_.view().level[0]];
    const double sx = part * spin[0], sy = part * spin[1], sz = part * spin[2];
    if (!track_.t.empty() && track_.t.back() == t && track_.y.back() == place[1] && track_.sx.back() == sx &&
        track_.sy.back() == sy && track_.sz.back() == sz)
      return;
    track_.t.push_back(t);
    track_.x.push_back(place[0]);
    track_.y.push_back(place[1]);
    track_.z.push_back(place[2]);
    track_.vx.push_back(velocity[0]);
    track_.vy.push_back(velocity[1]);
    track_.vz.push_back(velocity[2]);
    track_.sx.push_back(sx);
    track_.sy.push_back(sy);
    track_.sz.push_back(sz);
  }

  const Beamline& beamline_;
  const PlanTree& tree_;
  const Kernels& kernels_;
  Batch batch_;
  std::vector<SpinZone> zones_;  // along the whole beam
  std::vector<double> along_;    // of each level, what its spin has along z or the image of z
  double spin_at_ = 0;           // [m] where the batch's spin is the particle's
  Track track_;
};

}  // namespace

Track trace(const Beamline& beamline, std::uint64_t particle, Isa isa) {
  // A track follows one branch.
  Beamline sampled = beamline;
  if (auto* quantum = std::get_if<QuantumLaw>(&sampled.law)) quantum->outcomes = Outcomes::sample;
  Experiment experiment;
  experiment.points = {std::move(sampled)};
  const Plan plan = make_plan(experiment);
  for (const PlanTree& tree : plan.trees)
    if (particle >= tree.first && particle < tree.last) return Tracer(beamline, tree, particle, isa).fly();
  throw std::out_of_range(
      fmt::format("there is no particle {}: the run has {}, counted from 0", particle, beamline.particles));
}

}  // namespace rabiline
