#pragma once
// What `check` tells of a plan, stage by stage, and what is known of the beam on the way.
#include <functional>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "beamline/beamline.hpp"
#include "core/fault.hpp"
#include "core/units.hpp"
#include "transport/kernels.hpp"
#include "transport/mean_flight.hpp"

namespace rabiline {

class PlanReport {
 public:
  explicit PlanReport(const Beamline& of) : beamline(of) {}

  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    text += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }
  /// Of a part, and of the key of it to blame.
  void warn(const std::string& part, std::string key, std::string message) {
    warnings.push_back({part, std::move(key), std::move(message), {}, Severity::warning});
  }
  /// The last field that covers a place [m].
  std::string field_at(double y) const {
    std::string name;
    for (const PlacedPart& part : beamline.parts)
      if (traits_of(part.part).field && part.placement.at <= y && y < end_of(part))
        name = part.placement.name;
    return name;
  }

  const PlacedPart& part(int number) const { return beamline.parts[static_cast<std::size_t>(number)]; }
  std::string name_of(int number) const { return number < 0 ? "chamber" : part(number).placement.name; }
  /// A place along the beam, at the beginning of a line.
  static std::string metres(double y) { return fmt::format("{:8.4f} m", y); }
  static std::string about_steps(double n) {
    return fmt::format("about {:.0f} step{}", n, n < 1.5 ? "" : "s");
  }

  const Beamline& beamline;
  // the species at hand
  const Species* species = nullptr;
  bool of_atom = false;  // under `quantum`, with the levels of two spins
  MeanFlight flight{};
  std::function<double()> fastest;            // [m/s]
  std::function<void(int part)> tell_driven;  // what drives an atom's levels before a part asks for them
  // the stage at hand
  std::string reuse;                             // "  [once for all points]"
  std::size_t reweightings = 0;                  // of a projection that splits
  int levels_found = 0;                          // likewise
  int slowness_cells = 0;                        // of its moments, or 0
  std::size_t fewest_nodes = 0, most_nodes = 0;  // of frequencies that its reweightings follow from, or 0
  std::string_view why_one_by_one{};             // why it has neither
  // the beam where it stands
  std::vector<int> on_axis;  // levels of a beam that nothing has bent yet
  double tip = 0;            // [rad] what all drives since the last alignment can have done at most

  std::string text;
  std::vector<Fault> warnings;
};

/// The derived numbers of one zone, and where they mislead.
void explain_zone(const SpinZone&, PlanReport&);

}  // namespace rabiline
