#pragma once
// Amplitudes of an atom's levels along a straight path through fields of any direction, for kernels only.
//
// In a frame whose third axis n follows +-B, from step to step without turning about n, H is that of
// LevelManifold. A step takes it at Lobatto's five points; of the polynomial through them five exponentials
// are of sixth order, and two of fourth, which tell the error (the commutator-free Magnus method: S. Blanes
// and P. Moan, Appl. Numer. Math. 56, 1519 (2006)). Where couplings are weak the polynomials of the energies
// are phases, and the exponentials are those of couplings that turn with them. Inside of a step the frame
// turns from n at the begin by the shortest way, which adds a turn about n. Where all couplings
// V_kl are weak against E_k - E_l the amplitudes are those of the states dressed by them, a' = exp(S) a with
// S_kl = V_kl/(E_k - E_l), and a step turns their phases alone, however many radians it is long.
#include "core/call_off.hpp"
#include "transport/level_period_lanes.hpp"
#include "transport/level_phase_lanes.hpp"
#include "transport/level_zero_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Particles on their way through a course, whose levels are of one manifold.
class LevelFlight {
  /// Within a step levels that are coupled turn by less against one another, and all of them in an
  /// exponential.
  static constexpr double most_turning = 8, most_phase = 44;
  /// A field that swings in this many times what coupled levels take to turn does not drive them.
  static constexpr double slow = 30;
  /// Of what levels turn by where no point of a step sees it, in its error.
  static constexpr double passing_share = 0.01;
  /// Of a section: over less a field that is too weak to be felt is not followed.
  static constexpr double shortest = 1e-7;
  /// On one section; 1e4 periods of what drives take some 1e5 to 1e6.
  static constexpr double most_steps = 1e8;

 public:
  Amplitudes a;

  LevelFlight(const LevelCourse& course, const LevelManifold& manifold, const LevelPath& path)
      : course_(course), f_(manifold), path_(path) {}

  /// From a level at the begin to the amplitudes of the levels at the end; `counted` are those that matter.
  [[gnu::noinline]] inline void fly(int from, mask counted) {
    for (int k = 0; k < f_.levels; ++k) {
      a.re[k] = broadcast(k == from ? 1 : 0);
      a.im[k] = broadcast(0);
    }
    const real zero = broadcast(0), one = broadcast(1);
    axes_ = {{zero, zero, one}, {one, zero, zero}};
    size_ = zero;
    for (int i = 0; i < course_.count; ++i)
      pass(course_.sections[i], i > 0 ? &course_.sections[i - 1] : nullptr, counted);
    const bool met = course_.ends_in_field && course_.behind > 0;
    const mask in_field = course_.ends_in_field && !met ? abs(size_) > broadcast(tiny) : mask{};
    const FollowedField z = followed({{zero, zero, one}, {zero, zero, zero}}, axes_);
    meet(z, met ? min(abs(size_), broadcast(course_.behind)) : zero, counted & ~in_field);
    reversed_ = (in_field & (size_ < zero)) | (~in_field & (z.signed_size < zero));
    lost_ = lost_ | (counted & ~(abs(norm() - 1.0) < broadcast(1e-6)));
  }
  /// Which could not be followed to the end: amplitudes that are no numbers, or not one in all, or steps too
  /// short to go on.
  mask lost() const { return lost_; }
  /// |a_k|^2, by the atom's levels.
  inline void probabilities(real* p, int levels) const {
    for (int n = 0; n < levels; ++n) p[n] = broadcast(0);
    const real sum = norm();
    for (int k = 0; k < f_.levels; ++k) {
      const real share = fma(a.re[k], a.re[k], a.im[k] * a.im[k]) / sum;
      p[f_.number[k]] = p[f_.number[k]] + select(reversed_, broadcast(0), share);
      p[f_.mirror[k]] = p[f_.mirror[k]] + select(reversed_, share, broadcast(0));
    }
  }

