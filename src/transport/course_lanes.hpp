#pragma once
// Flights through a zone in closed form, for kernels only: dS/dt = w x S, dv/dt = W x v, dr/dt = v.
//
// Each course begins a span of time in the axes of the field as it stands then, and gives place, velocity and
// spin at any later time of the span. Where one field rotates (at omega, w1 its size and w0 the static
// field's as angular velocities), the spin turns in the frame of that field about n = (w1, 0, w0 - omega).
#include "transport/region.hpp"
#include "transport/turn_lanes.hpp"

namespace rabiline::RABILINE_ISA {

struct Motion {
  Vector place, velocity;
};

struct Complex {
  real re, im;
};
RABILINE_LANES Complex operator*(const Complex& a, const Complex& b) {
  return {fma(a.re, b.re, -(a.im * b.im)), fma(a.re, b.im, a.im * b.re)};
}
RABILINE_LANES Complex operator*(const Complex& a, const Phasor& p) { return a * Complex{p.c, p.s}; }
RABILINE_LANES Complex operator+(const Complex& a, const Complex& b) { return {a.re + b.re, a.im + b.im}; }
RABILINE_LANES Complex operator-(const Complex& a, const Complex& b) { return {a.re - b.re, a.im - b.im}; }

/// What every course knows of its span: the zone's axes and the spin, which is exact in all of them.
class Span {
 public:
  Span(const RegionZone& zone, const real* phases)
      : zone_(zone.field), phase_(zone.field.drives > 0 ? phases[0] : broadcast(0)) {
    const double w1 = drive_rate(), detuned = zone_.spin_rate - omega();
    rate_ = __builtin_sqrt(detuned * detuned + w1 * w1);
    ux_ = rate_ > 0 ? w1 / rate_ : 0;
    uz_ = rate_ > 0 ? detuned / rate_ : 1;
  }

  void begin(const State& start) {
    start_ = start;
    in_ = phasor(fma(broadcast(omega()), start.t, phase_));
    spin_ = to_axes(start.spin);
    velocity_ = to_axes(start.velocity);
  }
  double omega() const { return zone_.drives > 0 ? zone_.drive[0].omega : 0; }
  double drive_rate() const { return zone_.drives > 0 ? zone_.drive[0].spin_rate : 0; }

  /// In the laboratory, from what is given in the axes of the span's begin.
  RABILINE_LANES Motion in_laboratory(const Vector& way, const Vector& velocity) const {
    return {add(start_.place, broadcast(1), from_axes(way)), from_axes(velocity)};
  }
  RABILINE_LANES State state(real tau, const Motion& m) const {
    const Vector spin =
        turn_about_z(phasor(tau * omega()), rotation_in_xz_axis(ux_, uz_, tau * rate_) * spin_);
    return {start_.t + tau, m.place, m.velocity, of_unit_length(from_axes(spin)), in_};
  }

 protected:
  RABILINE_LANES Vector to_axes(const Vector& v) const { return turn_back_about_z(in_, to_frame(zone_, v)); }
  RABILINE_LANES Vector from_axes(const Vector& v) const { return from_frame(zone_, turn_about_z(in_, v)); }

