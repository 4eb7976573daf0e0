// How particles start: places, speeds, directions, weights, spins, times.
#include "transport/emission_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

RABILINE_LANES real speed_number(const SpeedDraw& s, real normal) {
  return fma(normal, broadcast(s.sigma), broadcast(s.centre));
}
/// The parameters by value: a pointer to them would keep emit from holding them in registers.
[[gnu::noinline]] real redrawn(SpeedDraw s, RandomKey key, words particle, real q) {
  for (unsigned draw = 1; any(q <= broadcast(s.least)); ++draw) {
    real u1, normal, unused;
    const real u0 = uniform_pair(particle, key, purpose::speed, draw, u1);
    normal_pair(u0, u1, normal, unused);
    q = select(q <= broadcast(s.least), speed_number(s, normal), q);
  }
  return q;
}
/// A normal law: two particles share the two numbers of one draw. What is not above the least is drawn again,
/// for itself.
RABILINE_LANES void draw_normal_numbers(const SpeedDraw& s, const RandomKey& key, BatchView& batch) {
  constexpr int room = Batch::capacity + 2 * lane_count;
  alignas(64) double u0[room / 2], u1[room / 2], normal[room];
  const unsigned long long first = batch.particle[0];
  const int second_of_two = static_cast<int>(first & 1), pairs = (batch.padded + second_of_two + 1) / 2;
  for (int i = 0; i < pairs; i += lane_count) {
    real second;
    const words pair = lane_numbers() + ((first >> 1) + static_cast<unsigned long long>(i));
    store(u0 + i, uniform_pair(pair, key, purpose::speeds_of_two, 0, second));
    store(u1 + i, second);
  }
  for (int i = 0; i < pairs; i += lane_count) {
    real even, odd, low, high;
    normal_pair(load(u0 + i), load(u1 + i), even, odd);
    interleave(even, odd, low, high);
    store(normal + 2 * i, low);
    store(normal + 2 * i + lane_count, high);
  }
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real q = speed_number(s, load_anywhere(normal + second_of_two + i));
    const bool again = any(q <= broadcast(s.least));
    store(batch.vy + i, again ? redrawn(s, key, load(batch.particle + i), q) : q);
  }
}
/// Thermal laws, y = v/alpha. Flux 2 y^3 exp(-y^2): y^2 is the sum of two exponential variables. Density
/// (4/sqrt(pi)) y^2 exp(-y^2): of one and half the square of a normal one, since y^2 has three degrees of
/// freedom.
[[gnu::noinline]] void draw_other_numbers(const SpeedDraw& s, const RandomKey& key, BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words particle = load(batch.particle + i);
    real u1, q;
    const real u0 = uniform_pair(particle, key, purpose::speed, 0, u1);
    if (s.kind == SpeedKind::effusive) {
      q = sqrt(-log(u0 * u1));
    } else if (s.kind == SpeedKind::maxwell) {
      real v1, normal, unused;
      const real v0 = uniform_pair(particle, key, purpose::speed, 1, v1);
      normal_pair(v0, v1, normal, unused);
      q = sqrt(fma(normal * 0.5, normal, -log(u0)));
    } else {
      q = drawn_from(s.table, u0);
    }
    store(batch.vy + i, q);
  }
}
[[gnu::noinline]] void convert_to_speeds(const SpeedDraw& s, BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real q = load(batch.vy + i);
    store(batch.vy + i, s.scale == SpeedScale::proportional ? q * s.factor
                        : s.scale == SpeedScale::inverse    ? s.factor / q
                                                            : sqrt(q * s.factor));
  }
}
RABILINE_LANES void draw_speeds(const SpeedDraw& s, const RandomKey& key, BatchView& batch) {
  if (s.kind == SpeedKind::single)
    for (int i = 0; i < batch.padded; i += lane_count) store(batch.vy + i, broadcast(s.mean));
  else if (s.kind == SpeedKind::gaussian)
    draw_normal_numbers(s, key, batch);
  else
    draw_other_numbers(s, key, batch);
  if (s.scale != SpeedScale::proportional || s.factor != 1) convert_to_speeds(s, batch);
}