 private:
  /// The sum of |a_k|^2, which keeps to 1.
  inline real norm() const {
    real sum = broadcast(0);
    for (int k = 0; k < f_.levels; ++k) sum = fma(a.re[k], a.re[k], fma(a.im[k], a.im[k], sum));
    return sum;
  }
  /// Axes in no field are free: they turn to where the field that comes points, at the time s.
  inline void face_what_comes(const CourseSection& section, const FieldAtTime& field, real s, mask lanes,
                              FollowedField& here) {
    const mask nothing = lanes & (here.size < broadcast(tiny));
    if (!any(nothing)) return;
    turn_to(f_, followed(path_.field_at(section, s), axes_).n, broadcast(0), nothing, axes_, a);
    here = followed(field, axes_);
  }
  /// A static field is met, or met again behind a gap: its direction at once, in the weaker of both fields;
  /// its size as if it came slowly.
  inline void meet(const FollowedField& next, real weaker, mask lanes) {
    const real before = select(size_ < broadcast(0), -weaker, weaker),
               behind = select(next.signed_size < broadcast(0), -weaker, weaker);
    turn_to(f_, next.n, before, lanes, axes_, a);
    resize(f_, axes_, before, behind, course_.tolerance,
           lanes & ((before < broadcast(0)) != (behind < broadcast(0))), a);
  }
  /// The field is another one at once, and the state stays.
  inline void jump(const Vector& before, const FieldAtTime& field, mask lanes) {
    const FollowedField behind = followed(field, axes_);
    const real size = dot(before, axes_.third);
    turn_to(f_, behind.n, size, lanes, axes_, a);
    resize(f_, axes_, size, behind.signed_size, course_.tolerance, lanes, a);
  }
  /// Drives are switched at s, and the state stays, or static fields are met; until when that is not so
  /// again.
  [[gnu::noinline]] inline real switch_fields(const CourseSection& section, real s, real end, mask lanes) {
    const Vector none{broadcast(0), broadcast(0), broadcast(0)};
    const FieldAtTime before = path_.field_at(section, s);
    const Vector left = path_.static_at(section, s);
    const real until = path_.switch_fields(section, s, end, lanes);
    const FieldAtTime field = path_.field_at(section, s);
    const Vector met = path_.static_at(section, s);
    const mask meets = lanes & differ(met, left), jumps = lanes & (meets | differ(field.b, before.b));
    if (!any(jumps)) return until;
    const Amplitudes in_wave = a;
    if (section.wave >= 0) change_frame(f_, course_.waves[section.wave], path_.clock(s), -1, a);
    jump(before.b, field, jumps & ~meets);
    if (any(meets)) {
      jump(before.b, {left, none}, meets & differ(before.b, left));
      size_ = select(meets, dot(left, axes_.third), size_);
      const FollowedField next = followed({met, none}, axes_);
      meet(next, min(abs(size_), next.size), meets);
      jump(met, field, meets & differ(field.b, met));
    }
    if (section.wave >= 0) {
      change_frame(f_, course_.waves[section.wave], path_.clock(s), 1, a);
      choose(f_.levels, ~jumps, in_wave, a);
    }
    return until;
  }

  /// From s on, where fields begin, to where they are felt.
  [[gnu::noinline]] inline real start_felt(const CourseSection& section, real s, real until, mask lanes) {
    const real unfelt = select(lanes, path_.unfelt(section, s, 1, until - s), broadcast(0)),
               felt = s + unfelt;
    const mask waits = lanes & (felt > s);
    if (!any(waits)) return s;
    const Vector none{broadcast(0), broadcast(0), broadcast(0)};
    turn_to(f_, followed({path_.static_at(section, felt), none}, axes_).n, broadcast(0), waits, axes_, a);
    rest(f_, unfelt, a);
    return felt;
  }
  /// From where they are not felt any more, until they jump or end.
  inline real stop_felt(const CourseSection& section, real s, real until) const {
    return max(s, until - path_.unfelt(section, until, -1, until - s));
  }

  /// Lanes in which a field that passes by zero is followed along the axis, over which it is hardly felt.
  [[gnu::noinline]] inline mask pass_unfelt(const CourseSection& section, real s, real h, real allowed,
                                            mask lanes) {
    if (section.wave >= 0 || !any(lanes)) return mask{};
    Amplitudes passed = a;
    const AlongAxis there = follow_along_axis(f_, path_, section, s, h, axes_, lanes, passed);
    const mask weak = there.lanes & (there.error <= allowed);
    choose(f_.levels, weak, passed, a);
    jump(there.along, there.field, weak);
    return weak;
  }

