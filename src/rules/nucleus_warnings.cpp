// Species with the moment of a nucleus in magnets that are made for atoms.
#include <algorithm>
#include <cmath>
#include <limits>

#include "particle/species.hpp"
#include "plan/plan.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

/// [m/s^2] Of its largest moment in a magnet: at the beam, or of a multipole halfway to the poles.
double acceleration_in(const Plane& plane, const MagnetTerm& magnet, const Species& species, double speed) {
  SampledTables tables;
  std::vector<Stage> chain;
  add_deflection(plane, magnet, species, 0, usual_tolerance, std::numeric_limits<double>::infinity(), tables,
                 chain);
  double largest = 0;
  for (const Stage& stage : chain) {
    if (const auto* constant = std::get_if<Deflection>(&stage))
      largest = std::max(largest, std::abs(constant->acceleration));
    if (const auto* stepped = std::get_if<Steering>(&stage))
      largest = std::max(largest, outlook_of(*stepped, speed).acceleration);
  }
  return largest;
}

const PlacedPart* last_screen(const Beamline& beamline) {
  const PlacedPart* screen = nullptr;
  for (const PlacedPart& part : beamline.parts)
    if (detector_in(part.part)) screen = &part;
  return screen;
}

/// By how much any magnet moves it at the last screen, in the mean [m].
double deflection_of(const Species& species, const Beamline& beamline) {
  const PlacedPart* screen = last_screen(beamline);
  if (!screen || !law_traits(beamline.law).has_forces) return 0;
  const double speed = mean_speed(beamline.source.speed, species.mass), y = screen->placement.at;
  double largest = 0;
  for (const Plane& plane : sections_of(beamline).planes)
    if (const auto* magnet = std::get_if<MagnetTerm>(&plane.term); magnet && magnet->end < y) {
      const double stay = (magnet->end - plane.y) / speed, drift = (y - magnet->end) / speed;
      largest =
          std::max(largest, acceleration_in(plane, *magnet, species, speed) * stay * (stay / 2 + drift));
    }
  return largest;
}

/// The smallest side of any opening or bin across the beam.
double finest_of(const Beamline& beamline) {
  double finest = HUGE_VAL;
  for (const PlacedPart& part : beamline.parts) {
    const auto across = across_of(part.part);
    if (!across) continue;
    const Detector* detector = detector_in(part.part);
    const double x = detector ? static_cast<double>(detector->bins.x) : 1,
                 z = detector ? static_cast<double>(detector->bins.z) : 1;
    if (const auto* rectangle = std::get_if<Rectangle>(&across->opening))
      finest = std::min({finest, rectangle->width / x, rectangle->height / z});
    else if (const auto* disc = std::get_if<Disc>(&across->opening))
      finest = std::min(finest, 2 * disc->radius / std::max(x, z));
    else if (const auto* ring = std::get_if<Ring>(&across->opening))
      finest = std::min(finest, ring->outer_radius - ring->inner_radius);
  }
  return finest;
}

}  // namespace

Faults nuclei_among_atoms_of(const Beamline& beamline) {
  Faults out;
  for (std::size_t i = 0; i < beamline.species.size(); ++i) {
    const Species& species = beamline.species[i].species;
    const std::string atom = atom_called(species);
    if (atom.empty()) continue;
    const double moved = deflection_of(species, beamline), finest = finest_of(beamline);
    if (moved > 0 && moved < finest / 4)
      out.push_back(warning(
          "species", key_of_species(i, "name"),
          fmt::format(
              "`{}` has the moment of its nucleus alone: the magnets move it by {} at `{}`, where the "
              "finest opening or bin of the beam is {}",
              species.name, metres(moved), last_screen(beamline)->placement.name, metres(finest)),
          fmt::format("did you mean `{}`?", atom)));
  }
  return out;
}

bool is_deflected(const Beamline& beamline, const Fault&) {
  return std::ranges::any_of(beamline.species, [&](const Component& component) {
    return deflection_of(component.species, beamline) > 0;
  });
}

}  // namespace rabiline
