#pragma once
// What drives the levels of atoms before the parts that ask for them, at each scan point.
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "beamline/experiment.hpp"
#include "plan/level_lines.hpp"
#include "plan/plan.hpp"
#include "transport/mean_flight.hpp"

namespace rabiline {

/// What drives levels before each part that asks for them, at each scan point.
class DrivenParts {
 public:
  /// The zones that drive levels before a part, those of a way with the field where a line is nearest.
  struct Driven {
    Structure structure{};
    std::vector<DrivenZone> zones{};
    std::vector<std::string> names{};      // [zone] of the fields that drive there
    std::vector<double> lengths{};         // [m] [zone] of all of its field
    std::set<std::string> approximated{};  // the names of those in the rotating-wave approximation
    double neglected = 0, largest_slowness = 0;
    bool on_way = false, beside_whole_fields = false;  // those in the approximation
  };
  DrivenParts(const Experiment&, const Plan&);

  /// Of a component before a part, by name: [points], null where nothing drives them.
  using Parts = std::map<std::pair<int, std::string>, std::vector<const Driven*>>;
  const Parts& each() const { return parts_; }
  /// Of a component at a scan point.
  MeanFlight flight_at(std::size_t point, int component);

  /// The fields that drive transitions of a component of the beam before a part of the first scan point, and
  /// how well they are known; a line each, without indentation. At the first, the middle and the last scan
  /// point, where they have an amplitude.
  std::vector<std::string> lines(int component, int part, const MeanFlight&) const;

 private:
  const Driven* driven_of(const SpinPath&, const Beamline&, const Species& atom);
  void collect(int component, const std::vector<PlanNode>&);
  void collect(int component, const Stage&, const std::vector<int>& points);
  static std::optional<std::size_t> zone_called(const Driven& at, const Driven& most, std::size_t number);
  void add_zone(const Driven& most, std::size_t number, const std::vector<const Driven*>& at,
                const MeanFlight&, std::vector<std::string>& out) const;
  const Beamline& beamline_at(int point);

  const Experiment& experiment_;
  const Plan& plan_;
  std::map<const void*, Driven> driven_;  // by the transitions or the way that a path has
  Parts parts_;
  Beamline beamline_{};  // of the scan point that was asked for last
  int in_hand_ = -1;
};

}  // namespace rabiline
