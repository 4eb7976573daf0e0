#pragma once
// Levels of atoms through fields of any direction, and Schroedinger's equation of both spins in the
// laboratory for comparison: GSL's Runge-Kutta-Prince-Dormand 8(7), which shares no code with the program but
// for B itself.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <string>
#include <tuple>
#include <vector>

#include "core/eigensystem.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "particle/species.hpp"
#include "spin/levels.hpp"
#include "transport/spin_path.hpp"
#include "unit/spin/laboratory.hpp"

namespace rabiline {

/// Straight along y at one speed, through a field that fills the way from 0 to its length.
struct Flight {
  CoupledSpins spins;
  double speed = 1000, length = 0.02;  // [m/s], [m]
  LevelFields fields{};
  double apart = 1e6;  // [Hz]
};

inline LinearShape linear(double x, double y, double z, double x_along, double y_along, double z_along) {
  return {{x, y, z}, {0, x_along, 0, 0, y_along, 0, 0, z_along, 0}};
}
/// B = at the place `middle` and what it grows by along the beam [T, T/m].
inline Flight flight(const CoupledSpins& spins, double speed, double length, const LinearShape& shape,
                     double middle) {
  Flight f{spins, speed, length, {}};
  f.fields.shaped = {ShapedTerm(shape)};
  f.fields.shaped[0].y = middle;
  CourseSection section;
  section.field.end = length;
  section.longest = length / 8;
  section.shaped_end = 1;
  f.fields.sections = {section};
  f.fields.begins_in_field = f.fields.ends_in_field = true;
  return f;
}
inline CoupledSpins of(const char* name) { return coupled_spins(*find_species(name)->structure); }
inline CoupledSpins structure(int twice_i, int twice_j, double coupling, double quadrupole, double g_j,
                              double g_i) {
  return coupled_spins(Structure{{twice_i}, {twice_j}, coupling, quadrupole, g_j, g_i});
}

inline constexpr int beam_size = 8;  // the first flies at the speed of the flight, the others ever faster

/// The part of each particle that is found in each level: [level][particle].
inline std::vector<double> all_carried_along(const SpinPath& path, const Flight& f, int level, Isa isa) {
  Batch batch;
  BatchView& v = batch.view();
  v.count = v.padded = beam_size;
  v.y = f.length;
  alignas(64) std::uint64_t weights[Batch::capacity] = {}, shares[most_levels * Batch::capacity];
  for (int i = 0; i < beam_size; ++i) {
    v.x[i] = v.z[i] = v.vx[i] = v.vz[i] = 0;
    v.vy[i] = f.speed * (1 + 0.01 * i);
    v.slowness[i] = 1 / v.vy[i];
    v.t[i] = f.length / v.vy[i];
    v.level[i] = static_cast<std::uint64_t>(level);
    v.particle[i] = static_cast<std::uint64_t>(i);
    weights[i] = quanta_per_particle;
  }
  share_levels(path, {}, isa, v, weights, shares);
  std::vector<double> p;
  for (int i = 0; i < f.spins.levels() * beam_size; ++i)
    p.push_back(static_cast<double>(shares[i]) / static_cast<double>(quanta_per_particle));
  return p;
}
/// Those of a test are made once.
inline std::shared_ptr<const LevelTable> table_of(const Flight& f) {
  static std::vector<std::tuple<CoupledSpins, std::vector<int>, bool, std::shared_ptr<const LevelTable>>>
      made;
  const std::vector<int> manifolds = manifolds_of(f.spins, f.apart);
  const bool driven = f.fields.need_pairs();
  for (const auto& [spins, of, is_driven, table] : made)
    if (spins == f.spins && of == manifolds && is_driven == driven) return table;
  return std::get<3>(made.emplace_back(f.spins, manifolds, driven,
                                       std::make_shared<LevelTable>(f.spins, manifolds, driven)));
}
inline std::vector<double> all_carried(const Flight& f, int level, Isa isa) {
  const LevelWay way(f.fields, table_of(f));
  SpinPath path;
  path.levels = f.spins.levels();
  path.of_atom = true;
  path.way = &way;
  return all_carried_along(path, f, level, isa);
}
/// Of the first one.
inline std::vector<double> of_first(const std::vector<double>& all) {
  std::vector<double> p;
  for (std::size_t i = 0; i < all.size(); i += beam_size) p.push_back(all[i]);
  return p;
}
inline std::vector<double> carried(const Flight& f, int level) {
  return of_first(all_carried(f, level, best_isa()));
}

class Laboratory {
 public:
  explicit Laboratory(const Flight& f) : f_(f), zero_(hamiltonian_at(0)) {
    for (int axis = 0; axis < 3; ++axis)
      moment_[axis] = two_pi * (f.spins.zeeman_j * in_product_basis(f.spins, true, axis) +
                                f.spins.zeeman_i * in_product_basis(f.spins, false, axis));
  }

  std::vector<double> carried(int level) {
    const double stay = f_.length / f_.speed;
    const int n = f_.spins.levels();
    Eigen::VectorXcd state = states_at(0).col(level);
    gsl_odeiv2_system system{derivative, nullptr, static_cast<std::size_t>(2 * n), this};
    gsl_odeiv2_driver* driver =
        gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, 1e-10, 1e-12, 1e-12);
    double t = 0;
    for (const double edge : edges(stay)) {
      moment_of_pulses_ = (t + edge) / 2;
      gsl_odeiv2_driver_apply(driver, &t, edge, reinterpret_cast<double*>(state.data()));
      gsl_odeiv2_driver_reset(driver);
    }
    gsl_odeiv2_driver_free(driver);
    const Eigen::VectorXcd found = states_at(stay).adjoint() * state;
    std::vector<double> p;
    for (const Complex& amplitude : found) p.push_back(std::norm(amplitude));
    return p;
  }