  const SpinZone& zone_;
  real phase_;
  double rate_, ux_, uz_;
  State start_;
  Phasor in_;
  Vector spin_, velocity_;  // at the begin, in the axes there
};

/// Where W is constant in a frame that turns at a constant rate: a charge or closure `larmor` in a uniform
/// field, with or without a rotating one; closure `torque` in a uniform field, where W turns with the spin.
/// v' = R_G(t) v'(0) with G = W - rate z, exact over any time.
class ConstantTurn : public Span {
 public:
  ConstantTurn(const RegionZone& zone, bool take_off, const real* phases)
      : Span(zone, phases), take_off_(take_off && zone.field.drives == 0) {
    frame_rate_ = take_off_ ? zone_.spin_rate : omega();
  }
  void begin(const State& start) {
    Span::begin(start);
    const real zero = broadcast(0);
    const Vector turn{broadcast(zone_.drives > 0 ? zone_.drive[0].turn_rate : 0), zero,
                      broadcast(zone_.turn_rate)};
    const Vector w = turning(turn, spin_, take_off_), g{w.x, w.y, w.z - frame_rate_};
    bend_ = sqrt(dot(w, w));
    rate_of_turn_ = sqrt(dot(g, g));
    const mask turns = rate_of_turn_ > zero;
    const real per = 1.0 / select(turns, rate_of_turn_, broadcast(1));
    axis_ = {g.x * per, g.y * per, select(turns, g.z * per, broadcast(1))};
    along_ = dot(axis_, velocity_);
    across_ = add(velocity_, -along_, axis_);
    square_ = cross(axis_, across_);
  }
  RABILINE_LANES Motion motion(real tau) const {
    const mask bent = bend_ > broadcast(0);
    const Motion straight =
        in_laboratory({tau * velocity_.x, tau * velocity_.y, tau * velocity_.z}, velocity_);
    if (!any(bent)) return straight;
    const Motion round = around(tau);
    return {select(bent, round.place, straight.place), select(bent, round.velocity, straight.velocity)};
  }
  RABILINE_LANES State end(real span) const { return state(span, motion(span)); }
  RABILINE_LANES real bend() const { return bend_; }
  RABILINE_LANES real ripple() const { return broadcast(0); }

 private:
  RABILINE_LANES Motion around(real tau) const {
    // v' = axis along + Re[(across - i square) e^{i rate t}]; v_+ = v_x + i v_y turns with the frame besides.
    const Turned frame = turned(broadcast(frame_rate_), tau), round = turned(rate_of_turn_, tau),
                 sum = turned(frame_rate_ + rate_of_turn_, tau),
                 difference = turned(frame_rate_ - rate_of_turn_, tau);
    const Complex axis{along_ * axis_.x, along_ * axis_.y},
        with{0.5 * (across_.x + square_.y), 0.5 * (across_.y - square_.x)},
        against{0.5 * (across_.x - square_.y), 0.5 * (across_.y + square_.x)};
    const Complex way = axis * frame.way + with * sum.way + against * difference.way,
                  velocity = axis * frame.phase + with * sum.phase + against * difference.phase;
    const real along_z = along_ * axis_.z;
    return in_laboratory(
        {way.re, way.im, fma(along_z, tau, fma(across_.z, round.way.re, square_.z * round.way.im))},
        {velocity.re, velocity.im, along_z + fma(across_.z, round.phase.re, square_.z * round.phase.im)});
  }
  /// e^{i rate t} and its integral.
  struct Turned {
    Complex phase, way;
  };
  RABILINE_LANES static Turned turned(real rate, real tau) {
    const real half = 0.5 * (rate * tau);
    const Phasor p = phasor(half);
    const mask none = half == broadcast(0);
    const real shortened = tau * select(none, broadcast(1), p.s / select(none, broadcast(1), half));
    return {{fma(-2.0 * p.s, p.s, broadcast(1)), 2.0 * p.s * p.c}, {shortened * p.c, shortened * p.s}};
  }

  bool take_off_;
  double frame_rate_;
  real bend_, rate_of_turn_, along_;
  Vector axis_, across_, square_;
};

/// Values at the six Gauss points of a span, and with eight terms also at its ends, to coefficients of the
/// polynomial through them, in x from -1 to 1.
template <int terms>
struct Coefficients {
  real of[terms];
  real at_begin;  // of an integrated one

