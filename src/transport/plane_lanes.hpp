#pragma once
// What planes across the beam do to lanes, for kernels only: openings, screens, alignment.
#include "transport/region.hpp"
#include "transport/stages/alignment.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// The sum of a word of each lane.
inline std::uint64_t sum_of_lanes(words w) {
  std::uint64_t total = 0;
  for (int k = 0; k < lane_count; ++k) total += lane(w, k);
  return total;
}

/// A constant acceleration across the beam [m/s^2].
struct Acceleration {
  real x, z;
};
/// Particles on a plane of constant y, and how long they fly there.
struct OnPlane {
  real dt, x, z;
};
/// The flight of particles from the batch's common plane on to another one, or back to it, with an
/// acceleration that is constant on the way.
RABILINE_LANES OnPlane to_plane(double y, const BatchView& batch, int i, const Acceleration& a) {
  const real dt = broadcast(y - batch.y) * load(batch.slowness + i);
  return {dt, fma(fma(0.5 * a.x, dt, load(batch.vx + i)), dt, load(batch.x + i)),
          fma(fma(0.5 * a.z, dt, load(batch.vz + i)), dt, load(batch.z + i))};
}
/// Free flight.
RABILINE_LANES OnPlane after(real dt, const BatchView& batch, int i) {
  const real x = load(batch.x + i), z = load(batch.z + i), vx = load(batch.vx + i), vz = load(batch.vz + i);
  if (batch.fall == Fall{}) return {dt, fma(vx, dt, x), fma(vz, dt, z)};
  return {dt, fma(fma(broadcast(0.5 * batch.fall.x), dt, vx), dt, x),
          fma(fma(broadcast(0.5 * batch.fall.z), dt, vz), dt, z)};
}
RABILINE_LANES OnPlane to_plane(double y, const BatchView& batch, int i) {
  return after(broadcast(y - batch.y) * load(batch.slowness + i), batch, i);
}
/// Each lane to a plane of its own.
RABILINE_LANES OnPlane to_plane(real y, const BatchView& batch, int i) {
  return after((y - batch.y) * load(batch.slowness + i), batch, i);
}
/// The velocity across the beam behind a free flight.
RABILINE_LANES void fall_for(real dt, BatchView& batch, int i) {
  if (batch.fall.x != 0) store(batch.vx + i, fma(broadcast(batch.fall.x), dt, load(batch.vx + i)));
  if (batch.fall.z != 0) store(batch.vz + i, fma(broadcast(batch.fall.z), dt, load(batch.vz + i)));
}

RABILINE_LANES mask inside_shape(const Aperture& a, real x, real z) {
  const real dx = x - a.x0, dz = z - a.z0;
  if (a.radius >= 0) {
    const real r2 = fma(dx, dx, dz * dz);
    return (r2 <= broadcast(a.radius * a.radius)) & (r2 >= broadcast(a.inner * a.inner));
  }
  if (a.sine == 0) return (abs(dx) <= broadcast(a.half_x)) & (abs(dz) <= broadcast(a.half_z));
  const real across = fma(dx, broadcast(a.cosine), -(dz * a.sine)),
             up = fma(dx, broadcast(a.sine), dz * a.cosine);
  return (abs(across) <= broadcast(a.half_x)) & (abs(up) <= broadcast(a.half_z));
}

/// How far from its centre a parabola comes between two planes: p + v tau + g tau^2/2 across the beam, from
/// one plane (tau = 0) to the other (tau = 1).
struct Parabola {
  real px, pz, vx, vz, gx, gz;