 private:
  /// When pulses begin and end, and the end.
  std::vector<double> edges(double stay) const {
    std::vector<double> out{stay};
    const auto add = [&](const Gate& gate) {
      for (int i = 0; gate.begin != gate.end && i < gate.times; ++i)
        for (const double edge : {gate.begin + i * gate.period, gate.end + i * gate.period})
          if (edge > 0 && edge < stay) out.push_back(edge);
    };
    const SpinZone& zone = f_.fields.sections[0].field;
    for (int i = 0; i < zone.drives; ++i) add(zone.drive[i].gate);
    for (const WaveFields& wave : f_.fields.waves)
      for (const DriveTerm& drive : wave.drives) add(drive.gate);
    std::ranges::sort(out);
    return out;
  }
  Eigen::MatrixXcd hamiltonian_at(double b) const {
    CoupledSpins alone = f_.spins;
    alone.offset = 0;
    Eigen::MatrixXcd scalar = Eigen::MatrixXcd::Zero(alone.levels(), alone.levels());
    for (int axis = 0; axis < 3; ++axis)
      scalar += in_product_basis(alone, true, axis) * in_product_basis(alone, false, axis);
    return two_pi * (alone.coupling * scalar + alone.coupling_squared * scalar * scalar +
                     b * (alone.zeeman_j * in_product_basis(alone, true, 2) +
                          alone.zeeman_i * in_product_basis(alone, false, 2)));
  }
  Eigen::Vector3d field(double t, bool with_drives = true) const {
    Eigen::Vector3d b(0, 0, 0);
    for (const ShapedTerm& term : f_.fields.shaped) {
      if (!with_drives && term.drive >= 0) continue;
      FieldHere<double> here{};
      add_field<HostMaths>(term, 0.0, f_.speed * t, 0.0, here);
      const DriveTerm* clock = term.drive < 0 ? nullptr : &f_.fields.sections[0].field.drive[term.drive];
      const double share = clock == nullptr ? 1 : std::cos(clock->omega * t + clock->phase);
      b += share * Eigen::Vector3d(here.field[0], here.field[1], here.field[2]);
    }
    const auto add = [&](const DriveTerm& drive) {
      const double y = f_.speed * t, begin = drive.envelope.begin,
                   share = (y - begin) / drive.envelope.length;
      if (drive.envelope.shape == Shape::half_sine && (share < 0 || share > 1)) return;
      const double since = moment_of_pulses_ - drive.gate.begin,
                   pulse = drive.gate.times > 1 ? std::floor(since / drive.gate.period) : 0;
      if (drive.gate.begin != drive.gate.end &&
          (since < 0 || pulse >= drive.gate.times ||
           since - pulse * drive.gate.period > drive.gate.end - drive.gate.begin))
        return;
      const double angle = drive.omega * t + drive.phase,
                   size = drive.spin_rate *
                          (drive.envelope.shape == Shape::half_sine ? std::sin(two_pi / 2 * share) : 1);
      for (int k = 0; k < 3; ++k)
        b(k) += size * (std::cos(angle) * drive.first[k] + std::sin(angle) * drive.second[k]);
    };
    const SpinZone& zone = f_.fields.sections[0].field;
    b(2) += zone.spin_rate;
    if (!with_drives) return b;
    for (int i = 0; i < zone.drives; ++i) add(zone.drive[i]);
    for (const WaveFields& wave : f_.fields.waves)
      for (const DriveTerm& drive : wave.drives) add(drive);
    return b;
  }
  /// Levels along the static field of that moment, or along z, in products along z.
  Eigen::MatrixXcd states_at(double t) const {
    const Eigen::Vector3d b = field(t, false);
    const Levels levels = levels_at(f_.spins, b.norm());
    return turn(2, std::atan2(b(1), b(0))) * turn(1, std::atan2(std::hypot(b(0), b(1)), b(2))) *
           levels.states.cast<Complex>();
  }
  Eigen::MatrixXcd turn(int axis, double angle) const {
    const Eigen::MatrixXcd f =
        in_product_basis(f_.spins, true, axis) + in_product_basis(f_.spins, false, axis);
    const auto own = eigensystem_of(f);
    const Eigen::VectorXcd phases = (own.values.cast<Complex>() * Complex(0, -angle)).array().exp();
    return own.vectors * phases.asDiagonal() * own.vectors.adjoint();
  }
  static int derivative(double t, const double y[], double f[], void* of) {
    const auto& lab = *static_cast<const Laboratory*>(of);
    const int n = lab.f_.spins.levels();
    const Eigen::Map<const Eigen::VectorXcd> state(reinterpret_cast<const Complex*>(y), n);
    Eigen::Map<Eigen::VectorXcd> rate(reinterpret_cast<Complex*>(f), n);
    const Eigen::Vector3d b = lab.field(t);
    Eigen::VectorXcd h = lab.zero_ * state;
    for (int axis = 0; axis < 3; ++axis)
      if (b(axis) != 0) h += b(axis) * (lab.moment_[axis] * state);
    rate = Complex(0, -1) * h;
    return GSL_SUCCESS;
  }

  const Flight& f_;
  const Eigen::MatrixXcd zero_;
  Eigen::MatrixXcd moment_[3];
  double moment_of_pulses_ = 0;  // [s] at which they are as they are between two edges
};

inline double worst_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

}  // namespace rabiline