  RABILINE_LANES void fit(const real (&f)[span_points]) {
    constexpr double half_inverse[3] = {2.0953889257910308, 0.75619011198884489, 0.53621055957768052};
    constexpr double fit_squares[3][3] = {{1.2303042230268104, -0.3011716013933704, 0.07086737836656},
                                          {-4.229024358839492, 5.635735649927783, -1.4067112910882915},
                                          {3.2364224891285565, -6.083226877672094, 2.8468043885435375}};
    real even[3], odd[3];
    for (int j = 0; j < 3; ++j) {
      even[j] = 0.5 * (f[3 + j] + f[2 - j]);
      odd[j] = half_inverse[j] * (f[3 + j] - f[2 - j]);
    }
    for (int k = 0; k < 3; ++k) {
      const double* row = fit_squares[k];
      of[2 * k] = fma(even[0], broadcast(row[0]), fma(even[1], broadcast(row[1]), even[2] * row[2]));
      of[2 * k + 1] = fma(odd[0], broadcast(row[0]), fma(odd[1], broadcast(row[1]), odd[2] * row[2]));
    }
  }
  /// What is missing at the ends is added as P_6 and x P_6, of no integral over the span: that of Gauss
  /// stays.
  RABILINE_LANES void fit(const real (&f)[span_points], real begin,
                          real end) requires(terms == span_points + 2) {
    constexpr double p6[4] = {-5.0 / 16, 105.0 / 16, -315.0 / 16, 231.0 / 16};
    fit(f);
    of[6] = of[7] = broadcast(0);
    const real first = begin - at(broadcast(-1)), last = end - at(broadcast(1));
    const real even = 0.5 * (last + first), odd = 0.5 * (last - first);
    for (int k = 0; k < 4; ++k) {
      of[2 * k] = fma(even, broadcast(p6[k]), of[2 * k]);
      of[2 * k + 1] = fma(odd, broadcast(p6[k]), of[2 * k + 1]);
    }
  }
  /// For `from_begin`: the coefficients of the integral over x instead, but for its constant.
  RABILINE_LANES void integrate(double scale) {
    for (int k = 0; k < terms; ++k) of[k] = of[k] * (scale / (k + 1));
    at_begin = at(broadcast(-1));
  }
  RABILINE_LANES real at(real x) const {
    real p = of[terms - 1];
    for (int k = terms - 2; k >= 0; --k) p = fma(p, x, of[k]);
    return p;
  }
  /// Of an integrated one: from x = -1 on.
  RABILINE_LANES real from_begin(real x) const { return fma(x, at(x), at_begin); }
};

/// The points that values are given at, in x.
inline constexpr double gauss_points[span_points] = {-0.932469514203152,  -0.6612093864662645,
                                                     -0.2386191860831969, 0.2386191860831969,
                                                     0.6612093864662645,  0.932469514203152};

/// The polynomial g of int f e^{i rho t} dt = g e^{i rho t}, from that of f: sum_k (-1)^k f^(k) / (i
/// rho)^(k+1), which is finite. It also solves dg/dt + i rho g = f.
RABILINE_LANES void by_parts(Coefficients<span_points>& re, Coefficients<span_points>& im, double rho,
                             double span) {
  const double per = 1 / rho, derivative = 2 / span;
  for (int k = span_points - 1; k >= 0; --k) {
    real a = re.of[k], b = im.of[k];
    if (k + 1 < span_points) {
      a = fma(re.of[k + 1], broadcast(-derivative * (k + 1)), a);
      b = fma(im.of[k + 1], broadcast(-derivative * (k + 1)), b);
    }
    re.of[k] = b * per;  // times -i/rho
    im.of[k] = a * -per;
  }
}

/// The integral of v_+ = v_x + i v_y = slow + along e^{i alpha t} + fast e^{i(alpha + beta) t} and of
/// v_z = steady + Re[rises e^{-i beta t}], each factor a polynomial through the Gauss points.
class SlowPlace {
 public:
  /// Of the factors slow (2), steady, along (2), fast (2), rises (2).
  void fit(const real (&f)[9][span_points], double span, double alpha, double beta) {
    span_ = span;
    for (int k = 0; k < 9; ++k) c_[k].fit(f[k]);
    for (int k = 0; k < 3; ++k) c_[k].integrate(0.5 * span);
    by_parts(c_[3], c_[4], alpha, span);
    by_parts(c_[5], c_[6], alpha + beta, span);
    by_parts(c_[7], c_[8], -beta, span);
    const Phasor none{broadcast(1), broadcast(0)};
    begin_ = oscillating(broadcast(-1), none, none);
  }
  /// From the span's begin, with e^{i alpha tau} and e^{i beta tau}.
  RABILINE_LANES Vector way(real tau, const Phasor& at_alpha, const Phasor& at_beta) const {
    const real x = tau * (2 / span_) - 1.0;
    const Vector o = oscillating(x, at_alpha, at_beta);
    return {c_[0].from_begin(x) + (o.x - begin_.x), c_[1].from_begin(x) + (o.y - begin_.y),
            c_[2].from_begin(x) + (o.z - begin_.z)};
  }

