// Magnets whose force depends on the place: stepped paths.
#include "transport/moment_lanes.hpp"
#include "transport/plane_lanes.hpp"
#include "transport/stages/steering.hpp"

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

/// `part` is m/I or S_z where the moment is constant.
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

/// [s] of the next step: what is left in equal steps, none longer than the force allows, none shorter than
/// `least`. Where the force jumps ahead of a lane that comes back there seldom, steps end just short of it
/// and a last, tiny one crosses it.
RABILINE_LANES real next_step(const Steering& s, const Force& force, const Across& at, real left,
                              real least) {
  const real rate = sqrt(fma(fma(at.vx, at.vx, at.vz * at.vz), force.sharpness, force.rate));
  real finest = least, until = left;
  if (s.shape.jumps()) {
    const Jump jump = next_jump(s, force, at);
    const mask seldom =
        jump.speed > steering::seldom * least * sqrt(fma(force.ax, force.ax, force.az * force.az));
    finest = select(seldom, least * steering::hair, least);
    until = select(seldom, max(finest, jump.time * (1 - 1.0 / 64)), left);
  }
  const real steps = min(left * rate * (1 / steering::step_angle), left / finest);
  return min(left / max(broadcast(1), -floor(-steps)), until);
}

/// Flies lanes through the magnet; returns which of them came through.
RABILINE_LANES mask through(const Steering& s, const Fall& fall, words level, real part, mask flying,
                            real stay, Across& at) {
  const auto outside_walls = [&] { return is_free<mask>(s.walls, at.x, at.z); };
  flying = flying & outside_walls();
  const real least = stay * (1 / steering::most_steps);
  real left = select(flying, stay, broadcast(0));
  Force force = force_at(s, fall, level, part, at);
  while (any(left > broadcast(0))) {
    const mask goes = left > broadcast(0);
    const real h = select(goes, next_step(s, force, at, left, least), broadcast(0));
    step(s, fall, level, part, h, at, force);
    flying = flying & (outside_walls() | ~goes);
    left = select(goes & flying & (h < left), left - h, broadcast(0));
  }
  return flying;
}

}  // namespace

std::uint64_t steer(const Steering& s, BatchView& batch) {
  words stopped = words{};
  const Fall fall{batch.fall.x * s.cosine - batch.fall.z * s.sine,
                  batch.fall.x * s.sine + batch.fall.z * s.cosine};  // in the magnet's frame
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words was_flying = load(batch.flying + i);
    const mask flies = (mask)was_flying;
    const OnPlane straight = to_plane(s.end, batch, i);
    const real x = load(batch.x + i), z = load(batch.z + i), vx = load(batch.vx + i), vz = load(batch.vz + i);
    store(batch.t + i, load(batch.t + i) + straight.dt);
    fall_for(straight.dt, batch, i);  // what does not fly any more
    if (!any(flies)) {
      store(batch.x + i, straight.x);
      store(batch.z + i, straight.z);
      continue;
    }
    const words level = select(flies, load(batch.level + i), words{});
    const real part = s.levels > 0 ? fma(number_of(level), broadcast(-2.0 / (s.levels - 1)), broadcast(1))
                                   : load(batch.sz + i);
    const auto across = [&](real u, real v) { return fma(u, broadcast(s.cosine), -(v * s.sine)); };
    const auto up = [&](real u, real v) { return fma(u, broadcast(s.sine), v * s.cosine); };
    Across at{across(x - s.x0, z - s.z0), up(x - s.x0, z - s.z0) + s.shape.height, across(vx, vz),
              up(vx, vz)};
    const mask came = through(s, fall, level, part, flies, straight.dt, at);
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
