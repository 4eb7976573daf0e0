// What tallies ask about particles where they meet a plane. Reads only.
#include "transport/emission_lanes.hpp"
#include "transport/majorana_lanes.hpp"
#include "transport/plane_lanes.hpp"
#include "transport/spin_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

constexpr double planck = 6.62607015e-34;  // [J s] h, exact
constexpr double pi = 0x1.921fb54442d18p+1;

/// Particles on the plane that a tally looks at.
struct Crossing {
  real x, z, t;
  Vector velocity;
};
RABILINE_LANES Crossing crossing_at(double y, const BatchView& batch, int i) {
  const OnPlane there = to_plane(y, batch, i);
  return {there.x,
          there.z,
          load(batch.t + i) + there.dt,
          {load(batch.vx + i) + there.dt * batch.fall.x, load(batch.vy + i),
           load(batch.vz + i) + there.dt * batch.fall.z}};
}

RABILINE_LANES real value_of(const Gauge& gauge, const BatchView& batch, int i) {
  const Crossing c = crossing_at(gauge.y, batch, i);
  const real speed2 = dot(c.velocity, c.velocity);
  switch (gauge.quantity) {
    case Quantity::x:
      return c.x;
    case Quantity::z:
      return c.z;
    case Quantity::y:
      return broadcast(gauge.y);
    case Quantity::time_of_flight:
      return c.t;
    case Quantity::start_time:  // drawn again: the same number as the source drew
      return start_time(gauge.pulse, gauge.key, load(batch.particle + i));
    case Quantity::speed:
      return sqrt(speed2);
    case Quantity::wavelength:
      return (planck / gauge.mass) / sqrt(speed2);
    case Quantity::energy:
      return (0.5 * gauge.mass) * speed2;
    case Quantity::angle_x:
      return atan(c.velocity.x / c.velocity.y);
    case Quantity::angle_z:
      return atan(c.velocity.z / c.velocity.y);
    case Quantity::angle: {
      const real across = sqrt(fma(c.velocity.x, c.velocity.x, c.velocity.z * c.velocity.z));
      const real angle = atan(across / c.velocity.y);
      return select(c.velocity.y < broadcast(0), angle + pi, angle);
    }
    case Quantity::prepared_level:
      return number_of(load(batch.prepared + i));
    case Quantity::adiabaticity:
      return load(batch.adiabaticity + i);
    case Quantity::adiabaticity_y:
      return load(batch.adiabaticity_y + i);
    case Quantity::weight:
      return number_of(load(batch.weight + i)) * 0x1p-40;
    case Quantity::spin:
    case Quantity::spin_polar_angle:
    case Quantity::spin_azimuth:
    case Quantity::level:
      break;
  }
  return broadcast(0);
}

/// From +z, in [0, pi].
RABILINE_LANES real polar_angle(const Vector& s) {
  const real angle = atan(sqrt(fma(s.x, s.x, s.y * s.y)) / s.z);
  return select(s.z < broadcast(0), angle + pi, angle);
}
/// About +z, from +x towards +y, in [-pi, pi]; 0 of what points along z.
RABILINE_LANES real azimuth(const Vector& s) {
  const real zero = broadcast(0), angle = atan(s.y / s.x);
  const real turned = select(s.x < zero, angle + select(s.y < zero, broadcast(-pi), broadcast(pi)), angle);
  return select((s.x == zero) & (s.y == zero), zero, turned);
}

}  // namespace

void cross(const Aperture& face, const BatchView& batch, std::uint64_t* weights) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    const OnPlane there = to_plane(face.y, batch, i);
    const words through = (words)inside(face, there.x, there.z) & load(batch.flying + i);
    store(weights + i, load(batch.weight + i) & through);
  }
}

void measure(const Gauge& gauge, const BatchView& batch, const std::uint64_t* weights, double* values) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    if (!any(load(weights + i) != words{})) continue;
    store(values + i, value_of(gauge, batch, i));
  }
}

void measure_spin(const SpinGauge& gauge, const BatchView& batch, const std::uint64_t* weights,
                  double* values) {
  const Vector axis{broadcast(gauge.axis[0]), broadcast(gauge.axis[1]), broadcast(gauge.axis[2])};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const mask counted = load(weights + i) != words{};
    if (!any(counted)) continue;
    // What does not count stays for no time, however it flies.
    const real slowness = select(counted, load(batch.slowness + i), broadcast(0));
    const Vector s = spin_after(gauge.path.zones, gauge.path.zone_count, gauge.path.key, batch, i, slowness);
    if (gauge.quantity == Quantity::spin_polar_angle || gauge.quantity == Quantity::spin_azimuth) {
      store(values + i, gauge.quantity == Quantity::spin_azimuth ? azimuth(s) : polar_angle(s));
      continue;
    }
    const real along = max(broadcast(-1), min(broadcast(1), dot(axis, s)));
    if (gauge.path.levels == 0) {
      store(values + i, along);
      continue;
    }
    const real flip = fma(along, broadcast(-0.5), broadcast(0.5));
    for (int to = 0; to < gauge.path.levels; ++to)
      store(values + to * batch.padded + i,
            outcome_probability(gauge.path.polynomials, gauge.path.levels, load(batch.level + i), to, flip));
  }
}

void mark(const Ruler& ruler, const double* values, int padded, std::uint64_t* divisions) {
  for (int i = 0; i < padded; i += lane_count) {
    const real value = load(values + i);
    const mask on = (value >= broadcast(ruler.low)) & (value <= broadcast(ruler.high));
    const words at = weight_of(bin_of(value - ruler.low, ruler.per_unit, ruler.divisions));
    store(divisions + i, select(on, at, broadcast_word(Ruler::outside)));
  }
}

}  // namespace rabiline::RABILINE_ISA