  /// The largest |coordinate| between the planes of p + v tau + g tau^2/2, or zero where it is at one of
  /// them.
  RABILINE_LANES static real farthest_along(real p, real v, real g) {
    const real at_end = v + g;
    const mask turns = v * at_end < broadcast(0);
    return select(turns, abs(p - 0.5 * v * v / select(turns, g, broadcast(1))), broadcast(0));
  }
  /// The largest squared distance between the planes, or zero where it is at one of them: where the distance
  /// stops growing, d = p.v + (v^2 + p.g) tau + 3/2 v.g tau^2 + g^2/2 tau^3 falls through zero, between the
  /// two roots of d'. An error of the place counts by its square, so that halves do.
  RABILINE_LANES real farthest2() const {
    const real pv = fma(px, vx, pz * vz), pg = fma(px, gx, pz * gz), v2 = fma(vx, vx, vz * vz),
               vg = fma(vx, gx, vz * gz), g2 = max(fma(gx, gx, gz * gz), broadcast(0x1p-500)),
               linear = v2 + pg;
    const auto grows = [&](real tau) { return fma(fma(fma(0.5 * g2, tau, 1.5 * vg), tau, linear), tau, pv); };
    const real root = sqrt(max(fma(vg, vg, (-2.0 / 3) * g2 * linear), broadcast(0)));
    real low = max((-vg - root) / g2, broadcast(0)), high = min((root - vg) / g2, broadcast(1));
    const mask between = (grows(low) > broadcast(0)) & (grows(high) < broadcast(0));
    if (!any(between)) return broadcast(0);
    for (int halving = 0; halving < 26; ++halving) {
      const real middle = 0.5 * (low + high);
      const mask before = grows(middle) > broadcast(0);
      low = select(before, middle, low);
      high = select(before, high, middle);
    }
    const real x = fma(fma(0.5 * gx, low, vx), low, px), z = fma(fma(0.5 * gz, low, vz), low, pz);
    return select(between, fma(x, x, z * z), broadcast(0));
  }
};

/// Which lanes meet the wall of a channel other than in its two ends: gravity bends their paths out of it and
/// back.
RABILINE_LANES mask bulges_out(const Aperture& a, double begin, real end, const BatchView& batch, int i) {
  const OnPlane from = to_plane(begin, batch, i), to = to_plane(end, batch, i);
  const real time = to.dt - from.dt, gx = time * time * batch.fall.x, gz = time * time * batch.fall.z;
  const real px = from.x - a.x0, pz = from.z - a.z0, vx = fma(broadcast(-0.5), gx, to.x - from.x),
             vz = fma(broadcast(-0.5), gz, to.z - from.z);
  if (a.radius >= 0) return Parabola{px, pz, vx, vz, gx, gz}.farthest2() > broadcast(a.radius * a.radius);
  const auto across = [&](real x, real z) { return fma(x, broadcast(a.cosine), -(z * a.sine)); };
  const auto up = [&](real x, real z) { return fma(x, broadcast(a.sine), z * a.cosine); };
  return (Parabola::farthest_along(across(px, pz), across(vx, vz), across(gx, gz)) > broadcast(a.half_x)) |
         (Parabola::farthest_along(up(px, pz), up(vx, vz), up(gx, gz)) > broadcast(a.half_z));
}

/// Which lanes, inside of a channel where it begins, have met its wall before `end`.
RABILINE_LANES mask meets_wall(const Aperture& a, double begin, real end, const BatchView& batch, int i) {
  const OnPlane there = to_plane(end, batch, i);
  const mask out = ~inside_shape(a, there.x, there.z);
  return batch.fall == Fall{} ? out : out | bulges_out(a, begin, end, batch, i);
}
/// The first place between two at which a lane has met something that it has met at the second; `has_met`
/// answers for all that lies before a place.
template <class HasMet>
RABILINE_LANES real first_place(real low, real high, const HasMet& has_met) {
  for (int halving = 0; halving < 52; ++halving) {
    const real middle = 0.5 * (low + high);
    const mask met = has_met(middle);
    high = select(met, middle, high);
    low = select(met, low, middle);
  }
  return high;
}
/// The place where chosen lanes meet a wall before `end`; of others, and where they do not, `end`.
RABILINE_LANES real place_of_meeting(const Aperture& a, double begin, double end, mask chosen,
                                     const BatchView& batch, int i) {
  const mask meets = chosen & meets_wall(a, begin, broadcast(end), batch, i);
  if (!any(meets)) return broadcast(end);
  const real place = first_place(broadcast(begin), broadcast(end),
                                 [&](real y) { return meets_wall(a, begin, y, batch, i); });
  return select(meets, place, broadcast(end));
}

