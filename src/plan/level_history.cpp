#include "plan/level_history.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <fmt/format.h>

#include "core/portable_math.hpp"

namespace rabiline {
namespace {

/// [m] Where parts touch, rounding may leave a section of this length between them.
constexpr double rounding = 1e-12;

[[noreturn]] void refuse(const Species& species, const Section& section, const char* why, const char* help) {
  throw std::invalid_argument(fmt::format("{} between {:.6g} m and {:.6g} m: {}\n  help: {}", species.name,
                                          section.begin, section.end, why, help));
}

Envelope envelope_of(Shape shape) {
  switch (shape) {
    case Shape::half_sine:
      return Envelope::half_sine;
    case Shape::gaussian:
      return Envelope::gaussian;
    case Shape::rectangular:
      break;
  }
  return Envelope::rectangular;
}

LevelDrive drive_of(const RotatingTerm& term, const Species& species, const Section& section) {
  LevelDrive drive;
  drive.amplitude = term.amplitude;
  drive.frequency = term.frequency;
  drive.phase = term.phase;
  drive.clock = term.oscillator;
  drive.random_phase = term.random_phase;
  drive.envelope = envelope_of(term.profile.shape);
  drive.begin = term.profile.begin;
  drive.length = term.profile.length;
  drive.sigma = term.profile.sigma;
  if (term.twist != 0)
    refuse(species, section, "the field that drives an atom's levels turns along the beam",
           "leave out `twist`");
  if (term.motion == FieldMotion::swings)
    refuse(species, section, "the levels of an atom are driven in the rotating-wave approximation only",
           "write `approximation: rotating_wave`");
  if (term.motion == FieldMotion::swings_in_rotating_wave) {
    drive.kind = DriveKind::oscillating;
    drive.direction[0] = term.first.x;
    drive.direction[1] = term.first.y;
    drive.direction[2] = term.first.z;
    return drive;
  }
  if (!(term.first == Vector3{1, 0, 0} && term.second == Vector3{0, 1, 0}))
    refuse(species, section, "a field that turns in a tilted plane cannot drive an atom's levels",
           "leave out its `tilt`");
  if (term.turn == Turn::with_precession || term.turn == Turn::against_precession)
    refuse(species, section, "its levels precess both ways, so `co` and `counter` mean nothing",
           "write `sense: positive` or `sense: negative`");
  drive.kind = term.turn == Turn::positive ? DriveKind::rotating_positive : DriveKind::rotating_negative;
  return drive;
}

LevelZone zone_of(const Section& section, const Species& species) {
  if (!section.coils.empty())
    refuse(species, section, "a coil is wound for one moment, and an atom has levels",
           "drive them with a `rotating_field` or an `oscillating_field`");
  if (section.field.x != 0 || section.field.y != 0 || section.field.z < 0)
    refuse(species, section, "an atom with levels flies through fields along +z only",
           "let the field point along +z");
  LevelZone zone;
  zone.begin = section.begin;
  zone.end = section.end;
  zone.field = section.field.z;
  for (const RotatingTerm& term : section.rotating) {
    if (term.amplitude == 0) continue;
    if (zone.drive)
      refuse(species, section, "two fields drive an atom's levels at one place",
             "place them one behind the other");
    zone.drive = drive_of(term, species, section);
  }
  return zone;
}

// ---- speeds ----

/// Beyond this many standard deviations is less than 1e-4.
constexpr double deviations = 4;
/// Speeds in units of the thermal one between which all but 1e-4 lie: flux, then density.
constexpr double slowest_flux = 0.12, slowest_density = 0.05, fastest_thermal = 4;

struct Speeds {
  double slowest = 0, fastest = 0;  // [m/s]
};
Speeds from_values(double a, double b) { return {std::min(a, b), std::max(a, b)}; }

Speeds speeds_of(const SingleSpeed& law, double mass) {
  const double v = speed_of(law.value, mass);
  return {v, v};
}
Speeds speeds_of(const GaussianSpeed& law, double mass) {
  const double width = deviations * law.sigma.value, mean = law.mean.value;
  SpeedQuantity low = law.mean, high = law.mean;
  low.value = std::max(mean - width, mean / 20);
  high.value = mean + width;
  return from_values(speed_of(low, mass), speed_of(high, mass));
}
Speeds speeds_of(const EffusiveSpeed& law, double mass) {
  const double alpha = thermal_speed(law.temperature, mass);
  return {slowest_flux * alpha, fastest_thermal * alpha};
}
Speeds speeds_of(const MaxwellSpeed& law, double mass) {
  const double alpha = thermal_speed(law.temperature, mass);
  return {slowest_density * alpha, fastest_thermal * alpha};
}
Speeds speeds_of(const SupersonicSpeed& law, double mass) {
  const double u = terminal_speed(law, mass), width = deviations / law.speed_ratio;
  return {u * std::max(1 - width, 0.12 / law.speed_ratio), u * (1 + width)};
}
Speeds speeds_of(const TabulatedSpeed& law, double mass) {
  const Spectrum& spectrum = *law.file.spectrum;
  return from_values(speed_of({spectrum.at.front(), spectrum.dimension}, mass),
                     speed_of({spectrum.at.back(), spectrum.dimension}, mass));
}
Speeds speeds_of(const LineSpeeds& law, double mass) {
  Speeds speeds{fastest_speed, 0};
  for (const SpeedLine& line : law.lines) {
    const double v = speed_of(line.value, mass);
    speeds = {std::min(speeds.slowest, v), std::max(speeds.fastest, v)};
  }
  return speeds;
}

// ---- directions ----

/// Nothing is told apart beyond this angle [rad].
constexpr double widest = 1.3;

double angle_of(const ParallelDirection&) { return 0; }
double angle_of(const GaussianDirection& law) {
  return portable::atan(deviations * portable::hypot(law.x, law.z));
}
double angle_of(const ConeDirection& law) { return law.half_angle; }
double angle_of(const CosineDirection& law) { return law.half_angle; }
double angle_of(const BoxDirection& law) { return portable::atan(portable::hypot(law.x, law.z)); }
double angle_of(const ChannelDirection&) { return widest; }
double angle_of(const AimedDirection&) { return widest; }

/// How far the rim is from the centre.
double reach_of(const Rectangle& hole) { return portable::hypot(hole.width, hole.height) / 2; }
double reach_of(const Disc& hole) { return hole.radius; }
double reach_of(const Ring& hole) { return hole.outer_radius; }
double reach_of(const GaussianSpot& spot) { return deviations * portable::hypot(spot.sigma_x, spot.sigma_z); }
template <class... Holes>
double reach_of(const std::variant<Holes...>& hole) {
  return std::visit([](const auto& h) { return reach_of(h); }, hole);
}

}  // namespace

std::vector<LevelZone> driven_zones(const Species& species, const std::vector<Section>& sections, double from,
                                    double to) {
  std::vector<LevelZone> zones;
  std::size_t last = 0;
  for (const Section& section : sections) {
    if (std::max(section.begin, from) + rounding >= std::min(section.end, to)) continue;
    LevelZone zone = zone_of(section, species);
    zone.begin = std::max(zone.begin, from);
    zone.end = std::min(zone.end, to);
    const bool driven = zone.drive.has_value();
    if (!driven && zones.empty()) continue;  // only phases before the first drive
    zones.push_back(zone);
    if (driven) last = zones.size();
  }
  zones.resize(last);
  return zones;
}

double steepest_before(const Plane& asked, const Beamline& beamline, const Sections& sections) {
  const Source& source = beamline.source;
  const double tilt =
      portable::acos(std::clamp(portable::cos(source.tilt.x) * portable::cos(source.tilt.z), -1.0, 1.0));
  const double law = std::visit([](const auto& l) { return angle_of(l); }, source.direction) + tilt;
  if (law == 0) return 0;
  const double hole = reach_of(source.opening) + portable::hypot(source.offset.x, source.offset.z);
  double slope = std::numeric_limits<double>::infinity();
  const auto pass = [&](double y, double reach) {
    if (y > 0) slope = std::min(slope, (reach + hole) / y);
  };
  for (const PlacedPart& part : beamline.parts)
    if (const auto* aimed = std::get_if<AimedDirection>(&source.direction);
        aimed != nullptr && part.placement.name == aimed->target) {
      if (const auto* slit = std::get_if<Slit>(&part.part))
        pass(part.placement.at, reach_of(slit->opening) + portable::hypot(slit->offset.x, slit->offset.z));
      if (const auto* face = std::get_if<Detector>(&part.part))
        pass(part.placement.at,
             reach_of(opening_of(face->face)) + portable::hypot(face->offset.x, face->offset.z));
    }
  // What a magnet bends keeps its speed along the beam.
  for (const Plane& plane : sections.planes) {
    if (std::holds_alternative<MagnetTerm>(plane.term) || plane.y > asked.y) break;
    if (beamline.chamber) pass(plane.y, beamline.chamber->radius);
    const auto* plate = std::get_if<PlateTerm>(&plane.term);
    if (plate != nullptr && !plate->stops_inside)
      pass(plane.y, reach_of(plate->opening) + portable::hypot(plate->offset.x, plate->offset.z));
    const auto* screen = std::get_if<ScreenTerm>(&plane.term);
    if (screen != nullptr && &plane == &asked)
      pass(plane.y, reach_of(opening_of(screen->face)) + portable::hypot(screen->offset.x, screen->offset.z));
  }
  return std::min({law, portable::atan(slope), widest});
}

SlownessRange slownesses_of(const Source& source, double mass, double steepest) {
  const Speeds speeds = std::visit([&](const auto& law) { return speeds_of(law, mass); }, source.speed);
  // What flies aslant goes more slowly along the beam; in steps, so that scan points share their tables.
  constexpr double step = 0.02;
  const double longer = 1 + step * std::ceil((1 / portable::cos(steepest) - 1) / step);
  return {1 / speeds.fastest, longer / speeds.slowest};
}

}  // namespace rabiline
