#pragma once
// The fields that a particle meets on a straight path, for kernels only.
#include "transport/level_wave_lanes.hpp"
#include "transport/plane_lanes.hpp"
#include "transport/shaped_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Eight particles that leave `place` at the time t, and the fields of a course on their ways.
class LevelPath {
 public:
  LevelPath(const LevelCourse& course, const RandomKey& key, double y, const Vector& place,
            const Vector& velocity, real t, const Fall& fall, words particle)
      : course_(course),
        key_(key),
        y_(y),
        place_(place),
        velocity_(velocity),
        t_(t),
        fall_(fall),
        particle_(particle) {}

  /// Draws the phases of a section's drives, all of which are on.
  inline void enter(const CourseSection& section) {
    for (int i = 0; i < section.field.drives; ++i) {
      phases_[i] = oscillator_phase(section.field.drive[i], key_, particle_);
      on_[i] = ~mask{};
    }
    if (section.wave < 0) return;
    const LevelWave& wave = course_.waves[section.wave];
    for (int i = 0; i < wave.drives; ++i) {
      wave_phases_[i] = oscillator_phase(wave.drive[i], key_, particle_);
      wave_on_[i] = ~mask{};
    }
  }
  /// Lanes for which pulses of a section's drives are switched at s, a surface is met where its field jumps,
  /// or which begin to be followed there: until when all stays so, `end` at the latest.
  inline real switch_fields(const CourseSection& section, real s, real end, mask lanes) {
    const real until = next_face(section, s, switch_pulses(section, s, end, lanes));
    from_ = select(lanes, s, from_);
    until_ = select(lanes, until, until_);
    return until;
  }
  /// Of its first drive, at t = 0.
  inline real phase() const { return phases_[0]; }
  /// Whether any of its whole fields drives, as they are switched now.
  inline mask is_driven(const CourseSection& section) const {
    mask on{};
    for (int i = 0; i < section.field.drives; ++i) on = on | on_[i];
    return on;
  }
  /// When they are at a place along the beam, from the time t on.
  inline real time_at(double y) const { return (y - broadcast(y_)) * (1.0 / velocity_.y); }
  inline real speed() const { return velocity_.y; }
  inline real clock(real s) const { return t_ + s; }

  [[gnu::noinline]] inline FieldAtTime field_at(const CourseSection& section, real s) const {
    const Vector r = place_at(s), v = velocity_at(s);
    FieldAtTime at{uniform_in(section), {broadcast(0), broadcast(0), broadcast(0)}};
    for (int i = 0; i < section.field.drives; ++i)
      add_drive(section.field.drive[i], phases_[i], on_[i], t_ + s, r, v, at);
    if (section.shaped_begin == section.shaped_end) return at;
    FieldHere<real> field{};
    const real known = inside(section, s, 1);
    const Vector place = place_at(known);
    Vector rate{broadcast(0), broadcast(0), broadcast(0)};
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      rate = add(rate, broadcast(1),
                 add_field_at(course_.shaped[i], section.field, phases_, t_ + s, place, field));
    rate = add(rate, broadcast(1), along(field, v));
    at.b = add(at.b, broadcast(1), {field.field[0], field.field[1], field.field[2]});
    at.b = add(at.b, inside(section, s, beside_face) - known, rate);
    at.rate = add(at.rate, broadcast(1), rate);
    return at;
  }

  /// [T] Of what stands still.
  [[gnu::noinline]] inline Vector static_at(const CourseSection& section, real s) const {
    FieldHere<real> field{};
    const real known = inside(section, s, 1);
    const Vector place = place_at(known);
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      if (!course_.shaped[i].moves())
        add_field_at(course_.shaped[i], section.field, phases_, t_ + s, place, field);
    const Vector b = add(uniform_in(section), broadcast(1), {field.field[0], field.field[1], field.field[2]});
    return add(b, inside(section, s, beside_face) - known, along(field, velocity_at(s)));
  }

  /// Whether a field of no more than this size turns levels by next to nothing in that time.
  inline mask is_unfelt(real size, real time) const {
    return size * (electron_rate * time) < broadcast(1e-3 * course_.tolerance);
  }

  /// How long a static field that rises from nothing, or falls to it, is too weak to be felt, `sign` of time
  /// from s on, for half of `rest` at the most: its direction may turn within nanometres there. Asked from s
  /// on, since it may be nothing farther on again; next to 0 where it is felt at once.
  [[gnu::noinline]] inline real unfelt(const CourseSection& section, real s, double sign, real rest) const {
    constexpr double least = 1e-12;  // of `rest`
    real found = broadcast(0);
    if (section.moves() || section.wave >= 0 || section.shaped_begin == section.shaped_end) return found;
    mask weak = ~mask{};
    for (real time = least * rest; any(weak); time = 4.0 * time) {
      const real size = length_of(static_at(section, fma(time, broadcast(sign), s)));
      weak = weak & (time < 0.5 * rest) & is_unfelt(size, time);
      found = select(weak, time, found);
    }
    return found;
  }

  [[gnu::noinline]] inline Wave wave_at(const LevelWave& wave, real s) const {
    return RABILINE_ISA::wave_at(wave, wave_phases_, wave_on_, t_ + s, place_at(s));
  }

