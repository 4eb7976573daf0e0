#include "simulation/trace.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include "particle/fate.hpp"
#include "spin/level_labels.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

constexpr double points_per_turn = 16, fewest_points = 8,
                 most_points = 2000;  // recorded where a straight flight passes a field

/// Which fate a stage has counted: of one particle it is one.
class CountedFate : public SumSink {
 public:
  explicit CountedFate(const Sums& sums) : sums_(sums) {}
  void fate(std::string_view word, int part, std::size_t at) override {
    const bool better = word == fate::detected || fate_.empty();
    if (!better || sums_[at] == 0) return;
    fate_ = word;
    part_ = part;
  }
  std::string_view word() const { return fate_; }
  int part() const { return part_; }

 private:
  const Sums& sums_;
  std::string_view fate_;
  int part_ = no_part;
};

/// Follows one particle through a chain of stages.
class Tracer {
 public:
  Tracer(const Beamline& beamline, const PlanTree& tree, std::uint64_t particle, Isa isa)
      : beamline_(beamline), tree_(tree), isa_(isa) {
    track_.particle = particle;
    track_.law = describe(beamline.law);
    track_.species = beamline.species[static_cast<std::size_t>(tree.component)].species.name;
    batch_.view().count = 1;
    batch_.view().padded = 8;
    kernel::emit(isa_)(tree.source, particle, batch_.view());
    emitted_ = static_cast<double>(batch_.view().weight[0]);
    const Component& component = beamline.species[static_cast<std::size_t>(tree.component)];
    zones_ = zones_along(beamline, component);
    along_ = parts_along(component.species, tree.source.spin.levels);
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
  /// Whether a stage has ended the path, or left it to the next one to do so.
  template <class S>
  static bool has_ended(const S& stage, const Batch& batch) {
    if constexpr (requires { stage.marks_walls(); })
      if (stage.marks_walls() && batch.view().scratch[0] != 0) return true;
    return batch.view().flying[0] == 0;
  }
  /// Where a stage ends the path of a particle between two places, if it does; `up_to(y)`: that stage up to
  /// there.
  template <class UpTo>
  std::optional<double> place_of_end(double begin, double end, const UpTo& up_to) {
    Batch there;
    const auto ends_before = [&](double y) {
      there.copy_from(batch_);
      const auto stage = up_to(y);
      Sums sums(stage.sums());
      StageContext context{isa_, tree_.source.key, there, sums.data()};
      stage.pass(context);
      return has_ended(stage, there);
    };
    if (!(begin < end) || !ends_before(end)) return std::nullopt;
    for (double middle = std::midpoint(begin, end); begin < middle && middle < end;
         middle = std::midpoint(begin, end))
      (ends_before(middle) ? end : begin) = middle;
    return end;
  }
  /// Where a straight flight to a stage, or along it, ends.
  template <class S>
  double end_of_flight(const S& stage) {
    if constexpr (requires { stage.until(0.0); })
      if (const auto wall = place_of_end(stage.from(), stage.to(), [&](double y) { return stage.until(y); }))
        return *wall;
    return stage.y();
  }

  void pass(const PlanNode& node) {
    if (!flying()) return;
    const StageTraits& traits = traits_of(node.stage);
    const double y = std::visit([&](const auto& stage) { return end_of_flight(stage); }, node.stage);
    if (y < behind_everything && !at_wall_) record_straight(y);
    if (traits.only_reads) return;
    Sums sums(sums_needed(node.stage));
    const auto forward = [](void* self, double t, const double* place, const double* velocity,
                            const double* spin) {
      static_cast<Tracer*>(self)->record(t, place, velocity, spin);
    };
    const StepRecorder recorder{forward, this};
    recorded_at_.reset();
    StageContext context{isa_, tree_.source.key, batch_, sums.data(), &recorder};
    std::visit([&](const auto& stage) { fly_through(stage, traits, context); }, node.stage);
    at_wall_ = std::visit([&](const auto& stage) { return has_ended(stage, batch_); }, node.stage);
    if (traits.spins == SpinEffect::set) {
      spin_at_ = y;
      record_straight(y);  // the same place, another spin
    }
    if (!flying()) end(node.stage, sums);
  }

  template <class S>
  void fly_through(const S& stage, const StageTraits& traits, StageContext& context) {
    if constexpr (requires { stage.piece(0.0, 0.0); }) {
      constexpr int pieces = 32;
      for (int i = 1; i <= pieces && !has_ended(stage, batch_); ++i)
        fly_piece(
            stage.piece(batch_.view().y,
                        i == pieces ? stage.end : std::lerp(stage.begin, stage.end, i * (1.0 / pieces))),
            traits, context);
    } else {
      stage.pass(context);
      if (traits.spins == SpinEffect::carried) spin_at_ = std::max(stage.y(), batch_.view().y);
    }
  }
  /// The path where a stage bends it, in pieces, the last one up to a wall.
  template <class S>
  void fly_piece(const S& whole, const StageTraits& traits, StageContext& context) {
    const auto wall =
        place_of_end(whole.begin, whole.end, [&](double y) { return whole.piece(whole.begin, y); });
    const S piece = wall ? whole.piece(whole.begin, *wall) : whole;
    piece.pass(context);
    recorded_at_.reset();
    if (traits.spins == SpinEffect::carried) spin_at_ = piece.end;
    record_at(piece.end);
  }

  void end(const Stage& stage, const Sums& sums) {
    CountedFate counted(sums);
    list_sums(stage, counted);
    track_.fate = counted.word();
    if (counted.part() == no_part) return;
    track_.where = counted.part() < 0
                       ? std::string("chamber")
                       : beamline_.parts[static_cast<std::size_t>(counted.part())].placement.name;
  }

  /// A straight flight up to a plane, or a parabola under gravity across the beam, with the turning of the
  /// spin on the way.
  void record_straight(double y) {
    const double last = track_.y.empty() ? y : track_.y.back();
    if (y < last) return;  // a wall farther on has been asked for before
    std::vector<double> places;
    if (beamline_.gravity && beamline_.gravity->direction.y == 0 && last < y)
      for (double i = 0; i <= fewest_points; ++i) places.push_back(std::lerp(last, y, i / fewest_points));
    for (const SpinZone& zone : zones_) {
      const double begin = std::max(zone.begin, last), end = std::min(zone.end, y);
      if (begin >= end) continue;
      double rate = std::abs(zone.spin_rate);
      for (int i = 0; i < zone.drives; ++i) rate += std::abs(zone.drive[i].spin_rate);
      const double turns = rate * (end - begin) / batch_.view().vy[0] / (2 * std::numbers::pi);
      const double points = std::clamp(std::ceil(points_per_turn * turns), fewest_points, most_points);
      for (double i = 0; i <= points; ++i) places.push_back(std::lerp(begin, end, i / points));
    }
    std::ranges::sort(places);
    for (const double place : places) record_at(place);
    record_at(y);
  }
  /// Turns the spin of the recorded batch from where it is on to y.
  void turn_recorded_to(double y) {
    if (!recorded_at_ || y < *recorded_at_) {
      recorded_.copy_from(batch_);
      recorded_.view().flying[0] = ~std::uint64_t{0};
      recorded_at_ = spin_at_;
    }
    std::vector<SpinZone> passed;
    for (SpinZone zone : zones_) {
      zone.begin = std::max(zone.begin, *recorded_at_);
      zone.end = std::min(zone.end, y);
      if (zone.begin < zone.end) passed.push_back(zone);
    }
    kernel::precess(isa_)(passed.data(), static_cast<int>(passed.size()), tree_.source.key, recorded_.view());
    recorded_at_ = std::max(*recorded_at_, y);
  }
  void record_at(double y) {
    turn_recorded_to(y);
    Batch there;
    there.copy_from(recorded_);
    kernel::drift(isa_)(y, there.view());
    const BatchView& b = there.view();
    const double place[3] = {b.x[0], y, b.z[0]}, velocity[3] = {b.vx[0], b.vy[0], b.vz[0]},
                 spin[3] = {b.sx[0], b.sy[0], b.sz[0]};
    record(b.t[0], place, velocity, spin);
  }
  /// `spin` is the vector itself, or under `quantum` the image of the axis that the level m belongs to.
  void record(double t, const double* place, const double* velocity, const double* spin) {
    const double part = along_.empty() ? 1 : along_[batch_.view().level[0]];
    const double sx = part * spin[0], sy = part * spin[1], sz = part * spin[2];
    const double weight = emitted_ > 0 ? static_cast<double>(batch_.view().weight[0]) / emitted_ : 0;
    if (!track_.t.empty() && track_.t.back() == t && track_.y.back() == place[1] && track_.sx.back() == sx &&
        track_.sy.back() == sy && track_.sz.back() == sz && track_.weight.back() == weight)
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
    track_.weight.push_back(weight);
  }

  const Beamline& beamline_;
  const PlanTree& tree_;
  const Isa isa_;
  Batch batch_;
  std::vector<SpinZone> zones_;  // along the whole beam
  double emitted_ = 0;           // its first weight [quanta]
  std::vector<double> along_;    // of each level, what its spin has along z or the image of z
  double spin_at_ = 0;           // [m] where the batch's spin is the particle's
  Batch recorded_;               // the batch with its spin further on, for places along a straight flight
  std::optional<double> recorded_at_;  // [m] where; empty where the batch is another one since
  bool at_wall_ = false;               // where the track ends
  Track track_;
};

}  // namespace

Plan plan_of_tracks(Beamline beamline) {
  Experiment experiment;
  beamline.law = without_splitting(beamline.law);
  experiment.points = {std::move(beamline)};
  return make_plan(experiment);
}

Track trace(const Beamline& beamline, const Plan& plan, std::uint64_t particle, Isa isa) {
  for (const PlanTree& tree : plan.trees)
    if (particle >= tree.first && particle < tree.last) return Tracer(beamline, tree, particle, isa).fly();
  throw std::out_of_range(
      fmt::format("there is no particle {}: the run has {}, counted from 0", particle, beamline.particles));
}

}  // namespace rabiline
