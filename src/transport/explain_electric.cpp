// What `check` tells of the electric field in one zone.
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "transport/plan_report.hpp"
#include "transport/stages/turning_region.hpp"

namespace rabiline {

void explain_electric(const TurningRegion& region, const RegionZone& zone, PlanReport& report) {
  if (zone.shaped_end == zone.electric_end) return;
  constexpr int places = 64;
  const double length = zone.field.end - zone.field.begin;
  FieldHere<double> sum{};
  for (int i = 0; i < places; ++i)
    for (int k = zone.shaped_end; k < zone.electric_end; ++k)
      add_field<HostMaths>(region.shaped[static_cast<std::size_t>(k)], 0.0,
                           zone.field.begin + length * (i + 0.5) / places, 0.0, sum);
  const Vector3 e = (1.0 / places) * Vector3{sum.field[0], sum.field[1], sum.field[2]};
  const double speed = report.flight.speed_between(zone.field.begin, zone.field.end);
  const Vector3 motional =
      (-speed / (constants::speed_of_light * constants::speed_of_light)) * cross({0, 1, 0}, e);
  const ElectricCoupling& feels = region.feels.electric;
  const auto volts = [&](double x) {  // what rounding leaves of a component is none
    return pretty_quantity(std::abs(x) < 1e-12 * length_of(e) ? 0 : x, Dimension::electric_field);
  };
  report.line(
      "{:>16}E = ({}, {}, {}), its mean on the axis: in flight a spin meets v x E/c^2 = {} of it as a "
      "magnetic field, and its phase changes by up to {:.4g} deg{}",
      "", volts(e.x), volts(e.y), volts(e.z), pretty_quantity(length_of(motional), Dimension::magnetic_field),
      length_of(feels.spin_per_motional * motional + feels.spin_per_electric * e) * length / speed * 180 /
          std::numbers::pi,
      report.species->charge != 0
          ? fmt::format("; the charge gains {}",
                        pretty_quantity(report.species->charge * e.y * length, Dimension::energy))
          : "");
  if (feels.acceleration != 0) report.flight.gained += feels.acceleration * e.y * length;
}

}  // namespace rabiline