/// Slopes dx/dy and dz/dy, from the place of emission.
RABILINE_LANES void draw_slopes(const Emission& e, words particle, real x, real z, real& slope_x,
                                real& slope_z) {
  slope_x = slope_z = broadcast(0);
  if (e.direction.kind == DirectionKind::parallel) return;
  if (e.direction.kind == DirectionKind::gaussian) {
    real u1;
    const real u0 = uniform_pair(particle, e.key, purpose::direction, 0, u1);
    normal_pair(u0, u1, slope_x, slope_z);
    slope_x = slope_x * e.direction.spread_x;
    slope_z = slope_z * e.direction.spread_z;
    return;
  }
  real u1;
  const real u0 = uniform_pair(particle, e.key, purpose::direction, 0, u1);
  if (e.direction.kind == DirectionKind::cone) {
    const real below = u0 * e.direction.spread_x, cosine = 1.0 - below;  // below = 1 - cos(theta)
    const real tangent = sqrt(below * (1.0 + cosine)) / cosine;
    const Phasor p = phasor(u1 * two_pi);
    slope_x = tangent * p.c;
    slope_z = tangent * p.s;
    return;
  }
  real target_x, target_z;
  draw_point(e.target, u0, u1, target_x, target_z);
  slope_x = (target_x - x) / broadcast(e.target.y);
  slope_z = (target_z - z) / broadcast(e.target.y);
}

RABILINE_LANES void draw_places(const Aperture& opening, const double* u0, const double* u1,
                                BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    real x, z;
    draw_point(opening, load(u0 + i), load(u1 + i), x, z);
    store(batch.x + i, x);
    store(batch.z + i, z);
  }
}

/// Levels have their spin's image at +z, where the last batch may have left it.
[[gnu::noinline]] void turn_up(BatchView& batch) {
  batch.up = true;
  for (int i = 0; i < Batch::capacity; i += lane_count) {
    store(batch.sx + i, broadcast(0));
    store(batch.sy + i, broadcast(0));
    store(batch.sz + i, broadcast(1));
  }
}
/// A particle starts in some level, or with its spin anywhere on the sphere.
RABILINE_LANES void draw_spins(const SpinDraw& spin, const double* u0, const double* u1, BatchView& batch) {
  const real zero = broadcast(0), one = broadcast(1);
  for (int i = 0; i < batch.padded; i += lane_count) {
    words level = words{};
    for (int k = 1; k < spin.levels; ++k)
      level = level + select(load(u0 + i) >= broadcast(static_cast<double>(k) / spin.levels),
                             broadcast_word(1), words{});
    store(batch.level + i, level);
    store(batch.prepared + i, level);
  }
  if (spin.levels > 0) return;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real z = fma(load(u0 + i), broadcast(2), broadcast(-1)), across = sqrt(max(fma(-z, z, one), zero));
    const Phasor p = phasor(load(u1 + i) * two_pi);
    store(batch.sx + i, across * p.c);
    store(batch.sy + i, across * p.s);
    store(batch.sz + i, z);
  }
}

/// What begins alike for all.
RABILINE_LANES void begin_columns(BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words index = lane_numbers() + static_cast<unsigned long long>(i);
    store(batch.t + i, broadcast(0));
    store(batch.flying + i, (words)(index < broadcast_word(static_cast<unsigned long long>(batch.count))));
    store(batch.caught_by + i, words{});
  }
}

/// Isotropic emission towards a plane at distance D: dOmega = cos^3(theta) dA / D^2, as quanta of the axial
/// value.
RABILINE_LANES words weight_of(const Emission& e, real cosine) {
  if (e.direction.kind != DirectionKind::aimed) return broadcast_word(quanta_per_particle);
  return quanta_of(cosine * cosine * cosine);
}

/// Gives a speed, which stands in vy, its direction, and the particle its weight.
RABILINE_LANES void direct(const Emission& e, int i, BatchView& batch) {
  real slope_x, slope_z, cosine = broadcast(1);
  draw_slopes(e, load(batch.particle + i), load(batch.x + i), load(batch.z + i), slope_x, slope_z);
  if (e.direction.kind != DirectionKind::parallel)
    cosine = 1.0 / sqrt(fma(slope_x, slope_x, fma(slope_z, slope_z, broadcast(1))));
  const real vy = load(batch.vy + i) * cosine;
  store(batch.slowness + i, 1.0 / vy);
  store(batch.vx + i, vy * slope_x);
  store(batch.vy + i, vy);
  store(batch.vz + i, vy * slope_z);
  store(batch.weight + i, weight_of(e, cosine) & load(batch.flying + i));
}

/// Directions that `direct` knows.
bool is_common(const Emission& e) {
  const bool known = e.direction.kind == DirectionKind::parallel ||
                     e.direction.kind == DirectionKind::gaussian || e.direction.kind == DirectionKind::cone,
             aimed = e.direction.kind == DirectionKind::aimed &&
                     e.direction.aimed_law == AimedLaw::isotropic && e.fall == Fall{};
  return (known || aimed) && !e.tilted;
}

// ---- what few sources ask for ----

