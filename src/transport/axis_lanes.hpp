#pragma once
// Closure `torque` of any strength over many turns, for kernels only (see transport/course_lanes.hpp).
#include "transport/course_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// In the frame of the rotating field dv'/dt = G x v', G = kappa (a - S' (S' . a)) - omega z, a = (w1, 0,
/// w0). A unit vector n that obeys this equation itself and does not oscillate is an axis about which all
/// else turns: with nu = n_x + i n_y, for n near z,
///   v' = n y + Re[(e1 - i e2) e^{i Phi} y_+],  (e1 - i e2)_+ = 1 + n_z,  (e1 + i e2)_+ = -nu^2/(1 + n_z),
///   (e1 - i e2)_z = -conj(nu),  dPhi/dt = G . n + Im(conj(nu) dnu/dt)/(1 + n_z),  y, y_+ constant.
/// n begins as the direction of (1 - kappa) omega z + kappa (a . S') S', which is exact for kappa = 0 and 1,
/// and is corrected twice by the polynomial that solves d delta/dt + i omega delta = -(dnu/dt - (G x n)_+)
/// through the Gauss points. Then v_+ = v_x + i v_y is e^{i omega t}, 1 and e^{2 i omega t} times functions
/// that vary slowly, and v_z 1 and e^{-i omega t}.
class SlowAxis : public Span {
 public:
  SlowAxis(const RegionZone& zone, bool, const real* phases)
      : Span(zone, phases),
        table_(zone.table),
        kappa_(zone.field.spin_rate != 0 ? zone.field.turn_rate / zone.field.spin_rate : 0) {}

  void begin(const State& start) {
    Span::begin(start);
    tip_ = min(broadcast(1), sqrt(fma(spin_.x, spin_.x, spin_.y * spin_.y)) + broadcast(table_.tip));
    Node nodes[span_points];
    real re[span_points], im[span_points];
    for (int i = 0; i < span_points; ++i) {
      Node& n = nodes[i];
      n = node_of(rotated(i, spin_));
      const Complex left = n.slope - turned_by_g(n);
      re[i] = -left.re;
      im[i] = -left.im;
    }
    solve(re, im, delta_re_, delta_im_);
    for (int i = 0; i < span_points; ++i) {
      Node& n = nodes[i];
      const real x = broadcast(gauss_points[i]);
      const Complex delta{delta_re_.at(x), delta_im_.at(x)};
      // d delta/dt by the equation that it solves
      n.slope = n.slope +
                Complex{fma(broadcast(omega()), delta.im, re[i]), fma(broadcast(-omega()), delta.re, im[i])};
      n.axis = tilted(n.axis.nu + delta);
      const Complex left = n.slope - turned_by_g(n);
      re[i] = -left.re;
      im[i] = -left.im;
    }
    Coefficients<span_points> more_re, more_im;
    solve(re, im, more_re, more_im);
    for (int k = 0; k < span_points; ++k) {
      delta_re_.of[k] = delta_re_.of[k] + more_re.of[k];
      delta_im_.of[k] = delta_im_.of[k] + more_im.of[k];
    }
    real rate[span_points];
    for (int i = 0; i < span_points; ++i) {
      Node& n = nodes[i];
      const real x = broadcast(gauss_points[i]);
      n.axis = tilted(n.axis.nu + Complex{more_re.at(x), more_im.at(x)});
      const Complex slope = turned_by_g(n);
      const real twist = fma(n.axis.nu.re, slope.im, -(n.axis.nu.im * slope.re)) / (1.0 + n.axis.z);
      rate[i] = fma(n.gx, n.axis.nu.re, fma(n.gy, n.axis.nu.im, fma(n.gz, n.axis.z, twist + omega())));
    }
    psi_.fit(rate);
    psi_.integrate(0.5 * table_.span);
    take_parts(axis_at(spin_, broadcast(-1)));
    real f[9][span_points];
    for (int i = 0; i < span_points; ++i) {
      const Parts p = parts_of(nodes[i].axis, psi_.from_begin(broadcast(gauss_points[i])));
      const real values[9] = {p.slow.re, p.slow.im, p.along.re, p.turning.re, p.turning.im,
                              p.fast.re, p.fast.im, p.rises.re, p.rises.im};
      for (int k = 0; k < 9; ++k) f[k][i] = values[k];
    }
    place_.fit(f, table_.span, omega(), omega());
  }

  RABILINE_LANES Motion motion(real tau) const {
    const Phasor turn = phasor(tau * omega());
    return in_laboratory(place_.way(tau, turn, turn),
                         velocity(rotation_in_xz_axis(ux_, uz_, tau * rate_) * spin_, tau, turn));
  }
  RABILINE_LANES State end(real span) const {
    const Phasor turn{broadcast(table_.cosine[span_points]), broadcast(table_.sine[span_points])};
    const Vector spin = rotated(span_points, spin_);
    const Motion m = in_laboratory(place_.way(span, turn, turn), velocity(spin, span, turn));
    return {start_.t + span, m.place, m.velocity, of_unit_length(from_axes(turn_about_z(turn, spin))), in_};
  }
  RABILINE_LANES real bend() const { return broadcast(table_.bend * (1 + kappa_ * kappa_)) * (tip_ * tip_); }
  RABILINE_LANES real ripple() const { return (4 * (1 + kappa_ * kappa_)) * tip_; }