 private:
  RABILINE_LANES Vector oscillating(real x, const Phasor& at_alpha, const Phasor& at_beta) const {
    const Complex a = Complex{c_[3].at(x), c_[4].at(x)} * at_alpha,
                  b = Complex{c_[5].at(x), c_[6].at(x)} * (at_alpha * at_beta);
    return {a.re + b.re, a.im + b.im, fma(c_[7].at(x), at_beta.c, c_[8].at(x) * at_beta.s)};
  }

  double span_ = 0;
  Coefficients<span_points> c_[9];
  Vector begin_;
};

/// R_u at a point of the span.
RABILINE_LANES Vector rotated_in(const SpanTable& table, int point, const Vector& v) {
  const double* m = table.turn[point];
  return {fma(v.x, broadcast(m[0]), fma(v.y, broadcast(m[1]), v.z * m[2])),
          fma(v.x, broadcast(m[3]), fma(v.y, broadcast(m[4]), v.z * m[5])),
          fma(v.x, broadcast(m[6]), fma(v.y, broadcast(m[7]), v.z * m[8]))};
}

/// Closure `torque` with kappa = 1: the velocity turns jointly with the spin, which is exact,
/// v'(t) = R_u(Omega t) R_S(-chi) v'(0), chi = (n . S) t + omega int S'_z dt, S at the begin.
class JointTurn : public Span {
 public:
  JointTurn(const RegionZone& zone, bool, const real* phases) : Span(zone, phases), table_(zone.table) {}

  void begin(const State& start) {
    Span::begin(start);
    along_ = dot(spin_, velocity_);
    across_ = add(velocity_, -along_, spin_);
    square_ = cross(spin_, across_);
    const real sine2 = fma(spin_.x, spin_.x, spin_.y * spin_.y);
    tip_ = min(broadcast(1), sqrt(sine2) + broadcast(table_.tip));
    end_velocity_ =
        turn_about_z(turning_at(span_points), rotated(span_points, turned_by(chi_at(span_points))));
  }
  RABILINE_LANES Vector velocity(real tau) const {
    const Phasor half = phasor(0.5 * (tau * rate_));
    const real s = 2.0 * half.s * half.c, lost = 2.0 * half.s * half.s,
               along = fma(spin_.x, broadcast(ux_), spin_.z * uz_);
    // int S'_z dt, S'_z = u_z (u . S) + (S_z - u_z (u . S)) cos - (u x z) . S sin
    const real steady = uz_ * along, turning = spin_.z - steady, per = broadcast(rate_ > 0 ? 1 / rate_ : 0);
    const real swing = rate_ > 0 ? fma(turning, s, ux_ * spin_.y * lost) * per : turning * tau;
    const real chi = fma(along * rate_, tau, omega() * fma(steady, tau, swing));
    return turn_about_z(phasor(tau * omega()), rotation_in_xz_axis(ux_, uz_, half) * turned_by(chi));
  }
  RABILINE_LANES State end_at(real span, const Vector& way) const {
    const Motion m = in_laboratory(way, end_velocity_);
    const Vector spin = turn_about_z(turning_at(span_points), rotated(span_points, spin_));
    return {start_.t + span, m.place, m.velocity, of_unit_length(from_axes(spin)), in_};
  }

 protected:
  /// The velocity turned about the spin at the begin by -chi.
  RABILINE_LANES Vector turned_by(real chi) const {
    const Phasor p = phasor(chi);
    return add(add({along_ * spin_.x, along_ * spin_.y, along_ * spin_.z}, p.c, across_), -p.s, square_);
  }
  RABILINE_LANES Vector rotated(int point, const Vector& v) const { return rotated_in(table_, point, v); }
  RABILINE_LANES real chi_at(int point) const {
    const double* x = table_.phase[point];
    return fma(spin_.x, broadcast(x[0]), fma(spin_.y, broadcast(x[1]), spin_.z * x[2]));
  }

  RABILINE_LANES Phasor turning_at(int point) const {
    return {broadcast(table_.cosine[point]), broadcast(table_.sine[point])};
  }

  const SpanTable& table_;
  real along_, tip_;
  Vector across_, square_, end_velocity_;
};

/// Its place over less than a turn: six Gauss points of the velocity.
class JointTurns : public JointTurn {
 public:
  using JointTurn::JointTurn;

