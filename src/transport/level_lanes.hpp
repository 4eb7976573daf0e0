#pragma once
// Amplitudes of an atom's levels along a straight path through fields of any direction, for kernels only.
//
// In a frame whose third axis n follows +-B, from step to step without turning about n, H is that of
// LevelManifold. A step is of fourth order: two exponentials of H at the Gauss points (the commutator-free
// Magnus method: S. Blanes and P. Moan, Appl. Numer. Math. 56, 1519 (2006)); inside of it the frame turns
// from n at the begin by the shortest way, which adds a turn about n. Where all couplings V_kl are weak
// against E_k - E_l the amplitudes are those of the states dressed by them, a' = exp(S) a with S_kl =
// V_kl/(E_k - E_l), and a step turns their phases alone, however many radians it is long.
#include "field/lane_maths.hpp"
#include "field/shaped_field.hpp"
#include "transport/level_matrix_lanes.hpp"
#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// Particles on their way through a course, whose levels are of one manifold.
class LevelFlight {
 public:
  Amplitudes a;

  LevelFlight(const LevelCourse& course, const LevelManifold& manifold, const RandomKey& key, double y,
              const Vector& place, const Vector& velocity, real t, const Fall& fall, words particle)
      : course_(course),
        f_(manifold),
        key_(key),
        y_(y),
        place_(place),
        velocity_(velocity),
        t_(t),
        fall_(fall),
        particle_(particle) {}

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
      pass(course_.sections[i], i == 0 && course_.begins_in_field, counted);
    if (!course_.ends_in_field) {
      const FollowedField z = followed({{zero, zero, one}, {zero, zero, zero}}, axes_);
      turn_to(z.n, zero, counted);
      reversed_ = z.signed_size < zero;
    } else {
      reversed_ = size_ < zero;
    }
  }
  /// |a_k|^2, by the atom's levels.
  inline void probabilities(real* p, int levels) const {
    for (int n = 0; n < levels; ++n) p[n] = broadcast(0);
    real sum = broadcast(0);
    for (int k = 0; k < f_.levels; ++k) sum = fma(a.re[k], a.re[k], fma(a.im[k], a.im[k], sum));
    for (int k = 0; k < f_.levels; ++k) {
      const real share = fma(a.re[k], a.re[k], a.im[k] * a.im[k]) / sum;
      p[f_.number[k]] = p[f_.number[k]] + select(reversed_, broadcast(0), share);
      p[f_.mirror[k]] = p[f_.mirror[k]] + select(reversed_, share, broadcast(0));
    }
  }

 private:
  [[gnu::noinline]] inline FieldAtTime field_at(const CourseSection& section, real s) const {
    const Vector v{fma(broadcast(fall_.x), s, velocity_.x), velocity_.y,
                   fma(broadcast(fall_.z), s, velocity_.z)};
    const Vector r{fma(fma(0.5 * s, broadcast(fall_.x), velocity_.x), s, place_.x),
                   fma(velocity_.y, s, broadcast(y_)),
                   fma(fma(0.5 * s, broadcast(fall_.z), velocity_.z), s, place_.z)};
    FieldAtTime at{rates_at(section.field, phases_, t_ + s, r).spin,
                   {broadcast(0), broadcast(0), broadcast(0)}};
    if (section.moment > 0) {
      // Four neighbours: to (moment x rate)^4/30 of itself.
      const auto near = [&](double moments) {
        const double ds = moments * section.moment;
        return rates_at(section.field, phases_, t_ + s + ds, add(r, broadcast(ds), v)).spin;
      };
      const Vector after = near(1), before = near(-1), later = near(2), earlier = near(-2);
      const double over = 1 / (12 * section.moment);
      const auto rate = [&](real e, real b, real c, real l) { return (8.0 * (c - b) - (l - e)) * over; };
      at.rate = {rate(earlier.x, before.x, after.x, later.x), rate(earlier.y, before.y, after.y, later.y),
                 rate(earlier.z, before.z, after.z, later.z)};
    }
    if (section.shaped_begin == section.shaped_end) return at;
    FieldHere<real> field{};
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      add_field<LaneMaths>(course_.shaped[i], r.x, r.y, r.z, field);
    at.b = add(at.b, broadcast(1), {field.field[0], field.field[1], field.field[2]});
    const real* g = field.slope;
    at.rate = add(at.rate, broadcast(1),
                  {dot({g[0], g[1], g[2]}, v), dot({g[3], g[4], g[5]}, v), dot({g[6], g[7], g[8]}, v)});
    return at;
  }

  /// The frame turns at once and the state stays: it turns back by -W . F of the levels at that size.
  [[gnu::noinline]] inline void turn_to(const Vector& n, real size, mask counted) {
    const LevelAxes next = moved_to(n, axes_);
    const Vector across = cross(axes_.third, n);
    const real sine = length_of(across), cosine = dot(axes_.third, n);
    const mask turns = counted & (sine > broadcast(1e-12));
    if (any(turns)) {
      // Half the angle from its tangent: it is at most 45 degrees.
      const real angle = 2.0 * atan(sine / (1.0 + cosine)), by = angle / select(turns, sine, broadcast(1));
      constexpr int parts = 8;
      FollowedField still{n, abs(size), size, broadcast(0), {}, {}, {}, broadcast(1)};
      still.turn_1 = select(turns, by * dot(across, axes_.first), broadcast(0)) * (1.0 / parts);
      still.turn_2 = select(turns, by * dot(across, axes_.second()), broadcast(0)) * (1.0 / parts);
      still.turn_3 = broadcast(0);
      LevelMatrix h;
      clear(f_, h);
      add_matrix(f_, still, broadcast(1), h);
      for (int k = 0; k < f_.levels; ++k) h.diagonal[k] = broadcast(0);
      for (int i = 0; i < parts; ++i) {
        Amplitudes turned = a;
        exponentiate(f_, h, turned);
        choose(f_.levels, turns, turned, a);
      }
    }
    axes_ = next;
  }

  [[gnu::noinline]] inline void matrix_at(const CourseSection& section, real s, const LevelAxes& from,
                                          LevelMatrix& h, FollowedField& f) const {
    f = followed(field_at(section, s), from);
    clear(f_, h);
    add_matrix(f_, f, broadcast(1), h);
  }

  /// One step of the length h from s; false where it turns by too much.
  [[gnu::noinline]] inline mask step(const CourseSection& section, real s, real h, Amplitudes& state,
                                     LevelAxes& axes) const {
    constexpr double near = 0.25 - 0.28867513459481288225, far = 0.25 + 0.28867513459481288225;
    const FollowedField first = followed(field_at(section, s + gauss_first * h), axes),
                        second = followed(field_at(section, s + gauss_second * h), axes),
                        end = followed(field_at(section, s + h), axes);
    LevelMatrix one, two;
    clear(f_, one);
    clear(f_, two);
    mask good =
        (first.cosine > broadcast(0.5)) & (second.cosine > broadcast(0.5)) & (end.cosine > broadcast(0.5));
    add_matrix(f_, first, h, one);
    add_matrix(f_, second, h, two);
    for (int k = 0; k < f_.levels; ++k) mix(one.diagonal[k], two.diagonal[k], far, near);
    for (int j = 0; j < f_.couplings; ++j) {
      mix(one.re[j], two.re[j], far, near);
      mix(one.im[j], two.im[j], far, near);
    }
    good = good & (max(radius_of(f_, one), radius_of(f_, two)) < broadcast(largest_radius));
    exponentiate(f_, one, state);
    exponentiate(f_, two, state);
    axes = moved_to(end.n, axes);
    return good;
  }
  RABILINE_LANES static void mix(real& one, real& two, double far, double near) {
    const real first = far * one + near * two;
    two = near * one + far * two;
    one = first;
  }

  /// The same state with another first axis.
  inline void turn_about_third(const LevelAxes& from, const LevelAxes& to, Amplitudes& state) const {
    const Phasor by{dot(from.first, to.first), dot(to.first, from.second())};
    // exp(i m angle), up to a phase of all.
    Phasor powers[most_levels];
    powers[0] = {broadcast(1), broadcast(0)};
    int known = 0;
    for (int k = 0; k < f_.levels; ++k) {
      const int down = static_cast<int>(top() - f_.m[k] + 0.5);
      for (; known < down; ++known) powers[known + 1] = powers[known] * Phasor{by.c, -by.s};
      const Phasor p = powers[down];
      const real re = fnma(state.im[k], p.s, state.re[k] * p.c);
      state.im[k] = fma(state.re[k], p.s, state.im[k] * p.c);
      state.re[k] = re;
    }
  }
  double top() const {
    double most = f_.m[0];
    for (int k = 1; k < f_.levels; ++k) most = f_.m[k] > most ? f_.m[k] : most;
    return most;
  }

  /// Lanes get dressed, or bare again. `near` [s] is a short time for the field there, `begin` and `end`
  /// where it is known.
  [[gnu::noinline]] inline void dress(const CourseSection& section, real s, real near, real begin, real end,
                                      double sign, mask lanes) {
    if (!any(lanes)) return;
    LevelMatrix now, before, after;
    FollowedField f;
    const real ds = min(near, 0.25 * (end - begin)), middle = max(begin + ds, min(end - ds, s));
    matrix_at(section, s, axes_, now, f);
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
    Amplitudes changed = a;
    exponentiate(f_, now, changed);
    choose(f_.levels, lanes, changed, a);
  }

  [[gnu::noinline]] inline void pass(const CourseSection& section, bool begins, mask counted) {
    const real over = 1.0 / velocity_.y;
    const real begin = (section.field.begin - broadcast(y_)) * over,
               end = (section.field.end - broadcast(y_)) * over, longest = section.longest * over,
               stay = (section.field.end - section.field.begin) * over;
    for (int i = 0; i < section.field.drives; ++i)
      phases_[i] = oscillator_phase(section.field.drive[i], key_, particle_);
    const FollowedField entry = followed(field_at(section, begin), axes_);
    if (begins) {
      // Levels are those along the field itself.
      const mask back = entry.signed_size < broadcast(0);
      axes_ = moved_to(entry.n, axes_);
      axes_.third = select(back, times(broadcast(-1), axes_.third), axes_.third);
    } else {
      const real least = select(abs(size_) < entry.size, abs(size_), entry.size);
      const mask alike = (size_ < broadcast(0)) == (entry.signed_size < broadcast(0));
      turn_to(entry.n, select(alike, select(size_ < broadcast(0), -least, least), broadcast(0)), counted);
    }
    real s = begin, h = longest, skip = longest;
    mask going = counted, dressed = mask{};
    const bool driven = section.moment > 0;
    const double tolerance = course_.tolerance;
    real tries = broadcast(0);
    while (any(going)) {
      const real left = end - s;
      LevelMatrix now;
      const FieldAtTime field = field_at(section, s);
      const FollowedField here = followed(field, axes_);
      clear(f_, now);
      add_matrix(f_, here, broadcast(1), now);
      const Calm calm = calm_of(f_, now);
      const real spread = radius_of(f_, now);
      const real changes = length_of(field.rate) / max(here.size * calm.gap, broadcast(tiny));
      const mask is_calm = (calm.left_out(changes) < broadcast(tolerance)) & (calm.gap > broadcast(0));
      const real leap = min(min(skip, left), 0.5 / max(changes * calm.gap, broadcast(tiny)));
      const mask skips = going & is_calm & (leap * spread > broadcast(10)) & (driven ? mask{} : ~mask{});
      const mask resolves = going & ~skips;
      const real near = min(longest, 0.01 / max(changes * calm.gap, broadcast(tiny)));
      dress(section, s, near, begin, end, 1, skips & ~dressed);
      dress(section, s, near, begin, end, -1, resolves & dressed);
      dressed = (dressed & ~going) | skips;
      mask arrives{};
      const Amplitudes before = a;
      const LevelAxes axes = axes_;
      if (any(skips)) {
        real error;
        LevelAxes there;
        Amplitudes turned;
        const mask good = try_skip(section, s, leap, axes, here.signed_size, before, turned, there, error);
        const real allowed = tolerance * (0.25 * (leap / stay) + 1e-2);
        const mask accepted = skips & good & (error <= allowed);
        choose(f_.levels, accepted, turned, a);
        axes_ = {select(accepted, there.third, axes_.third), select(accepted, there.first, axes_.first)};
        s = select(accepted, s + leap, s);
        arrives = arrives | (accepted & (leap >= left));
        skip = select(skips, select(accepted, min(longest, 4.0 * leap), 0.3 * leap), skip);
      }
      if (any(resolves)) {
        const real free = min(min(h, longest), 4.0 / max(spread, broadcast(tiny))),
                   trial = select(resolves, min(free, left), broadcast(0));
        Amplitudes whole = before, halves = before;
        LevelAxes whole_axes = axes, half_axes = axes;
        mask good = step(section, s, trial, whole, whole_axes);
        good = good & step(section, s, 0.5 * trial, halves, half_axes);
        good = good & step(section, s + 0.5 * trial, 0.5 * trial, halves, half_axes);
        turn_about_third(whole_axes, half_axes, whole);
        const real allowed = tolerance * (0.25 * (trial / stay) + 1e-2);
        const real error = difference(whole, halves) * (1.0 / 15) / allowed;
        const mask accepted = resolves & good & (error <= broadcast(1));
        real size2 = broadcast(0);
        for (int k = 0; k < f_.levels; ++k) {
          halves.re[k] = fma(halves.re[k] - whole.re[k], broadcast(1.0 / 15), halves.re[k]);
          halves.im[k] = fma(halves.im[k] - whole.im[k], broadcast(1.0 / 15), halves.im[k]);
          size2 = fma(halves.re[k], halves.re[k], fma(halves.im[k], halves.im[k], size2));
        }
        const real unit = 1.0 / sqrt(size2);
        for (int k = 0; k < f_.levels; ++k) {
          halves.re[k] = halves.re[k] * unit;
          halves.im[k] = halves.im[k] * unit;
        }
        choose(f_.levels, accepted, halves, a);
        axes_ = {select(accepted, half_axes.third, axes_.third),
                 select(accepted, half_axes.first, axes_.first)};
        s = select(accepted, s + trial, s);
        arrives = arrives | (accepted & (trial >= left));
        const real root = sqrt(sqrt(max(select(good, error, broadcast(1e4)), broadcast(1e-4))));
        const real wanted = max(0.2 * trial, min(4.0 * trial, 0.9 * trial / root));
        h = select(resolves, select(accepted & (trial < 0.5 * free), free, wanted), h);
        skip = select(resolves, min(longest, max(2.0 * skip, 2.0 * trial)), skip);
      }
      tries = tries + 1.0;
      going = going & ~arrives & (tries < broadcast(1e6));
    }
    const FieldAtTime last = field_at(section, end);
    dress(section, end, min(longest, 0.01 * length_of(last.b) / max(length_of(last.rate), broadcast(tiny))),
          begin, end, -1, dressed & counted);
    size_ = followed(last, axes_).signed_size;
  }

  /// Phases over a long step, by Kronrod's seven points; the error is what Gauss' three differ by, to the
  /// power 3/2.
  [[gnu::noinline]] inline mask try_skip(const CourseSection& section, real s, real h, const LevelAxes& axes,
                                         real size, const Amplitudes& before, Amplitudes& turned,
                                         LevelAxes& there, real& error) const {
    constexpr double place[7] = {-0.9604912687080202, -0.7745966692414834, -0.4342437493468026, 0,
                                 0.4342437493468026,  0.7745966692414834,  0.9604912687080202};
    constexpr double kronrod[7] = {0.1046562260264673, 0.2684880898683334, 0.4013974147759622,
                                   0.4509165386584741, 0.4013974147759622, 0.2684880898683334,
                                   0.1046562260264673};
    constexpr double gauss[7] = {0, 5.0 / 9, 0, 8.0 / 9, 0, 5.0 / 9, 0};
    real angle[most_levels], off[most_levels];
    for (int k = 0; k < f_.levels; ++k) angle[k] = off[k] = broadcast(0);
    mask good = ~mask{};
    real last_1{}, last_2{};
    for (int i = 0; i < 7; ++i) {
      LevelMatrix now;
      FollowedField f;
      matrix_at(section, s + (0.5 + 0.5 * place[i]) * h, axes, now, f);
      const Calm calm = calm_of(f_, now);
      const real turning2 = fma(f.turn_1, f.turn_1, f.turn_2 * f.turn_2),
                 stretching = f.size_rate / max(f.size, broadcast(tiny));
      const real changes = sqrt(fma(stretching, stretching, turning2)) / max(calm.gap, broadcast(tiny));
      const real ratio_1 = f.turn_1 / max(calm.gap, broadcast(tiny)),
                 ratio_2 = f.turn_2 / max(calm.gap, broadcast(tiny));
      real moves = broadcast(0);
      if (i > 0) {
        const real dt = (0.5 * (place[i] - place[i - 1])) * h, d1 = ratio_1 - last_1, d2 = ratio_2 - last_2;
        moves = sqrt(fma(d1, d1, d2 * d2)) / (dt * max(calm.gap, broadcast(tiny)));
      }
      last_1 = ratio_1;
      last_2 = ratio_2;
      good = good & (f.cosine > broadcast(0.5)) & (f.signed_size * size > broadcast(0)) &
             (max(calm.left_out(broadcast(0)), 3.0 * moves * changes) < broadcast(2 * course_.tolerance));
      real energy[most_levels];
      shifted_energies(f_, now, energy);
      for (int k = 0; k < f_.levels; ++k) {
        const real part = 0.5 * h * energy[k];
        angle[k] = fma(part, broadcast(kronrod[i]), angle[k]);
        off[k] = fma(part, broadcast(kronrod[i] - gauss[i]), off[k]);
      }
    }
    const FollowedField end = followed(field_at(section, s + h), axes);
    good = good & (end.cosine > broadcast(0.5));
    there = moved_to(end.n, axes);
    // What is common to all levels that are there does not matter.
    real mean = broadcast(0), square = broadcast(0);
    for (int k = 0; k < f_.levels; ++k) {
      const real share = fma(before.re[k], before.re[k], before.im[k] * before.im[k]);
      mean = fma(share, off[k], mean);
    }
    for (int k = 0; k < f_.levels; ++k) {
      const real share = fma(before.re[k], before.re[k], before.im[k] * before.im[k]), d = off[k] - mean;
      square = fma(share * d, d, square);
      real sine, cosine;
      sincos(max(broadcast(-1e9), min(broadcast(1e9), angle[k])), sine, cosine);
      turned.re[k] = fma(before.re[k], cosine, before.im[k] * sine);
      turned.im[k] = fnma(before.re[k], sine, before.im[k] * cosine);
    }
    error = sqrt(square) * sqrt(sqrt(square));
    return good;
  }
  /// By how much two states differ, but for a common phase.
  inline real difference(const Amplitudes& one, const Amplitudes& other) const {
    real square = broadcast(0), phase = broadcast(0);
    for (int k = 0; k < f_.levels; ++k) {
      const real re = one.re[k] - other.re[k], im = one.im[k] - other.im[k];
      square = fma(re, re, fma(im, im, square));
      phase = fma(other.re[k], im, fnma(other.im[k], re, phase));
    }
    return sqrt(max(broadcast(0), fnma(phase, phase, square)));
  }

  const LevelCourse& course_;
  const LevelManifold& f_;
  const RandomKey& key_;
  const double y_;
  const Vector place_, velocity_;
  const real t_;
  const Fall fall_;
  const words particle_;
  real phases_[most_drives];
  LevelAxes axes_{};
  real size_{};  // [T] of the field where it was last, along the third axis
  mask reversed_{};
};

}  // namespace rabiline::RABILINE_ISA
