// The steps of closure `torque` as src/transport/turn_kernels.cpp takes them, down to their bare arithmetic:
// constant rotations carry spin and phase from one step's second Gauss point straight to the next step's
// first.
#include "bench/limits.hpp"
#include "transport/vector_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

constexpr int packs_in_flight = 2;

/// Spin (in the field's frame) and phase at the first Gauss point of the step to come.
struct State {
  Vector place, velocity, spin;
  Phasor frame;
};

/// From Gauss point to Gauss point, in a step and across two of them.
struct Constants {
  Matrix inside, across;
  Phasor phase_inside, phase_across;
  Vector turn;
  real h;
};

/// In the frame that turns with the field the spin turns about (ux, 0, uz).
struct Precession {
  double rate, ux, uz;
};
Precession precession_in_frame(const SpinZone& zone) {
  const double w1 = zone.drive[0].spin_rate, detuned = zone.spin_rate - zone.drive[0].omega;
  const double rate = __builtin_sqrt(detuned * detuned + w1 * w1);
  return {rate, w1 / rate, detuned / rate};
}

RABILINE_LANES Vector torque(const Vector& turn, const Vector& spin) {
  return add(turn, -dot(turn, spin), spin);
}

RABILINE_LANES void step(const Constants& c, State& s) {
  const Vector w1 = turn_about_z(s.frame, torque(c.turn, s.spin));
  s.spin = c.inside * s.spin;
  s.frame = s.frame * c.phase_inside;
  const Vector w2 = turn_about_z(s.frame, torque(c.turn, s.spin));
  s.spin = c.across * s.spin;
  s.frame = s.frame * c.phase_across;

  const Vector o = magnus(w1, w2, c.h);
  const real q = dot(o, o);
  real sine, cosine;
  rotation_coefficients(q, sine, cosine);
  const real integral = polynomial(q, {1.0 / 39916800, -1.0 / 362880, 1.0 / 5040, -1.0 / 120, 1.0 / 6});
  const Vector u = cross(o, s.velocity), uu = cross(o, u);
  const Vector moment = cross({w1.x - w2.x, w1.y - w2.y, w1.z - w2.z}, add(s.velocity, broadcast(0.5), u));
  s.place = add(s.place, c.h, add(add(s.velocity, cosine, u), integral, uu));
  s.place = add(s.place, c.h * c.h * magnus_commutator, moment);
  s.velocity = add(add(s.velocity, sine, u), cosine, uu);
}

Vector vector_of(const double (&v)[3]) { return {broadcast(v[0]), broadcast(v[1]), broadcast(v[2])}; }
void first_lane(const Vector& v, double (&out)[3]) {
  out[0] = lane(v.x, 0);
  out[1] = lane(v.y, 0);
  out[2] = lane(v.z, 0);
}

}  // namespace
}  // namespace rabiline::RABILINE_ISA

namespace rabiline::bench {

using namespace rabiline::RABILINE_ISA;

Particle turning_flight(const SpinZone& zone, double h, double t, const Particle& start, int steps,
                        int packs) {
  const DriveTerm& drive = zone.drive[0];
  const Precession spin = precession_in_frame(zone);
  const double inside = gauss_second - gauss_first, across = 1 - inside;
  const auto turned = [&](double part) {
    return rotation_in_xz_axis(spin.ux, spin.uz, broadcast(spin.rate * part * h));
  };
  const auto phase_after = [&](double time) { return phasor(broadcast(drive.omega * time)); };
  const Constants constants{turned(inside),
                            turned(across),
                            phase_after(inside * h),
                            phase_after(across * h),
                            {broadcast(drive.turn_rate), real{}, broadcast(zone.turn_rate)},
                            broadcast(h)};
  const Phasor at_start = phasor(broadcast(drive.omega * t + drive.phase));
  const State begin{vector_of(start.place), vector_of(start.velocity),
                    turned(gauss_first) * turn_back_about_z(at_start, vector_of(start.spin)),
                    at_start * phase_after(gauss_first * h)};
  State last = begin;
  for (int pack = 0; pack < packs; pack += packs_in_flight) {
    State s[packs_in_flight];
    for (State& state : s) {
      state = begin;
      asm volatile("" : "+v"(state.spin.x));  // packs that start alike must not become one
    }
    for (int i = 0; i < steps; ++i)
      for (State& state : s) step(constants, state);
    last = s[packs_in_flight - 1];
    asm volatile("" : : "v"(s[0].place.x), "v"(s[0].velocity.x), "v"(s[0].place.y), "v"(s[0].place.z));
  }
  Particle end;
  first_lane(last.place, end.place);
  first_lane(last.velocity, end.velocity);
  first_lane(turn_about_z(last.frame * phase_after(-gauss_first * h), turned(-gauss_first) * last.spin),
             end.spin);
  return end;
}

}  // namespace rabiline::bench
