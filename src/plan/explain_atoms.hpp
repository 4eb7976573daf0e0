#pragma once
// What a plan does to the levels of atoms, in words.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "beamline/experiment.hpp"
#include "core/fault.hpp"
#include "plan/plan.hpp"

namespace rabiline {

/// "Cs-133 atom: I = 7/2, J = 1/2, 16 levels, F=4 above F=3 by 9192.6318 MHz".
std::string headline_of(const Species& atom);

/// What drives levels before each part that asks for them, at each scan point.
class DrivenParts {
 public:
  DrivenParts(const Experiment&, const Plan&);

  /// The fields that drive transitions of a component of the beam before a part of the first scan point, and
  /// how well they are known; a line each, without indentation. At the first, the middle and the last scan
  /// point.
  std::vector<std::string> lines(int component, int part, double speed) const;
  /// Fields that drive nothing at any point; tables that are not as exact as they should be.
  std::vector<Fault> warnings();

 private:
  /// The zones that drive levels before a part, those of a way with the field where a line is nearest.
  struct Driven {
    Structure structure{};
    std::vector<LevelZone> zones{};
    std::vector<std::string> names{};  // [zone] of the fields that drive there
    double neglected = 0, largest_slowness = 0;
    bool on_way = false;
  };
  const Driven* driven_of(const SpinPath&, const Beamline&, const Species& atom);
  void collect(int component, const std::vector<PlanNode>&);
  void collect(int component, const Stage&, const std::vector<int>& points);
  void add_zone(std::size_t number, const std::vector<const Driven*>& at, double speed,
                std::vector<std::string>& out) const;
  const Beamline& beamline_at(int point);
  double speed_at(std::size_t point, int component);

  const Experiment& experiment_;
  const Plan& plan_;
  std::map<const void*, Driven> driven_;  // by the transitions or the way that a path has
  /// Of a component before a part, by name: [points], null where nothing drives them.
  std::map<std::pair<int, std::string>, std::vector<const Driven*>> parts_;
  Beamline beamline_{};  // of the scan point that was asked for last
  int in_hand_ = -1;
};

/// Where no field is between two that are, and an atom's levels keep their labels; empty where there is none.
std::string field_free_gaps(const Beamline&);

std::vector<int> all_levels(const Species&);
/// The levels that a source prepares, where its beam begins on the axis and along it; else none. None under
/// a vector law.
std::vector<int> levels_on_axis(const Source&, const Species&, const Law&);

/// What a run should say of atoms before it begins.
std::vector<Fault> warnings_of_atoms(const Experiment&, const Plan&);

}  // namespace rabiline
