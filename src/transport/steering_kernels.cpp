// Magnets whose force depends on the place: stepped paths.
#include "transport/moment_lanes.hpp"
#include "transport/plane_lanes.hpp"
#include "transport/stages/steering.hpp"
#include "transport/stages/wall_stop.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

/// Across the beam, in the magnet's frame.
struct Across {
  real x, z, vx, vz;
};
struct Force {
  real ax, az;     // [m/s^2]
  real rate;       // [1/s^2] w^2, but for
  real sharpness;  // [1/m^2] that v^2 is multiplied by
};

/// `part` is m/I, or that of a vector S along the field, where the moment is constant.
RABILINE_LANES Force force_at(const Steering& s, const Fall& fall, words level, real part, const Across& at) {
  const auto field = field_size(s.shape, at.x, at.z, [](real q) { return sqrt(q); });
  const double inverse_mass = 1 / s.mass;
  if (s.moments.coefficients == nullptr) {
    const real pull = part * (s.moment * inverse_mass);
    return {fma(pull, field.along_x, broadcast(fall.x)), fma(pull, field.along_z, broadcast(fall.z)),
            abs(pull) * field.bend, field.sharpness};
  }
  const real pull = moment_of(s.moments, level, field.size) * inverse_mass;
  const real slope2 = fma(field.along_x, field.along_x, field.along_z * field.along_z);
  const real near = 1.0 / (field.size + s.moments.scale);
  return {fma(pull, field.along_x, broadcast(fall.x)), fma(pull, field.along_z, broadcast(fall.z)),
          fma(slope2, near, field.bend) * (s.moment * inverse_mass),
          fma(slope2 * near, near, field.sharpness)};
}

/// One VEFRL step; `force` is that at the place, before and behind.
RABILINE_LANES void step(const Steering& s, const Fall& fall, words level, real part, real h, Across& at,
                         Force& force) {
  constexpr double xi = 0.1644986515575760, lambda = -0.02094333910398989, chi = 1.235692651138917;
  const auto kick = [&](double share) {
    at.vx = fma(force.ax, h * share, at.vx);
    at.vz = fma(force.az, h * share, at.vz);
  };
  const auto fly = [&](double share) {
    at.x = fma(at.vx, h * share, at.x);
    at.z = fma(at.vz, h * share, at.z);
    force = force_at(s, fall, level, part, at);
  };
  kick(xi);
  fly(0.5 - lambda);
  kick(chi);
  fly(lambda);
  kick(1 - 2 * (chi + xi));
  fly(lambda);
  kick(chi);
  fly(0.5 - lambda);
  kick(xi);
}

/// [s] until a lane comes to where |B| is zero and its gradient jumps, on a line or an axis |B|/|grad |B||
/// away (MagnetShape::jumps), or until it turns back before: the places within a step are closer than those
/// of the path. And how fast it would be there, by its energy; infinite, where that does not suffice.
struct Jump {
  real time, speed;
};
RABILINE_LANES Jump next_jump(const Steering& s, const Force& force, const Across& at) {
  const auto field = field_size(s.shape, at.x, at.z, [](real q) { return sqrt(q); });
  const real slope = sqrt(fma(field.along_x, field.along_x, field.along_z * field.along_z));
  const real over = 1.0 / max(slope, broadcast(0x1p-500)), out_x = field.along_x * over,
             out_z = field.along_z * over, away = field.size * over;
  const real outwards = fma(at.vx, out_x, at.vz * out_z), aside = fma(at.vx, out_z, -(at.vz * out_x));
  const bool on_axis = s.shape.kind == MagnetKind::multipole;
  const real inwards2 = outwards * outwards, centrifugal = aside * aside / max(away, broadcast(0x1p-500)),
             attraction = fma(force.ax, out_x, force.az * out_z),
             pull = on_axis ? attraction + centrifugal : attraction;
  const real square = fma(-2.0 * pull, away, inwards2), root = sqrt(max(square, broadcast(0))),
             speed2 = fma(-2.0 * attraction, away, on_axis ? fma(aside, aside, inwards2) : inwards2);
  const mask comes = (square >= broadcast(0)) & (outwards < broadcast(0)), returns = pull < broadcast(0),
             turns = ~comes & ~returns & (outwards < broadcast(0));
  const real never = broadcast(__builtin_inf());
  const real back = select(returns, (outwards + root) / -select(returns, pull, broadcast(-1)), never);
  return {select(comes, 2.0 * away / (root - outwards),
                 select(turns, -outwards / select(turns, pull, broadcast(1)), back)),
          select(speed2 > broadcast(0), sqrt(max(speed2, broadcast(0))), never)};
}