 private:
  struct Axis {
    Complex nu;
    real z;
  };
  struct Node {
    Axis axis;
    Complex slope;  // dnu/dt
    real gx, gy, gz;
  };
  /// What v' is made of: without the phases e^{i omega t} and its powers.
  struct Parts {
    Complex slow, along, turning, fast, rises;
  };

  RABILINE_LANES static Axis tilted(const Complex& nu) {
    return {nu, sqrt(max(broadcast(0), 1.0 - fma(nu.re, nu.re, nu.im * nu.im)))};
  }
  /// (G x n)_+
  RABILINE_LANES static Complex turned_by_g(const Node& n) {
    return {fma(n.gy, n.axis.z, -(n.gz * n.axis.nu.im)), fma(n.gz, n.axis.nu.re, -(n.gx * n.axis.z))};
  }
  RABILINE_LANES Vector rotated(int point, const Vector& v) const { return rotated_in(table_, point, v); }

  /// (1 - kappa) omega z + kappa (a . S) S, turned to the side of z, and a . S.
  RABILINE_LANES Vector direction(const Vector& s, real& along_a) const {
    along_a = fma(broadcast(drive_rate()), s.x, zone_.spin_rate * s.z);
    const real k = kappa_ * along_a;
    return {k * s.x, k * s.y, fma(k, s.z, broadcast((1 - kappa_) * omega()))};
  }
  RABILINE_LANES Node node_of(const Vector& s) const {
    Node n;
    real along_a;
    const Vector u = direction(s, along_a);
    const real length = sqrt(dot(u, u)), per = 1.0 / select(u.z < broadcast(0), -length, length);
    n.axis = {{u.x * per, u.y * per}, u.z * per};
    const double w1 = drive_rate(), detuned = zone_.spin_rate - omega();
    const real da = (omega() * w1) * s.y;  // d(a . S)/dt; dS/dt = (w1, 0, detuned) x S
    const Vector ds{-detuned * s.y, fma(broadcast(detuned), s.x, -(w1 * s.z)), w1 * s.y};
    const Vector du{kappa_ * fma(da, s.x, along_a * ds.x), kappa_ * fma(da, s.y, along_a * ds.y),
                    kappa_ * fma(da, s.z, along_a * ds.z)};
    const real longer = fma(n.axis.nu.re, du.x, fma(n.axis.nu.im, du.y, n.axis.z * du.z));
    n.slope = {per * (du.x - longer * n.axis.nu.re), per * (du.y - longer * n.axis.nu.im)};
    n.gx = kappa_ * (w1 - s.x * along_a);
    n.gy = -kappa_ * (s.y * along_a);
    n.gz = kappa_ * (zone_.spin_rate - s.z * along_a) - omega();
    return n;
  }
  /// The polynomial delta with d delta/dt + i omega delta = f at the Gauss points.
  void solve(const real (&f_re)[span_points], const real (&f_im)[span_points], Coefficients<span_points>& re,
             Coefficients<span_points>& im) const {
    re.fit(f_re);
    im.fit(f_im);
    by_parts(re, im, omega(), table_.span);
  }
  RABILINE_LANES Axis axis_at(const Vector& spin, real x) const {
    real unused;
    const Vector u = direction(spin, unused);
    const real length = sqrt(dot(u, u)), per = 1.0 / select(u.z < broadcast(0), -length, length);
    return tilted({fma(u.x, per, delta_re_.at(x)), fma(u.y, per, delta_im_.at(x))});
  }
  /// y and y_+ from the velocity at the begin.
  void take_parts(const Axis& n) {
    along_ = fma(velocity_.x, n.nu.re, fma(velocity_.y, n.nu.im, velocity_.z * n.z));
    const Complex v{velocity_.x, velocity_.y}, against{velocity_.x, -velocity_.y};
    const real per = -1.0 / (1.0 + n.z);
    const Complex square = n.nu * n.nu, other = Complex{square.re * per, square.im * per} * against;
    turning_ = {fma(0.5 * (1.0 + n.z), v.re, fma(broadcast(0.5), other.re, -(n.nu.re * velocity_.z))),
                fma(0.5 * (1.0 + n.z), v.im, fma(broadcast(0.5), other.im, -(n.nu.im * velocity_.z)))};
  }
  RABILINE_LANES Parts parts_of(const Axis& n, real psi) const {
    const Complex y = turning_ * phasor(psi), conjugate{y.re, -y.im};
    const real half = 0.5 * (1.0 + n.z), per = -0.5 / (1.0 + n.z);
    const Complex square = n.nu * n.nu;
    return {{half * y.re, half * y.im},
            {along_ * n.z, broadcast(0)},
            {along_ * n.nu.re, along_ * n.nu.im},
            Complex{square.re * per, square.im * per} * conjugate,
            Complex{-n.nu.re, n.nu.im} * y};
  }
  RABILINE_LANES Vector velocity(const Vector& spin, real tau, const Phasor& turn) const {
    const real x = tau * (2 / table_.span) - 1.0;
    const Parts p = parts_of(axis_at(spin, x), psi_.from_begin(x));
    const Complex v = p.slow + p.turning * turn + p.fast * (turn * turn);
    return {v.re, v.im, p.along.re + fma(p.rises.re, turn.c, p.rises.im * turn.s)};
  }

  const SpanTable& table_;
  double kappa_;
  real tip_, along_;
  Complex turning_;
  Coefficients<span_points> delta_re_, delta_im_, psi_;
  SlowPlace place_;
};

}  // namespace rabiline::RABILINE_ISA