/// Whether a particle at (x, z) touches no pole.
RABILINE_LANES mask is_in(const RegionGap& gap, real x, real z) {
  const real dx = x - gap.x, dz = z - gap.z;
  return is_free<mask>(gap.walls, fma(dx, broadcast(gap.cosine), -(dz * gap.sine)),
                       fma(dx, broadcast(gap.sine), dz * gap.cosine) + gap.height);
}

/// Whether a particle at (x, z) flies on.
RABILINE_LANES mask inside(const Aperture& a, real x, real z) {
  const mask in = inside_shape(a, x, z);
  return a.stops_inside ? ~in : in;
}

RABILINE_LANES Aperture rim_of(const Screen& s) {
  Aperture rim;
  rim.y = s.y;
  rim.x0 = s.x0;
  rim.z0 = s.z0;
  rim.half_x = s.half_x;
  rim.half_z = s.half_z;
  rim.radius = s.radius;
  rim.cosine = s.cosine;
  rim.sine = s.sine;
  return rim;
}
/// Which of those that hit the screen hit its dead area.
RABILINE_LANES mask in_dead_area(const Screen& s, real x, real z) {
  return s.has_dead_area ? inside(s.dead, x, z) : mask{};
}

/// Bin of a distance from the screen's low edge; the high edge belongs to the last bin.
RABILINE_LANES real bin_of(real from_edge, double bins_per_metre, int bins) {
  const real at = max(broadcast(0), min(broadcast(bins), from_edge * bins_per_metre));
  return min(floor(at), broadcast(bins - 1));
}
RABILINE_LANES words bin_on(const Screen& s, real x, real z) {
  if (s.sine != 0) {
    const real dx = x - s.x0, dz = z - s.z0;
    x = fma(dx, broadcast(s.cosine), fma(dz, broadcast(-s.sine), broadcast(s.x0)));
    z = fma(dx, broadcast(s.sine), fma(dz, broadcast(s.cosine), broadcast(s.z0)));
  }
  const real ix = bin_of(x - s.low_x, s.bins_per_x, s.bins_x);
  const real iz = bin_of(z - s.low_z, s.bins_per_z, s.bins_z);
  return bit_pattern(fma(ix, broadcast(s.bins_z), iz) + 0x1p52) & 0xfffffffffffffULL;
}

/// A weight up to 2^52 as a number, and back.
RABILINE_LANES real number_of(words weight) { return from_bits(weight | 0x4330000000000000ULL) - 0x1p52; }
RABILINE_LANES words weight_of(real whole) { return bit_pattern(whole + 0x1p52) & 0xfffffffffffffULL; }

/// Lets a share of each weight in flight pass, floored; what has none left ends. Returns what stays behind
/// [quanta].
RABILINE_LANES words let_pass(BatchView& batch, int i, real share) {
  const words flying = load(batch.flying + i), weight = load(batch.weight + i);
  const words kept = weight_of(floor(number_of(weight) * share));
  store(batch.weight + i, select((mask)flying, kept, weight));
  store(batch.flying + i, flying & (words)(kept != words{}));
  return (weight - kept) & flying;
}

/// The spin that alignment gives where S comes out with that sign: the image of z under `quantum`.
RABILINE_LANES Vector aligned_spin(const Alignment& a, real sign) {
  const real size = a.levels > 0 ? broadcast(1) : sign;
  return {a.axis[0] == 0 ? broadcast(0) : size * a.axis[0], a.axis[1] == 0 ? broadcast(0) : size * a.axis[1],
          size * a.axis[2]};
}

/// The sign of S along the axis that alignment gives each particle.
RABILINE_LANES real drawn_sign(const Alignment& a, const RandomKey& key, words particle) {
  real u, unused;
  uniforms(particle, key.seed, purpose::align, static_cast<unsigned>(a.part), key.stream, u, unused);
  return select(u < broadcast(a.probability), broadcast(a.spin_sign), broadcast(-a.spin_sign));
}

}  // namespace rabiline::RABILINE_ISA
