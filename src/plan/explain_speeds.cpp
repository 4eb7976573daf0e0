#include "plan/explain_speeds.hpp"

#include <fmt/format.h>

#include "core/constants.hpp"

namespace rabiline {

std::optional<std::string> warning_of_relativity(const Experiment& experiment) {
  constexpr double noticed = 1e-3;  // of (v/c)^2
  double fastest = 0;
  const Species* species = nullptr;
  for (const Beamline& point : experiment.points)
    for (const Component& component : point.species)
      if (const double v = mean_speed(point.source.speed, component.species.mass); v > fastest) {
        fastest = v;
        species = &component.species;
      }
  const double square = fastest * fastest / (constants::speed_of_light * constants::speed_of_light);
  if (!(square > noticed)) return std::nullopt;
  // gamma - 1 = (v/c)^2/2 + ...: radii and times of flight within fields are too small by that.
  return fmt::format(
      "{} flies at {:.4g} m/s, (v/c)^2 = {:.2g}: no law here knows relativity, so that a charge's radius in "
      "a "
      "field is too small by {:.1g} of itself",
      species->name, fastest, square, square / 2);
}

}  // namespace rabiline