 private:
  static inline Vector uniform_in(const CourseSection& section) {
    const real rate = broadcast(section.field.spin_rate), zero = broadcast(0);
    return section.field.turned ? times(rate, third_axis(section.field)) : Vector{zero, zero, rate};
  }
  /// What drives at the time t at r, seen by a particle with the velocity v; its spin_rate is a field [T].
  static inline void add_drive(const DriveTerm& drive, real phase, mask on, real t, const Vector& r,
                               const Vector& v, FieldAtTime& at) {
    const Phasor p = phasor(angle_at(drive, phase, t, r));
    const Slopes& slopes = drive.slopes;
    real turning =
        fma(broadcast(drive.twist), v.y,
            fma(broadcast(slopes.phase_x), v.x, fma(broadcast(slopes.phase_z), v.z, broadcast(drive.omega))));
    if (drive.sweep.rate != 0) turning = turning + swept_rate(drive.sweep, t);
    const real field = select(on, broadcast(drive.spin_rate), broadcast(0)),
               beside = fma(broadcast(slopes.size_x), r.x - slopes.x,
                            fma(broadcast(slopes.size_z), r.z - slopes.z, broadcast(1))),
               growing = fma(broadcast(slopes.size_x), v.x, broadcast(slopes.size_z) * v.z);
    const ShareHere along = share_here(drive.envelope, r.y);
    const real size = field * along.share * beside,
               rate = field * fma(along.slope * v.y, beside, along.share * growing), turn = size * turning;
    const auto add_up = [&](real first, real second, Vector& sum) {
      const double *a = drive.first, *b = drive.second;
      sum = {fma(first, broadcast(a[0]), fma(second, broadcast(b[0]), sum.x)),
             fma(first, broadcast(a[1]), fma(second, broadcast(b[1]), sum.y)),
             fma(first, broadcast(a[2]), fma(second, broadcast(b[2]), sum.z))};
    };
    add_up(size * p.c, size * p.s, at.b);
    add_up(fnma(turn, p.s, rate * p.c), fma(turn, p.c, rate * p.s), at.rate);
  }
  inline real switch_pulses(const CourseSection& section, real s, real end, mask lanes) {
    // A pulse that rounding leaves just ahead begins at once.
    const real now = t_ + s, latest = t_ + end, from = fma(abs(now), broadcast(1e-14), now);
    const DriveTerm* waves = section.wave < 0 ? nullptr : course_.waves[section.wave].drive;
    const int count = section.wave < 0 ? 0 : course_.waves[section.wave].drives;
    real next = latest;
    for (int i = 0; i < section.field.drives; ++i) next = next_change(section.field.drive[i], from, next);
    for (int i = 0; i < count; ++i) next = next_change(waves[i], from, next);
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      if (const TimeCourse& course = course_.shaped[i].course; course.nodes > 0)
        next = next_stop<LaneMaths>(course, from, next);
    const real middle = 0.5 * (from + next);
    const auto put = [&](const DriveTerm* drive, int drives, mask* on) {
      for (int i = 0; i < drives; ++i)
        if (drive[i].gate.begin != drive[i].gate.end)
          on[i] = (is_on(drive[i].gate, middle) & lanes) | (on[i] & ~lanes);
    };
    put(section.field.drive, section.field.drives, on_);
    put(waves, count, wave_on_);
    return select(next < latest, next - t_, end);
  }
  inline real next_face(const CourseSection& section, real s, real end) const {
    const Vector r = place_at(s), v = velocity_at(s);
    const real place[3] = {r.x, r.y, r.z}, velocity[3] = {v.x, v.y, v.z},
               bend = broadcast(__builtin_sqrt(fall_.x * fall_.x + fall_.z * fall_.z)),
               soonest = 2.0 * hair(section), rest = end - s;
    real face = rest;
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      face = time_to_face<LaneMaths>(course_.shaped[i], place, velocity, bend, soonest, face);
    return select(face < rest, s + face, end);
  }
  /// [s]
  inline real hair(const CourseSection& section) const { return section.hair() * (1.0 / velocity_.y); }
  inline Vector place_at(real s) const {
    return {fma(fma(0.5 * s, broadcast(fall_.x), velocity_.x), s, place_.x),
            fma(velocity_.y, s, broadcast(y_)),
            fma(fma(0.5 * s, broadcast(fall_.z), velocity_.z), s, place_.z)};
  }
  /// s, no nearer than so many hairs to a face where the field jumps: on it, rounding would decide on which
  /// side. From one hair inside nearly to the face the field goes on straight: what rises from there may turn
  /// within as little.
  static constexpr double beside_face = 1e-3;
  inline real inside(const CourseSection& section, real s, double hairs) const {
    const real away = hairs * hair(section);
    return max(from_ + away, min(until_ - away, s));
  }
  /// [T/s] By which a field changes along the way.
  static inline Vector along(const FieldHere<real>& field, const Vector& v) {
    const real* g = field.slope;
    return {dot({g[0], g[1], g[2]}, v), dot({g[3], g[4], g[5]}, v), dot({g[6], g[7], g[8]}, v)};
  }
  inline Vector velocity_at(real s) const {
    return {fma(broadcast(fall_.x), s, velocity_.x), velocity_.y, fma(broadcast(fall_.z), s, velocity_.z)};
  }

  const LevelCourse& course_;
  const RandomKey& key_;
  const double y_;
  const Vector place_, velocity_;
  const real t_;
  const Fall fall_;
  const words particle_;
  real phases_[most_drives], wave_phases_[most_drives];
  mask on_[most_drives], wave_on_[most_drives];
  real from_{}, until_{};  // no field jumps between them
};

}  // namespace rabiline::RABILINE_ISA
