#include "simulation/trace.hpp"

#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

namespace rabiline {
namespace {

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

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
    spin_known_ = tree.source.levels == 0;
  }

  Track fly() {
    look_ahead(tree_.next);
    record_straight(0);
    for (const std::vector<PlanNode>* nodes = &tree_.next; !nodes->empty(); nodes = &nodes->front().next)
      pass(nodes->front());
    return std::move(track_);
  }

 private:
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
    advance(node.stage, flight);
    if (std::holds_alternative<Alignment>(node.stage)) {
      look_ahead(node.next);
      show_plane(node.stage);  // the same place, another spin
    }
    if (!flying()) end(node.stage);
  }

  /// Finds where the fields of a straight flight begin, up to the next alignment: what they do to the spin is
  /// worked out at the detector only, so from there on it is not known here.
  void look_ahead(const std::vector<PlanNode>& from) {
    spin_known_until_ = std::numeric_limits<double>::infinity();
    for (const std::vector<PlanNode>* nodes = &from; !nodes->empty(); nodes = &nodes->front().next) {
      if (std::holds_alternative<Alignment>(nodes->front().stage)) return;
      const auto* stretch = std::get_if<SpinStretch>(&nodes->front().stage);
      if (stretch == nullptr || stretch->zones.empty()) continue;
      spin_known_until_ = stretch->zones.front().begin;
      return;
    }
  }

  /// Straight flights are recorded where they meet something.
  void show_plane(const Stage& stage) {
    if (const auto* passage = std::get_if<Passage>(&stage)) record_straight(passage->aperture.y);
    if (const auto* score = std::get_if<Score>(&stage)) record_straight(score->screen.y);
    if (const auto* census = std::get_if<Census>(&stage)) record_straight(census->face.y);
    if (const auto* drift = std::get_if<Drift>(&stage)) record_straight(drift->y);
    if (const auto* align = std::get_if<Alignment>(&stage))
      record_straight(beamline_.parts[static_cast<std::size_t>(align->part)].placement.at);
  }

  void end(const Stage& stage) {
    const auto name = [&](int part) {
      return part < 0 ? std::string("chamber")
                      : beamline_.parts[static_cast<std::size_t>(part)].placement.name;
    };
    if (const auto* passage = std::get_if<Passage>(&stage)) set_fate("stopped", name(passage->part));
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

  void record_straight(double y) {
    const BatchView& b = batch_.view();
    const double dt = (y - b.y) / b.vy[0];
    const double place[3] = {std::fma(b.vx[0], dt, b.x[0]), y, std::fma(b.vz[0], dt, b.z[0])};
    const double velocity[3] = {b.vx[0], b.vy[0], b.vz[0]}, spin[3] = {b.sx[0], b.sy[0], b.sz[0]};
    record(b.t[0] + dt, place, velocity, spin);
  }
  void record(double t, const double* place, const double* velocity, const double* spin) {
    if (!track_.t.empty() && track_.t.back() == t && track_.y.back() == place[1] && is_last_spin(spin))
      return;
    track_.t.push_back(t);
    track_.x.push_back(place[0]);
    track_.y.push_back(place[1]);
    track_.z.push_back(place[2]);
    track_.vx.push_back(velocity[0]);
    track_.vy.push_back(velocity[1]);
    track_.vz.push_back(velocity[2]);
    const bool known = spin_known_ && place[1] <= spin_known_until_;
    track_.sx.push_back(known ? spin[0] : not_known);
    track_.sy.push_back(known ? spin[1] : not_known);
    track_.sz.push_back(known ? spin[2] : not_known);
  }

  bool is_last_spin(const double* spin) const {
    return !spin_known_ ||
           (track_.sx.back() == spin[0] && track_.sy.back() == spin[1] && track_.sz.back() == spin[2]);
  }

  const Beamline& beamline_;
  const PlanTree& tree_;
  const Kernels& kernels_;
  Batch batch_;
  bool spin_known_ = false;
  double spin_known_until_ = 0;  // [m] place along the beam
  Track track_;
};

}  // namespace

Track trace(const Beamline& beamline, std::uint64_t particle, Isa isa) {
  Experiment experiment;
  experiment.points = {beamline};
  const Plan plan = make_plan(experiment);
  for (const PlanTree& tree : plan.trees)
    if (particle >= tree.first && particle < tree.last) return Tracer(beamline, tree, particle, isa).fly();
  throw std::out_of_range(
      fmt::format("there is no particle {}: the run has {}, counted from 0", particle, beamline.particles));
}

}  // namespace rabiline