  /// What exponentials and their bounds need of the manifold.
  inline const LevelManifold& coupled(const CourseSection& section) const {
    return section.wave < 0 ? f_ : course_.waves[section.wave].standing;
  }
  inline void matrix_of(const CourseSection& section, real s, const FollowedField& f, LevelMatrix& h) const {
    if (section.wave < 0) return set_matrix(f_, f, h);
    const LevelWave& wave = course_.waves[section.wave];
    set_matrix(f_, wave, f, path_.wave_at(wave, s), h);
  }
  [[gnu::noinline]] inline void matrix_at(const CourseSection& section, real s, const LevelAxes& from,
                                          LevelMatrix& h, FollowedField& f) const {
    f = followed(path_.field_at(section, s), from);
    matrix_of(section, s, f, h);
  }

  /// One step of the length h from s, where the field is `here` and the matrix `now`, to `state` and what it
  /// may be off by; false where it turns by too much.
  [[gnu::noinline]] inline mask step(const CourseSection& section, real s, real h, const FollowedField& here,
                                     const LevelMatrix& now, Amplitudes& state, LevelAxes& axes,
                                     real& error) const {
    const LevelManifold& f = coupled(section);
    FollowedField field[5];
    real then[5], passing = broadcast(0);
    mask good = ~mask{};
    field[0] = here;
    for (int i = 1; i < 5; ++i) {
      then[i] = i == 4 ? s + h : fma(broadcast(0.5 + 0.5 * lobatto_point[i]), h, s);
      field[i] = followed(path_.field_at(section, then[i]), axes);
      good = good & (field[i].cosine > broadcast(0.5));
      const real time = broadcast(0.5 * (lobatto_point[i] - lobatto_point[i - 1])) * h;
      passing = max(angle_passing_zero(field[i - 1], field[i], time), passing);
    }
    agree_with_end(axes, h, field);
    LevelMatrix at[5];
    copy_matrix(f, now, at[0]);
    for (int i = 1; i < 5; ++i) matrix_of(section, then[i], field[i], at[i]);
    // H of waves may stand still with couplings in it, which exponentials follow exactly.
    good = good & step_through(f, h, section.wave < 0, at, state, error);
    // Points on both sides of a zero see nothing of how the field turns there.
    error = fma(passing, broadcast(passing_share), error);
    axes = moved_to(field[4].n, axes);
    return good;
  }

  /// Lanes get dressed, or bare again. `near` [s] is a short time for the field there, `begin` and `end`
  /// where it is known.
  [[gnu::noinline]] inline void dress(const CourseSection& section, real s, real near, real begin, real end,
                                      double sign, mask lanes) {
    if (!any(lanes)) return;
    LevelMatrix now, before, after;
    FollowedField f;
    matrix_at(section, s, axes_, now, f);
    // The field may change a little later what it does not change here.
    const real ds = min(min(near, 1.0 / max(radius_of(f_, now), broadcast(tiny))), 0.25 * (end - begin)),
               middle = max(begin + ds, min(end - ds, s));
    matrix_at(section, middle - ds, axes_, before, f);
    matrix_at(section, middle + ds, axes_, after, f);
    divide_by_gaps(f_, now);
    divide_by_gaps(f_, before);
    divide_by_gaps(f_, after);
    // S = (V + i dS/dt)/(E_k - E_l); what is exponentiated is i S.
    const real over = sign * 0.5 / ds;
    for (int j = 0; j < f_.couplings; ++j) {
      const real apart = now.diagonal[f_.to[j]] - now.diagonal[f_.from[j]];
      const real each = select(abs(apart) > broadcast(tiny), over / apart, broadcast(0));
      const real re = fnma(after.im[j] - before.im[j], each, sign * now.re[j]),
                 im = fma(after.re[j] - before.re[j], each, sign * now.im[j]);
      now.re[j] = -im;
      now.im[j] = re;
    }
    for (int k = 0; k < f_.levels; ++k) now.diagonal[k] = broadcast(0);
    // Where it is large no step will be taken dressed, and bare states are to come back as they were.
    const real whole = max(broadcast(largest_radius), radius_of(f_, now)), part = largest_radius / whole;
    for (int j = 0; j < f_.couplings; ++j) {
      now.re[j] = part * now.re[j];
      now.im[j] = part * now.im[j];
    }
    Amplitudes changed = a;
    exponentiate(f_, now, changed);
    choose(f_.levels, lanes, changed, a);
  }

