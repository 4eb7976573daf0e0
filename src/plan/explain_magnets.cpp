#include "plan/explain_magnets.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "core/units.hpp"
#include "plan/magnets.hpp"

namespace rabiline {
namespace {

std::string metres(double x) { return pretty_quantity(x, Dimension::length); }

/// The levels that meet the walls.
void tell_stopped(const Steering& s, const std::string& name, double speed, const OnAxis& beam,
                  MagnetText& out) {
  double first = s.end, last = s.begin;
  std::size_t stopped = 0, fast = 0;
  for (const int level : beam.levels) {
    if (stopped_at(s, level, beam.fastest)) ++fast;
    const std::optional<double> y = stopped_at(s, level, speed);
    if (!y) continue;
    ++stopped;
    first = std::min(first, *y);
    last = std::max(last, *y);
  }
  if (stopped == 0) return;
  out.lines.push_back(
      fmt::format("at {:.4g} m/s on the axis {} of {} levels meet its walls, from {:.4f} to {:.4f} m", speed,
                  stopped, beam.levels.size(), first, last));
  if (stopped < beam.levels.size()) return;
  out.warnings.push_back(
      {name,
       "kind",
       fmt::format(
           "`{}` pushes every level into its walls: at {:.4g} m/s on the axis they stop from {:.4g} to "
           "{:.4g} m; nothing {} along the axis can arrive",
           name, speed, first, last, fast == stopped ? "that flies" : "so slow that flies"),
       {},
       Severity::warning});
}

}  // namespace

MagnetText text_of(const Deflection& d, const std::string& name, double speed) {
  MagnetText out;
  const double stay = (d.end - d.begin) / speed, bent = std::abs(d.acceleration) * stay * stay / 2;
  out.lines.push_back(fmt::format("m = I goes by {} there", metres(bent)));
  const double room = 2 * (std::abs(d.along_z) > std::abs(d.along_x) ? d.half_z : d.half_x);
  if (!d.has_gap || bent <= room) return out;
  const double stops = d.begin + (d.end - d.begin) * std::sqrt(room / 2 / bent);
  if (d.levels > 0 && d.levels % 2 == 0 && bent > room * (d.levels - 1))
    out.warnings.push_back(
        {name,
         "gradient",
         fmt::format("`{}` pushes every level into its walls: m = I by {} within a gap of {} at {:.4g} m/s, "
                     "and stops it at about {:.3g} m; nothing so slow can arrive",
                     name, metres(bent), metres(room), speed, stops),
         {},
         Severity::warning});
  else
    out.warnings.push_back(
        {name,
         "gradient",
         fmt::format("`{}` pushes the outer levels into its walls: m = I by {} within a gap of {} at {:.0f} "
                     "m/s, and stops them at about {:.3g} m",
                     name, metres(bent), metres(room), speed, stops),
         {},
         Severity::warning});
  return out;
}

MagnetText text_of(const Steering& s, const std::string& name, double speed, const OnAxis& beam) {
  MagnetText out;
  const double stay = (s.end - s.begin) / speed;
  const SteeringOutlook outlook = outlook_of(s, speed);
  const bool multipole = s.shape.kind == MagnetKind::multipole;
  out.lines.push_back(fmt::format("{} |B| is {}, its gradient {}; the largest moment goes by {} in that",
                                  multipole ? "halfway to the poles" : "at the beam",
                                  pretty_quantity(outlook.field, Dimension::magnetic_field),
                                  pretty_quantity(outlook.gradient, Dimension::field_gradient),
                                  metres(outlook.acceleration * stay * stay / 2)));
  if (multipole && s.shape.power == 2 && s.moments.coefficients == nullptr && outlook.rate > 0)
    out.lines.push_back(fmt::format("a quarter of its oscillation takes {}",
                                    metres(std::numbers::pi / 2 * speed / outlook.rate)));
  tell_stopped(s, name, speed, beam, out);
  return out;
}

}  // namespace rabiline
