#include "simulation/magnet_check.hpp"

#include <gsl/gsl_errno.h>

#include <cmath>
#include <complex>

#include "core/portable_math.hpp"
#include "core/stepper.hpp"
#include "simulation/zone_rates.hpp"

namespace rabiline {
namespace {

using Complex = std::complex<double>;

double size_of(Complex z) { return portable::hypot(z.real(), z.imag()); }

/// [T] and [T/m] of |B|, its slope as that along x + i times that along z, in the magnet's frame.
struct SizeHere {
  double size;
  Complex slope;
};
SizeHere size_at(const MagnetShape& m, Complex place) {
  if (m.kind == MagnetKind::gradient) {
    const Complex along(m.along_x, m.along_z);
    const double b = m.field + m.gradient * (place * std::conj(along)).real();
    return {std::abs(b), std::copysign(m.gradient, m.gradient * b) * along};
  }
  const Complex poles = place * place - m.half_distance * m.half_distance;  // of 1/(r - a) - 1/(r + a)
  const bool wires = m.kind == MagnetKind::two_wire;
  if (!wires && place == Complex()) return {};
  const double size =
      std::abs(m.field) * (wires ? (m.half_distance * m.half_distance + m.height * m.height) / size_of(poles)
                                 : portable::pow(size_of(place) / m.radius, m.power));
  return {size, size * std::conj(wires ? -2.0 * place / poles : static_cast<double>(m.power) / place)};
}

/// An initial value problem in time, of [x, z, vx, vz].
template <class Force>  // [m/s^2] at (x, z), as a Complex
struct PathProblem {
  Force force;
  long& evaluations;
  long most;

  static int derivative(double, const double* q, double* dq, void* with) {
    PathProblem& p = *static_cast<PathProblem*>(with);
    const Complex a = p.force(Complex(q[0], q[1]));
    dq[0] = q[2];
    dq[1] = q[3];
    dq[2] = a.real();
    dq[3] = a.imag();
    return ++p.evaluations < p.most ? GSL_SUCCESS : GSL_EBADFUNC;
  }
};

template <class Force>
std::optional<AcrossBeam> integrated(const BatchView& batch, int i, double length, long& evaluations,
                                     long most, Force force) {
  PathProblem<Force> problem{force, evaluations, most};
  gsl_odeiv2_system system{PathProblem<Force>::derivative, nullptr, 4, &problem};
  constexpr double error = 1e-12;
  const double speed = batch.vy[i], stay = length / speed, sizes[4] = {length, length, speed, speed};
  Stepper steps(sizes, error, stay / 64);
  double t = 0, q[4] = {batch.x[i], batch.z[i], batch.vx[i], batch.vz[i]};
  if (steps.go(system, t, stay, stay, q) != GSL_SUCCESS) return {};
  return AcrossBeam{q[0], q[1], q[2], q[3]};
}

/// m/I of a level; of a vector what it has along the axis, which is across the beam.
double part_of(int levels, double axis_x, double axis_z, const BatchView& batch, int i) {
  return levels > 0 ? 1 - 2 * static_cast<double>(batch.level[i]) / (levels - 1)
                    : batch.sx[i] * axis_x + batch.sz[i] * axis_z;
}

}  // namespace

std::optional<AcrossBeam> integrated_through(const Steering& s, const BatchView& batch, int i,
                                             long& evaluations, long most) {
  const Complex turn(s.cosine, s.sine), at_beam(s.x0, s.z0), height(0, s.shape.height),
      fall(batch.fall.x, batch.fall.z);
  const double part = part_of(s.levels, s.axis_x, s.axis_z, batch, i);
  return integrated(batch, i, s.end - s.begin, evaluations, most, [&](Complex place) {
    const SizeHere b = size_at(s.shape, (place - at_beam) * turn + height);
    const double moment =
        s.moments.coefficients != nullptr ? moment_at(s.moments, batch.level[i], b.size) : part * s.moment;
    return moment / s.mass * b.slope * std::conj(turn) + fall;
  });
}

std::optional<AcrossBeam> integrated_through(const Deflection& d, const BatchView& batch, int i,
                                             long& evaluations, long most) {
  const Complex force = part_of(d.levels, 0, 1, batch, i) * d.acceleration * Complex(d.along_x, d.along_z) +
                        Complex(batch.fall.x, batch.fall.z);
  return integrated(batch, i, d.end - d.begin, evaluations, most, [&](Complex) { return force; });
}

}  // namespace rabiline