  [[gnu::noinline]] inline void pass(const CourseSection& section, const CourseSection* last, mask counted) {
    const real over = 1.0 / path_.speed();
    if (last != nullptr && last->field.end < section.field.begin)
      rest(f_, (section.field.begin - last->field.end) * over, a);
    const real begin = path_.time_at(section.field.begin), end = path_.time_at(section.field.end),
               longest = section.longest * over, stay = (section.field.end - section.field.begin) * over;
    path_.enter(section);
    real from = begin, until = path_.switch_fields(section, begin, end, ~mask{});
    const Vector still = path_.static_at(section, begin);
    const FollowedField entry = followed({still, {broadcast(0), broadcast(0), broadcast(0)}}, axes_);
    const bool touches = last != nullptr && last->field.end == section.field.begin;
    if (last == nullptr && course_.begins_in_field) {
      // Levels are those along the field itself.
      const mask back = entry.signed_size < broadcast(0);
      axes_ = moved_to(entry.n, axes_);
      axes_.third = select(back, times(broadcast(-1), axes_.third), axes_.third);
    } else {
      meet(entry, touches ? min(abs(size_), entry.size) : broadcast(0), counted);
    }
    if (section.period >= 0) {
      const LevelPeriodForm& modes = course_.periods[section.period];
      const real apart = face_modes(f_, modes, dot(still, axes_.third), axes_, a);
      repeat_periods(f_, modes, section.field.drive[0].omega, path_.phase(), path_.clock(begin),
                     path_.clock(end), apart, a);
      size_ = dot(still, axes_.third);
      return;
    }
    if (section.moves()) {
      const FieldAtTime driven = path_.field_at(section, begin);
      jump(still, driven, counted & differ(driven.b, still));
    }
    if (section.wave >= 0) {
      const mask back = dot(path_.field_at(section, begin).b, axes_.third) < broadcast(0);
      turn_over(f_, back, a);
      axes_.third = select(back, times(broadcast(-1), axes_.third), axes_.third);
      change_frame(f_, course_.waves[section.wave], path_.clock(begin), 1, a);
    }
    const LevelManifold& f = coupled(section);
    real s = begin, h = longest, skip = longest;
    if (last != nullptr || !course_.begins_in_field) s = start_felt(section, s, until, counted);
    real stop = stop_felt(section, s, until);
    mask going = counted, dressed = mask{};
    const bool driven = section.fastest > 0 || section.wave >= 0;
    const bool pulses = section.is_pulsed && section.wave < 0;
    const double tolerance = course_.tolerance;
    real tries = broadcast(0);
    while (any(going)) {
      heed(call_off);
      const real left = stop - s;
      LevelMatrix now;
      const FieldAtTime field = path_.field_at(section, s);
      FollowedField here = followed(field, axes_);
      if (section.wave < 0)
        face_what_comes(section, field, fma(min(h, left), broadcast(gauss_first), s), going, here);
      matrix_of(section, s, here, now);
      const Calm calm = calm_of(f, now);
      const real spread = radius_of(f, now);
      const real changes = length_of(field.rate) / max(here.size * calm.gap, broadcast(tiny));
      const mask is_calm =
          (calm.left_out(changes) < broadcast(calm_share * tolerance)) & (calm.gap > broadcast(0));
      const mask rests = pulses ? ~path_.is_driven(section) : mask{};
      // What drives slowly is followed like any other field.
      const mask adiabatic = !driven            ? ~mask{}
                             : section.wave < 0 ? rests | (calm.gap > broadcast(slow * section.fastest))
                                                : mask{};
      const real swings = select(rests, broadcast(0), broadcast(section.fastest)),
                 leap = min(min(skip, left),
                            1.0 / max(max(2.0 * (changes * calm.gap), swings), broadcast(tiny)));
      const mask skips = going & is_calm & (leap * spread > broadcast(10)) & adiabatic;
      const mask resolves = going & ~skips;
      const real near = min(longest, 0.01 / max(changes * calm.gap, broadcast(tiny)));
      dress(section, s, near, from, stop, 1, skips & ~dressed);
      dress(section, s, near, from, stop, -1, resolves & dressed);
      dressed = (dressed & ~going) | skips;
      mask arrives{}, stuck = going & (tries >= broadcast(most_steps));
      const Amplitudes before = a;
      const LevelAxes axes = axes_;
      if (any(skips)) {
        real error;
        LevelAxes there;
        Amplitudes turned;
        const auto at = [&](real then, LevelMatrix* matrix) {
          const FollowedField followed_there = followed(path_.field_at(section, then), axes);
          if (matrix != nullptr) matrix_of(section, then, followed_there, *matrix);
          return followed_there;
        };
        const mask good = turn_phases(f_, tolerance, at, s, leap, here, axes, before, turned, there, error);
        const real allowed = tolerance * (0.25 * (leap / stay) + 1e-2);
        const mask accepted = skips & good & (error <= allowed);
        choose(f_.levels, accepted, turned, a);
        axes_ = {select(accepted, there.third, axes_.third), select(accepted, there.first, axes_.first)};
        s = select(accepted, s + leap, s);
        arrives = arrives | (accepted & (leap >= left));
        skip = select(skips, select(accepted, min(longest, 4.0 * leap), 0.3 * leap), skip);
      }
      if (any(resolves)) {
        const real free = min(min(h, longest), min(most_turning / max(calm.swift, broadcast(tiny)),
                                                   most_phase / max(spread, broadcast(tiny)))),
                   trial = select(resolves, min(free, left), broadcast(0));
        Amplitudes there = before;
        LevelAxes turned = axes;
        real error;
        const mask good = step(section, s, trial, here, now, there, turned, error);
        const real allowed = tolerance * (0.25 * (trial / stay) + 2e-3);
        error = error / allowed;
        const mask accepted = resolves & good & (error <= broadcast(1));
        choose(f_.levels, accepted, there, a);
        axes_ = {select(accepted, turned.third, axes_.third), select(accepted, turned.first, axes_.first)};
        const mask hurries = ~good | ((error > broadcast(1)) & (trial < shortest * stay)),
                   unfelt = pass_unfelt(section, s, trial, allowed, resolves & hurries);
        s = select(accepted | unfelt, s + trial, s);
        arrives = arrives | ((accepted | unfelt) & (trial >= left));
        stuck = stuck | (resolves & ~accepted & ~unfelt & ~(trial > 1e-15 * (abs(s) + stay)));
        const mask known = good & (error < broadcast(1e300));
        const real fourth = sqrt(sqrt(max(select(known, error, broadcast(1e4)), broadcast(1e-5)))),
                   root = select(fourth < broadcast(1), sqrt(fourth), fourth);
        const real wanted =
            select(unfelt, 4.0 * trial, max(0.2 * trial, min(4.0 * trial, 0.9 * trial / root)));
        h = select(resolves, select(accepted & (trial < 0.5 * free), free, wanted), h);
        skip = select(resolves, min(longest, max(2.0 * skip, 2.0 * trial)), skip);
      }
      const mask switches = arrives & (until < end);
      if (any(switches)) {
        dress(section, stop, near, from, stop, -1, switches & dressed);
        dressed = dressed & ~switches;
        rest(f_, select(switches, until - stop, broadcast(0)), a);
        from = select(switches, until, from);
        s = select(switches, until, s);
        until = select(switches, switch_fields(section, s, end, switches), until);
        s = start_felt(section, s, until, switches);
        stop = select(switches, stop_felt(section, s, until), stop);
        arrives = arrives & ~switches;
      }
      tries = tries + 1.0;
      lost_ = lost_ | stuck;
      going = going & ~arrives & ~stuck;
    }
    const FieldAtTime field = path_.field_at(section, stop);
    dress(section, stop,
          min(longest, 0.01 * length_of(field.b) / max(length_of(field.rate), broadcast(tiny))), from, stop,
          -1, dressed & counted);
    if (section.wave >= 0) change_frame(f_, course_.waves[section.wave], path_.clock(end), -1, a);
    if (any(counted & (stop < end))) rest(f_, end - stop, a);
    const Vector stays = path_.static_at(section, stop);
    if (section.moves())
      jump(field.b, {stays, {broadcast(0), broadcast(0), broadcast(0)}}, counted & differ(field.b, stays));
    size_ = dot(stays, axes_.third);
  }

  const LevelCourse& course_;
  const LevelManifold& f_;
  LevelPath path_;
  LevelAxes axes_{};
  real size_{};  // [T] of the field where it was last, along the third axis
  mask reversed_{}, lost_{};
};

}  // namespace rabiline::RABILINE_ISA