/// Places without an edge.
[[gnu::noinline]] void draw_spot(const Emission& e, BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    real u1, x, z;
    const real u0 = uniform_pair(load(batch.particle + i), e.key, purpose::spot, 0, u1);
    normal_pair(u0, u1, x, z);
    store(batch.x + i, fma(x, broadcast(e.spot_x), broadcast(e.opening.x0)));
    store(batch.z + i, fma(z, broadcast(e.spot_z), broadcast(e.opening.z0)));
  }
}

/// A direction of length 1 about +y.
Vector draw_direction(const Emission& e, words particle, real x, real z) {
  real slope_x, slope_z;
  real u1;
  const real u0 = uniform_pair(particle, e.key, purpose::direction, 0, u1);
  if (e.direction.kind == DirectionKind::channel) {
    real sine, cosine;
    sincos(drawn_from(e.direction.angles, u0), sine, cosine);
    const Phasor p = phasor(u1 * two_pi);
    return {sine * p.c, max(cosine, broadcast(1e-9)), sine * p.s};
  }
  if (e.direction.kind == DirectionKind::cosine) {  // sin^2(theta) is uniform
    const real square = u0 * e.direction.spread_x, sine = sqrt(square);
    const Phasor p = phasor(u1 * two_pi);
    return {sine * p.c, sqrt(1.0 - square), sine * p.s};
  }
  if (e.direction.kind == DirectionKind::box) {
    slope_x = fma(u0, broadcast(2), broadcast(-1)) * e.direction.spread_x;
    slope_z = fma(u1, broadcast(2), broadcast(-1)) * e.direction.spread_z;
  } else {
    draw_slopes(e, particle, x, z, slope_x, slope_z);
  }
  const real cosine = 1.0 / sqrt(fma(slope_x, slope_x, fma(slope_z, slope_z, broadcast(1))));
  return {slope_x * cosine, cosine, slope_z * cosine};
}

/// A direction of length 1 towards a point of the target, in free fall along the lower of both parabolas:
/// with the way d, |d - g T^2/2| = v T after the time T. `share` is what falling does to the density per area
/// of the target, 1/(1 + d_y (g . slope)/v^2), from x = slope d_y + g d_y^2 (1 + slope^2)/(2 v^2); at most 2,
/// and 0 out of reach.
Vector aim(const Emission& e, words particle, real x, real z, real speed, real& share) {
  real u1, target_x, target_z;
  const real u0 = uniform_pair(particle, e.key, purpose::direction, 0, u1);
  draw_point(e.target, u0, u1, target_x, target_z);
  const real dx = target_x - x, dz = target_z - z, dy = broadcast(e.target.y), one = broadcast(1),
             gx = broadcast(e.fall.x), gz = broadcast(e.fall.z), v2 = speed * speed;
  const real g2 = fma(gx, gx, gz * gz), d2 = fma(dx, dx, fma(dy, dy, dz * dz)),
             with_fall = fma(dx, gx, fma(dz, gz, v2)), square = fnma(g2, d2, with_fall * with_fall);
  const mask reached = (square >= broadcast(0)) & (with_fall > broadcast(0));
  const real half_t2 =
      select(reached, d2 / select(reached, with_fall + sqrt(max(square, broadcast(0))), one), broadcast(0));
  const real slope_x = fnma(gx, half_t2, dx) / dy, slope_z = fnma(gz, half_t2, dz) / dy,
             spread = fma(dy / v2, fma(gx, slope_x, gz * slope_z), one);
  share = select(reached, 1.0 / max(spread, broadcast(0.5)), broadcast(0));
  const real cosine = 1.0 / sqrt(fma(slope_x, slope_x, fma(slope_z, slope_z, one)));
  return {slope_x * cosine, cosine, slope_z * cosine};
}

/// Directions and weights of all the sources that `direct` does not know.
[[gnu::noinline]] void direct_otherwise(const Emission& e, BatchView& batch) {
  const bool aimed = e.direction.kind == DirectionKind::aimed;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real speed = load(batch.vy + i);
    const words particle = load(batch.particle + i);
    const real x = load(batch.x + i), z = load(batch.z + i);
    real share = broadcast(1);
    Vector d = aimed ? aim(e, particle, x, z, speed, share) : draw_direction(e, particle, x, z);
    words weight = broadcast_word(quanta_per_particle);
    if (aimed)
      weight = quanta_of(min(broadcast(1), relative_density(e, d)) * d.y * d.y * d.y * share);
    else if (e.tilted)
      d = tilted(e, d);
    store(batch.slowness + i, 1.0 / (speed * d.y));
    store(batch.vx + i, speed * d.x);
    store(batch.vy + i, speed * d.y);
    store(batch.vz + i, speed * d.z);
    store(batch.weight + i, weight & load(batch.flying + i));
  }
}

