// What the plan of the first scan point tells of magnets that stop everything, and of tipped spins that keep
// turning the path.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "plan/explain_atoms.hpp"
#include "plan/explain_magnets.hpp"
#include "plan/level_history.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

/// Walks the stages that the first scan point passes.
class StageWarnings {
 public:
  StageWarnings(const Beamline& beamline, Faults& out) : beamline_(beamline), out_(out) {}

  void walk(const PlanTree& tree) {
    species_ = &beamline_.species[static_cast<std::size_t>(tree.component)].species;
    speed_ = tree.source.speed;
    on_axis_ = levels_on_axis(beamline_.source, *species_, beamline_.law);
    walk(tree.next);
  }

 private:
  void walk(const std::vector<PlanNode>& nodes) {
    for (const PlanNode& node : nodes)
      if (!node.points.empty() && node.points.front() == 0) {
        std::visit([&](const auto& stage) { look_at(stage); }, node.stage);
        walk(node.next);
      }
  }
  template <class Stage>
  void look_at(const Stage&) {}

  void look_at(const Alignment&) { tip_ = 0; }
  void look_at(const LevelProjection&) {
    if (is_quantum(beamline_) && species_->structure && !on_axis_.empty()) on_axis_ = all_levels(*species_);
  }
  const std::string& name_of(int part) const {
    return beamline_.parts[static_cast<std::size_t>(part)].placement.name;
  }
  void look_at(const Deflection& d) { add(text_of(d, name_of(d.part), speed_)); }
  void look_at(const Steering& s) {
    add(text_of(s, name_of(s.part), speed_,
                {on_axis_, 1 / slownesses_of(beamline_.source, species_->mass, 0).from}));
  }
  void add(const MagnetText& text) {
    out_.insert(out_.end(), text.warnings.begin(), text.warnings.end());
    on_axis_.clear();
  }

  /// Under `torque` tipped spins keep turning the path in every field until something aligns them again, and
  /// a large tip deflects nearly everything. `tip_` is what all drives since the last alignment can have
  /// done.
  void look_at(const TurningRegion& region) {
    if (!region.take_off_spin_component) return;
    constexpr double large_tip = 0.05;  // [rad]
    bool is_large = false;
    std::string tipped_by;
    for (std::size_t i = 0; i < region.zones.size(); ++i) {
      const SpinZone& zone = region.zones[i].field;
      const double middle = (zone.begin + zone.end) / 2;
      if (tip_ > 0 && zone.drives == 0 && zone.turn_rate != 0)
        out_.push_back(warning(field_at(middle), "length",
                               fmt::format("behind the rotating field a uniform field goes on to {:.4g} m: "
                                           "under closure torque it keeps turning the path of tipped spins",
                                           zone.end)));
      const bool before = tip_ > large_tip;
      for (int k = 0; k < zone.drives; ++k)
        tip_ += std::abs(zone.drive[k].spin_rate) * (zone.end - zone.begin) / speed_;
      if (tip_ > large_tip && !before) {
        is_large = true;
        tipped_by = field_at(middle);
      }
      if (i < region.edges.size() && region.edges[i].kind == EdgeKind::align) tip_ = 0;
    }
    if (is_large)
      out_.push_back(warning(tipped_by, "amplitude",
                             fmt::format("the tip angle on resonance, {:.3g} deg, is large: under closure "
                                         "torque nearly all frequencies then deflect, and the resonance is "
                                         "far wider than 1/T",
                                         tip_ * 180 / std::numbers::pi)));
  }
  /// The last field that covers a place.
  std::string field_at(double y) const {
    std::string name;
    for (const PlacedPart& part : beamline_.parts)
      if (traits_of(part.part).field && part.placement.at <= y && y < end_of(part))
        name = part.placement.name;
    return name;
  }

  const Beamline& beamline_;
  Faults& out_;
  const Species* species_ = nullptr;
  double speed_ = 0, tip_ = 0;
  std::vector<int> on_axis_;  // levels of a beam that nothing has bent yet
};

}  // namespace

Faults warnings_of_stages(const Experiment& experiment, const Plan& plan) {
  Faults out;
  std::vector<int> seen;
  for (const PlanTree& tree : plan.trees) {
    if (tree.points.empty() || tree.points.front() != 0) continue;
    if (std::find(seen.begin(), seen.end(), tree.component) != seen.end()) continue;
    seen.push_back(tree.component);
    StageWarnings(experiment.points.front(), out).walk(tree);
  }
  return out;
}

}  // namespace rabiline
