#include "plan/explain_laws.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/constants.hpp"

namespace rabiline {
namespace {

void tell_relativity(const Experiment& experiment, std::vector<Fault>& out) {
  constexpr double noticed = 1e-3;  // of (v/c)^2
  double fastest = 0;
  std::string species;
  for (const Beamline& point : experiment.points)
    for (const Component& component : point.species)
      if (const double v = mean_speed(point.source.speed, component.species.mass); v > fastest) {
        fastest = v;
        species = component.species.name;
      }
  const double square = fastest * fastest / (constants::speed_of_light * constants::speed_of_light);
  if (!(square > noticed)) return;
  // gamma - 1 = (v/c)^2/2 + ...: radii and times of flight within fields are too small by that.
  out.push_back(
      {"source",
       "speed",
       fmt::format("{} flies at {:.4g} m/s, (v/c)^2 = {:.2g}: no law here knows relativity, so that "
                   "a charge's radius in a field is too small by {:.1g} of itself",
                   species, fastest, square, square / 2),
       {},
       Severity::warning});
}

/// The hypothesis replaces mu grad |B|; what is left of a magnet is its field at the beam.
void tell_magnets(const Experiment& experiment, std::vector<Fault>& out) {
  const auto follows_hypothesis = [](const Beamline& b) { return !law_traits(b.law).has_forces; };
  const auto point = std::find_if(experiment.points.begin(), experiment.points.end(), follows_hypothesis);
  if (point == experiment.points.end()) return;
  std::string names;
  const Beamline beamline = *point;
  for (const PlacedPart& part : beamline.parts)
    if (is_magnet(part.part)) names += fmt::format("{}`{}`", names.empty() ? "" : ", ", part.placement.name);
  if (!names.empty())
    out.push_back(
        {"law",
         "name",
         fmt::format("under dorado no levels are separated by {}: the hypothesis stands in the place "
                     "of the force of a gradient. What is left is the field at the beam, in which "
                     "spins along it fly straight (closure torque)",
                     names),
         {},
         Severity::warning});
}

}  // namespace

std::vector<Fault> warnings_of_laws(const Experiment& experiment) {
  std::vector<Fault> out;
  tell_relativity(experiment, out);
  tell_magnets(experiment, out);
  return out;
}

}  // namespace rabiline