/// [1/s^2] w^2.
RABILINE_LANES real rate2_of(const Force& force, const Across& at) {
  return fma(fma(at.vx, at.vx, at.vz * at.vz), force.sharpness, force.rate);
}
/// The length of the next step [s], and w^2 where it begins.
struct NextStep {
  real length, rate2;
};
/// What is left in equal steps, none longer than the force allows, none shorter than `least`. Where the force
/// jumps ahead of a lane that comes back there seldom, steps end just short of it and a last, tiny one
/// crosses it: there none is shorter than `hair`.
RABILINE_LANES NextStep next_step(const Steering& s, const Force& force, const Across& at, real left,
                                  real least, real hair) {
  const real rate2 = rate2_of(force, at), rate = sqrt(rate2);
  real finest = least, until = left;
  if (s.shape.jumps()) {
    const Jump jump = next_jump(s, force, at);
    const mask seldom =
        jump.speed > steering::seldom * least * sqrt(fma(force.ax, force.ax, force.az * force.az));
    finest = select(seldom, hair, least);
    until = select(seldom, max(finest, jump.time * (1 - 1.0 / 64)), left);
  }
  const real steps = min(left * rate * (1 / steering::step_angle), left / finest);
  return {min(left / max(broadcast(1), -floor(-steps)), until), rate2};
}

/// What steps may be off by.
struct Allowed {
  real drift;  // [m/s] of the velocity over the whole magnet, and of the place over the time in it
  real stay;   // [s] in the whole magnet
};

/// Which lanes may have been off in a step of the length h, by bounds of what its steps were measured
/// to be off by, c (w h)^4 of the change of the velocity: what that is worth at the magnet's end, and the
/// place itself. A force that turned over within the step is not bounded by w.
RABILINE_LANES mask may_be_off(const Steering& s, const Force& before, const Across& to, const Force& behind,
                               real rate2, real h, const Allowed& allowed) {
  constexpr double of_velocity = 1e-2, of_place = 1e-3;
  const real angle2 = max(rate2, rate2_of(behind, to)) * (h * h);
  const real force = max(abs(before.ax) + abs(before.az), abs(behind.ax) + abs(behind.az));
  const mask off = force * angle2 * max(of_velocity * angle2 * allowed.stay, of_place * h) > allowed.drift;
  if (!s.shape.jumps()) return off;
  const mask turned_over = fma(before.ax, behind.ax, before.az * behind.az) < broadcast(0);
  return off | (turned_over & (2.0 * force * h > allowed.drift * steering::of_jump));
}