  void begin(const State& start) {
    JointTurn::begin(start);
    real x[span_points], y[span_points], z[span_points];
    for (int i = 0; i < span_points; ++i) {
      const Vector v = turn_about_z(turning_at(i), rotated(i, turned_by(chi_at(i))));
      x[i] = v.x;
      y[i] = v.y;
      z[i] = v.z;
    }
    x_.fit(x, velocity_.x, end_velocity_.x);
    y_.fit(y, velocity_.y, end_velocity_.y);
    z_.fit(z, velocity_.z, end_velocity_.z);
    for (auto* c : {&x_, &y_, &z_}) c->integrate(0.5 * table_.span);
  }
  RABILINE_LANES Vector way(real tau) const {
    const real x = tau * (2 / table_.span) - 1.0;
    return {x_.from_begin(x), y_.from_begin(x), z_.from_begin(x)};
  }
  RABILINE_LANES Motion motion(real tau) const { return in_laboratory(way(tau), velocity(tau)); }
  RABILINE_LANES State end(real span) const { return end_at(span, way(span)); }
  RABILINE_LANES real bend() const { return broadcast(table_.bend) * tip_ + broadcast(table_.drive_bend); }
  RABILINE_LANES real ripple() const { return broadcast(0); }

 private:
  Coefficients<span_points + 2> x_, y_, z_;
};

/// Its place over many turns, for spins that stay near the field: with sigma the sign of S_z,
/// chi = sigma (w0 t + psi), v_+ = v_x + i v_y in the axes of the begin is a sum of three functions that vary
/// slowly, times e^{i omega t}, 1 and e^{i(omega + w0) t}, and v_z of two, times 1 and e^{-i w0 t}. Each is a
/// polynomial through the six Gauss points; then int f e^{i rho t} = e^{i rho t} sum_k (-1)^k f^(k) /
/// (i rho)^(k+1), a finite sum.
class SlowTurns : public JointTurn {
 public:
  using JointTurn::JointTurn;

  void begin(const State& start) {
    JointTurn::begin(start);
    const real sigma = select(spin_.z < broadcast(0), broadcast(-1), broadcast(1)), half = broadcast(0.5);
    real f[9][span_points];
    for (int i = 0; i < span_points; ++i) {
      const Phasor psi = phasor(fma(sigma, chi_at(i), broadcast(-table_.time[i] * zone_.spin_rate)));
      const Vector s = rotated(i, spin_), p = rotated(i, across_), sp = cross(s, p);
      const Vector q{sigma * sp.x, sigma * sp.y, sigma * sp.z};  // P - i Q turns with -(w0 t + psi)
      const Complex plus{half * (p.x + q.y), half * (p.y - q.x)},
          minus{half * (p.x - q.y), half * (p.y + q.x)};
      const Complex slow = plus * Phasor{psi.c, -psi.s} * turning_at(i);
      const Complex fast = minus * psi, rises = Complex{p.z, -q.z} * Phasor{psi.c, -psi.s};
      f[0][i] = slow.re;
      f[1][i] = slow.im;
      f[2][i] = s.z * along_;
      f[3][i] = s.x * along_;
      f[4][i] = s.y * along_;
      f[5][i] = fast.re;
      f[6][i] = fast.im;
      f[7][i] = rises.re;
      f[8][i] = rises.im;
    }
    place_.fit(f, table_.span, omega(), zone_.spin_rate);
  }
  RABILINE_LANES Vector way(real tau) const {
    return place_.way(tau, phasor(tau * omega()), phasor(tau * zone_.spin_rate));
  }
  RABILINE_LANES Motion motion(real tau) const { return in_laboratory(way(tau), velocity(tau)); }
  RABILINE_LANES State end(real span) const { return end_at(span, way(span)); }
  /// What turns the path for good, and by how much the velocity swings besides.
  RABILINE_LANES real bend() const { return broadcast(table_.bend) * (tip_ * tip_); }
  RABILINE_LANES real ripple() const { return 4.0 * tip_; }

 private:
  SlowPlace place_;
};

}  // namespace rabiline::RABILINE_ISA