/// Spins along an axis: |m> along it for levels, whose image of the axis the batch then holds; else S with
/// the component m/I along it.
[[gnu::noinline]] void draw_prepared_spins(const SpinDraw& spin, const double* first, const double* second,
                                           BatchView& batch) {
  const double* axis = spin.axis;
  // Two directions across the axis a: b = a x (the unit vector least along it), c = a x b.
  const double least_x = __builtin_fabs(axis[0]) < 0.6 ? 1 : 0, least_y = 1 - least_x;
  double bx = -axis[2] * least_y, by = axis[2] * least_x, bz = axis[0] * least_y - axis[1] * least_x;
  const double length = __builtin_sqrt(bx * bx + by * by + bz * bz);
  bx /= length, by /= length, bz /= length;
  const double cx = axis[1] * bz - axis[2] * by, cy = axis[2] * bx - axis[0] * bz,
               cz = axis[0] * by - axis[1] * bx;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const real u0 = load(first + i), u1 = load(second + i);
    words level = words{};
    real along = broadcast(spin.along[0]);
    for (int k = 1; k < spin.steps; ++k) {
      const mask beyond = u0 >= broadcast(spin.cumulative[k - 1]);
      level = level + select(beyond, broadcast_word(1), words{});
      along = select(beyond, broadcast(spin.along[k]), along);
    }
    const bool levels = spin.kind == SpinKind::levels;
    if (levels) along = broadcast(1);
    const real across = sqrt(max(fma(-along, along, broadcast(1)), broadcast(0)));
    const Phasor p = phasor(u1 * two_pi);
    const real b = across * p.c, c = across * p.s;
    store(batch.sx + i, fma(along, broadcast(axis[0]), fma(b, broadcast(bx), c * cx)));
    store(batch.sy + i, fma(along, broadcast(axis[1]), fma(b, broadcast(by), c * cy)));
    store(batch.sz + i, fma(along, broadcast(axis[2]), fma(b, broadcast(bz), c * cz)));
    store(batch.level + i, levels ? level : words{});
    store(batch.prepared + i, levels ? level : words{});
  }
}

/// The smallest adiabaticity on the way, so far none.
[[gnu::noinline]] void begin_watch(BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count) {
    store(batch.adiabaticity + i, broadcast(no_turning));
    store(batch.adiabaticity_y + i, broadcast(0));
  }
}

[[gnu::noinline]] void draw_times(const Emission& e, BatchView& batch) {
  for (int i = 0; i < batch.padded; i += lane_count)
    store(batch.t + i, start_time(e.pulse, e.key, load(batch.particle + i)));
}

}  // namespace

// One short loop for each thing that is drawn: a processor holds several rounds of each at a time. The copies
// show the compiler that parameters do not change while columns are written; they are not handed on, or it
// could not keep them in registers.
void emit(const Emission& emission, std::uint64_t first_particle, BatchView& view) {
  view.y = 0;
  view.fall = emission.fall;
  const Emission e = emission;
  BatchView batch = view;
  alignas(64) double u[4][Batch::capacity];
  for (int i = 0; i < batch.padded; i += lane_count) {
    const words particle = lane_numbers() + (static_cast<unsigned long long>(first_particle) +
                                             static_cast<unsigned long long>(i));
    store(batch.particle + i, particle);
    const RandomBlock block = random_block(particle, e.key.seed, purpose::place_and_spin, 0, e.key.stream);
    store(u[0] + i, coarse_uniform(block.c0));
    store(u[1] + i, coarse_uniform(block.c1));
    store(u[2] + i, coarse_uniform(block.c2));
    store(u[3] + i, coarse_uniform(block.c3));
  }
  draw_places(e.opening, u[0], u[1], batch);
  begin_columns(batch);
  if (e.gaussian_spot) draw_spot(emission, view);
  if (e.pulse.kind != PulseKind::none) draw_times(emission, view);
  draw_speeds(e.speed, e.key, batch);
  if (is_common(emission))
    for (int i = 0; i < batch.padded; i += lane_count) direct(e, i, batch);
  else
    direct_otherwise(emission, view);
  if (e.watches_turning) begin_watch(view);
  const bool in_levels = e.spin.kind == SpinKind::unpolarised && e.spin.levels > 0;
  if (!in_levels)
    view.up = false;
  else if (!view.up)
    turn_up(view);
  if (e.spin.kind == SpinKind::unpolarised)
    draw_spins(e.spin, u[2], u[3], batch);
  else
    draw_prepared_spins(e.spin, u[2], u[3], view);
}

}  // namespace rabiline::RABILINE_ISA