/// By how much a step was off, over what it may be: the force on the path, which its ends tell to fifth
/// order, integrated by Lobatto's rule of sixth.
RABILINE_LANES real error_of(const Steering& s, const Fall& fall, words level, real part, const Across& from,
                             const Force& before, const Across& to, const Force& behind, real h,
                             const Allowed& allowed) {
  constexpr double first = 0.27639320225002103, of_ends = 1.0 / 12, of_middle = 5.0 / 12;
  const auto place_at = [&](double c, real x0, real v0, real a0, real x1, real v1, real a1) {
    const double c2 = c * c, c3 = c2 * c, c4 = c2 * c2, c5 = c4 * c;
    const real by_v = (c - 6 * c3 + 8 * c4 - 3 * c5) * v0 + (-4 * c3 + 7 * c4 - 3 * c5) * v1;
    const real by_a = (0.5 * c2 - 1.5 * c3 + 1.5 * c4 - 0.5 * c5) * a0 + (0.5 * c3 - c4 + 0.5 * c5) * a1;
    return x0 + (10 * c3 - 15 * c4 + 6 * c5) * (x1 - x0) + h * (by_v + h * by_a);
  };
  const auto force_on_path = [&](double c) {
    const real none = broadcast(0);
    const Across there{place_at(c, from.x, from.vx, before.ax, to.x, to.vx, behind.ax),
                       place_at(c, from.z, from.vz, before.az, to.z, to.vz, behind.az), none, none};
    return force_at(s, fall, level, part, there);
  };
  const Force early = force_on_path(first), late = force_on_path(1 - first);
  const auto off = [&](real x0, real v0, real a0, real a1, real a2, real x1, real v1, real a3) {
    const real dv = h * (of_ends * (a0 + a3) + of_middle * (a1 + a2)) - (v1 - v0);
    const real dx = h * (v0 + h * (of_ends * a0 + of_middle * ((1 - first) * a1 + first * a2))) - (x1 - x0);
    return max(abs(dv) * allowed.stay, abs(dx));
  };
  const real worst = max(off(from.x, from.vx, before.ax, early.ax, late.ax, to.x, to.vx, behind.ax),
                         off(from.z, from.vz, before.az, early.az, late.az, to.z, to.vz, behind.az));
  real whole = h;
  if (s.shape.jumps()) {
    const mask jumped = fma(before.ax, behind.ax, before.az * behind.az) < broadcast(0);
    whole = select(jumped, h + steering::of_jump * allowed.stay, h);
  }
  return worst / (allowed.drift * whole);
}

/// The chamber's wall, in the magnet's frame.
struct Surrounding {
  double x, z, radius;
  RABILINE_LANES mask is_beyond(real px, real pz) const {
    const real dx = px - x, dz = pz - z;
    return fma(dx, dx, dz * dz) > broadcast(radius * radius);
  }
  /// Which lanes met it in a step, on the chord, before a pole.
  RABILINE_LANES mask is_met(const Steering& s, mask chosen, const Across& from, const Across& to) const {
    const mask meets = chosen & is_beyond(to.x, to.z);
    if (!any(meets)) return meets;
    const auto along = [&](const auto& asked) {
      return first_place(broadcast(0), broadcast(1), [&](real share) {
        return asked(fma(share, to.x - from.x, from.x), fma(share, to.z - from.z, from.z));
      });
    };
    const real wall = along([&](real px, real pz) { return is_beyond(px, pz); }),
               pole = along([&](real px, real pz) { return ~is_free<mask>(s.walls, px, pz); });
    return meets & ~(~is_free<mask>(s.walls, to.x, to.z) & (pole < wall));
  }
};

/// Flies lanes through the magnet; returns which of them came through, or to the chamber's wall: these have
/// met it.
RABILINE_LANES mask through(const Steering& s, const Fall& fall, words level, real part, mask flying,
                            real stay, const Surrounding& chamber, Across& at, mask& met) {
  const auto outside_walls = [&] { return is_free<mask>(s.walls, at.x, at.z); };
  flying = flying & outside_walls();
  const double share = s.share();
  const real least = stay * (1 / steering::most_steps / share), hair = least * steering::hair;
  const Allowed allowed{(0.1 * s.tolerance) * (s.end - s.begin) / stay, stay * (1 / share)};
  const double fine = steering::most_fine * share,
               most_fine = fine > steering::fewest_fine ? fine : steering::fewest_fine;
  real left = select(flying, stay, broadcast(0)), longest = broadcast(__builtin_inf());
  Force force = force_at(s, fall, level, part, at);
  for (double taken = 0; any(left > broadcast(0)); ++taken) {
    const mask goes = left > broadcast(0);
    const real finest = taken < most_fine ? hair : least;
    const NextStep next = next_step(s, force, at, left, least, finest);
    const real h = select(goes, min(next.length, longest), broadcast(0));
    const Across from = at;
    const Force before = force;
    step(s, fall, level, part, h, at, force);
    real done = h;
    longest = broadcast(__builtin_inf());
    const mask unsure = goes & may_be_off(s, before, at, force, next.rate2, h, allowed);
    if (any(unsure)) {
      const real error = error_of(s, fall, level, part, from, before, at, force, h, allowed);
      const mask rejected = unsure & (error > broadcast(1)) & (h > finest);
      const real better = h * max(broadcast(0.1), min(broadcast(4), 0.9 / sqrt(sqrt(error))));
      longest = select(unsure, max(better, finest), longest);
      done = select(rejected, broadcast(0), h);
      at = {select(rejected, from.x, at.x), select(rejected, from.z, at.z), select(rejected, from.vx, at.vx),
            select(rejected, from.vz, at.vz)};
      force = {select(rejected, before.ax, force.ax), select(rejected, before.az, force.az),
               select(rejected, before.rate, force.rate),
               select(rejected, before.sharpness, force.sharpness)};
    }
    if (s.chamber < __builtin_inf()) met = met | chamber.is_met(s, goes & flying, from, at);
    flying = flying & (outside_walls() | ~goes | met);
    left = select(goes & flying & ~met & (done < left), left - done, broadcast(0));
  }
  return flying;
}

}  // namespace

