#include "simulation/zone_rates.hpp"

#include <algorithm>
#include <cmath>

#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "field/terms.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline {

ZoneRates rates_of(const SpinZone& zone, const double* phases, const Vector3& place, double t,
                   double moment) {
  const Vector3 axis = zone.turned ? vector_at(zone.frame + 6) : Vector3{0, 0, 1};
  ZoneRates at{zone.spin_rate * axis, zone.turn_rate * axis};
  for (int i = 0; i < zone.drives; ++i) {
    const DriveTerm& drive = zone.drive[i];
    const double angle = drive.omega * t + drive.twist * (place.y - drive.envelope.begin) + phases[i] +
                         swept(drive.sweep, t) + phase_of(drive.slopes, place.x, place.z);
    const double share = is_on(drive.gate, moment)
                             ? share_of(drive.envelope, place.y) * share_of(drive.slopes, place.x, place.z)
                             : 0;
    const Vector3 along = share * (portable::cos(angle) * vector_at(drive.first) +
                                   portable::sin(angle) * vector_at(drive.second));
    at.spin = at.spin + drive.spin_rate * along;
    at.turn = at.turn + drive.turn_rate * along;
  }
  return at;
}

void add_field_at(const ShapedTerm& term, const SpinZone& zone, const double* phases, const Vector3& place,
                  double t, FieldHere<double>& sum) {
  if (term.drive < 0) return rabiline::add_field_at<HostMaths>(term, place.x, place.y, place.z, t, sum);
  FieldHere<double> peak{};
  add_field<HostMaths>(term, place.x, place.y, place.z, peak);
  const DriveTerm& drive = zone.drive[term.drive];
  const double share = portable::cos(drive.omega * t + swept(drive.sweep, t) + phases[term.drive]);
  for (int k = 0; k < 3; ++k) sum.field[k] += share * peak.field[k];
  for (int k = 0; k < 9; ++k) sum.slope[k] += share * peak.slope[k];
}

double moment_at(const MomentLaw& law, std::uint64_t level, double size) {
  const double place = size / (size + law.scale) * law.cells,
               cell = std::min(std::floor(place), static_cast<double>(law.cells - 1)), t = place - cell;
  const double* c = law.coefficients +
                    4 * (static_cast<std::ptrdiff_t>(level) * law.cells + static_cast<std::ptrdiff_t>(cell));
  return ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
}

double phase_of(const DriveTerm& drive, const RandomKey& key, std::uint64_t particle) {
  namespace lanes = isa_baseline;
  return lanes::lane(lanes::oscillator_phase(drive, key, lanes::broadcast_word(particle)), 0);
}

}  // namespace rabiline