std::uint64_t steer(const Steering& s, BatchView& batch) {
  words stopped = words{};
  const Fall fall{batch.fall.x * s.cosine - batch.fall.z * s.sine,
                  batch.fall.x * s.sine + batch.fall.z * s.cosine};  // in the magnet's frame
  const Surrounding chamber{s.z0 * s.sine - s.x0 * s.cosine, s.shape.height - s.x0 * s.sine - s.z0 * s.cosine,
                            s.chamber};
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words was_flying = load(batch.flying + i);
    const mask flies = (mask)was_flying;
    const OnPlane straight = to_plane(s.end, batch, i);
    const real x = load(batch.x + i), z = load(batch.z + i), vx = load(batch.vx + i), vz = load(batch.vz + i);
    store(batch.t + i, load(batch.t + i) + straight.dt);
    if (s.chamber < __builtin_inf()) store(batch.scratch + i, words{});
    fall_for(straight.dt, batch, i);  // what does not fly any more
    if (!any(flies)) {
      store(batch.x + i, straight.x);
      store(batch.z + i, straight.z);
      continue;
    }
    const words level = select(flies, load(batch.level + i), words{});
    const real part = s.levels > 0
                          ? fma(number_of(level), broadcast(-2.0 / (s.levels - 1)), broadcast(1))
                          : fma(load(batch.sx + i), broadcast(s.axis_x), load(batch.sz + i) * s.axis_z);
    const auto across = [&](real u, real v) { return fma(u, broadcast(s.cosine), -(v * s.sine)); };
    const auto up = [&](real u, real v) { return fma(u, broadcast(s.sine), v * s.cosine); };
    Across at{across(x - s.x0, z - s.z0), up(x - s.x0, z - s.z0) + s.shape.height, across(vx, vz),
              up(vx, vz)};
    mask met{};
    const mask came = through(s, fall, level, part, flies, straight.dt, chamber, at, met);
    if (any(met)) store(batch.scratch + i, (words)met & wall_mark::of_chamber);
    stopped = stopped + (load(batch.weight + i) & was_flying & ~(words)came);
    store(batch.flying + i, was_flying & (words)came);
    at.z = at.z - s.shape.height;
    const auto back_x = [&](real u, real v) { return fma(u, broadcast(s.cosine), v * s.sine); };
    const auto back_z = [&](real u, real v) { return fma(v, broadcast(s.cosine), -(u * s.sine)); };
    store(batch.x + i, select(flies, back_x(at.x, at.z) + s.x0, straight.x));
    store(batch.z + i, select(flies, back_z(at.x, at.z) + s.z0, straight.z));
    store(batch.vx + i, select(flies, back_x(at.vx, at.vz), load(batch.vx + i)));
    store(batch.vz + i, select(flies, back_z(at.vx, at.vz), load(batch.vz + i)));
  }
  batch.y = s.end;
  return sum_of_lanes(stopped);
}

}  // namespace rabiline::RABILINE_ISA
