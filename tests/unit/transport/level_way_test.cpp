// Levels of atoms through fields of any direction, against Schroedinger's equation of both spins in the
// laboratory (GSL's Runge-Kutta-Prince-Dormand 8(7), no code shared with the program but for B itself), and
// closed forms.
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <string>
#include <vector>

#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "particle/species.hpp"
#include "spin/levels.hpp"
#include "spin/majorana.hpp"
#include "transport/spin_path.hpp"
#include "unit/spin/laboratory.hpp"

namespace rabiline {
namespace {

/// Straight along y at one speed, through a field that fills the way from 0 to its length.
struct Flight {
  CoupledSpins spins;
  double speed = 1000, length = 0.02;  // [m/s], [m]
  LevelFields fields{};
  double apart = 1e6;  // [Hz]
};

LinearShape linear(double x, double y, double z, double x_along, double y_along, double z_along) {
  return {{x, y, z}, {0, x_along, 0, 0, y_along, 0, 0, z_along, 0}};
}
/// B = at the place `middle` and what it grows by along the beam [T, T/m].
Flight flight(const CoupledSpins& spins, double speed, double length, const LinearShape& shape,
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
CoupledSpins of(const char* name) { return coupled_spins(*find_species(name)->structure); }
CoupledSpins structure(int twice_i, int twice_j, double coupling, double quadrupole, double g_j, double g_i) {
  return coupled_spins(Structure{{twice_i}, {twice_j}, coupling, quadrupole, g_j, g_i});
}

constexpr int particles = 8;  // the first flies at the speed of the flight, the others ever faster

/// The part of each particle that is found in each level: [level][particle].
std::vector<double> all_carried(const Flight& f, int level, Isa isa) {
  const auto table = std::make_shared<LevelTable>(f.spins, manifolds_of(f.spins, f.apart));
  const LevelWay way(f.fields, table);
  SpinPath path;
  path.levels = f.spins.levels();
  path.of_atom = true;
  path.way = &way;
  Batch batch;
  BatchView& v = batch.view();
  v.count = v.padded = particles;
  v.y = f.length;
  alignas(64) std::uint64_t weights[Batch::capacity] = {}, shares[most_levels * Batch::capacity];
  for (int i = 0; i < particles; ++i) {
    v.x[i] = v.z[i] = v.vx[i] = v.vz[i] = 0;
    v.vy[i] = f.speed * (1 + 0.01 * i);
    v.t[i] = f.length / v.vy[i];
    v.level[i] = static_cast<std::uint64_t>(level);
    v.particle[i] = static_cast<std::uint64_t>(i);
    weights[i] = quanta_per_particle;
  }
  share_levels(path, {}, isa, v, weights, shares);
  std::vector<double> p;
  for (int i = 0; i < f.spins.levels() * particles; ++i)
    p.push_back(static_cast<double>(shares[i]) / static_cast<double>(quanta_per_particle));
  return p;
}
/// Of the first one.
std::vector<double> carried(const Flight& f, int level) {
  const std::vector<double> all = all_carried(f, level, best_isa());
  std::vector<double> p;
  for (int to = 0; to < f.spins.levels(); ++to) p.push_back(all[static_cast<std::size_t>(to * particles)]);
  return p;
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
    gsl_odeiv2_driver_apply(driver, &t, stay, reinterpret_cast<double*>(state.data()));
    gsl_odeiv2_driver_free(driver);
    const Eigen::VectorXcd found = states_at(stay).adjoint() * state;
    std::vector<double> p;
    for (const Complex& amplitude : found) p.push_back(std::norm(amplitude));
    return p;
  }

 private:
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
  Eigen::Vector3d field(double t) const {
    FieldHere<double> here{};
    for (const ShapedTerm& term : f_.fields.shaped) add_field<HostMaths>(term, 0.0, f_.speed * t, 0.0, here);
    const SpinZone& zone = f_.fields.sections[0].field;
    Eigen::Vector3d b(here.field[0], here.field[1], here.field[2] + zone.spin_rate);
    for (int i = 0; i < zone.drives; ++i) {
      const DriveTerm& drive = zone.drive[i];
      const double angle = drive.omega * t + drive.phase;
      for (int k = 0; k < 3; ++k)
        b(k) += drive.spin_rate * (std::cos(angle) * drive.first[k] + std::sin(angle) * drive.second[k]);
    }
    return b;
  }
  /// Levels along the field of that moment, in products along z.
  Eigen::MatrixXcd states_at(double t) const {
    const Eigen::Vector3d b = field(t);
    const Levels levels = levels_at(f_.spins, b.norm());
    return turn(2, std::atan2(b(1), b(0))) * turn(1, std::acos(b(2) / b.norm())) *
           levels.states.cast<Complex>();
  }
  Eigen::MatrixXcd turn(int axis, double angle) const {
    const Eigen::MatrixXcd f =
        in_product_basis(f_.spins, true, axis) + in_product_basis(f_.spins, false, axis);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXcd> solver(f);
    const Eigen::VectorXcd phases = (solver.eigenvalues().cast<Complex>() * Complex(0, -angle)).array().exp();
    return solver.eigenvectors() * phases.asDiagonal() * solver.eigenvectors().adjoint();
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
};

double worst_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double worst = 0;
  for (std::size_t k = 0; k < a.size(); ++k) worst = std::max(worst, std::abs(a[k] - b[k]));
  return worst;
}

/// Past a zero of the field, some of it across, at a speed at which levels neither stay nor follow.
Flight past_zero(const CoupledSpins& spins) {
  return flight(spins, 800, 0.02, linear(20e-6, 2e-6, 0, 0, 0.003, 0.2), 0.011);
}

/// A field along x that swings all along the way, its size [T] and frequency [Hz].
void swing(Flight& f, double field, double frequency) {
  CourseSection& section = f.fields.sections[0];
  DriveTerm& drive = section.field.drive[0];
  section.field.drives = 1;
  drive.spin_rate = field;
  drive.omega = two_pi * frequency;
  drive.second[1] = 0;
  drive.in_xy = false;
  section.moment = 1e-3 / drive.omega;
}

TEST(LevelWay, IsSchroedingersEquationPastAZeroOfTheField) {
  for (const char* atom : {"H atom", "D atom", "K-39 atom"})
    for (const int level : {0, 2}) {
      const Flight f = past_zero(of(atom));
      const std::vector<double> p = carried(f, level);
      EXPECT_LT(worst_difference(p, Laboratory(f).carried(level)), 1e-6) << atom << level;
      EXPECT_LT(p[static_cast<std::size_t>(level)], 0.9) << atom << level;
    }
}

TEST(LevelWay, IsSchroedingersEquationWhereTheFieldTurnsTheLevelsRound) {
  // From above the field of the hyperfine interaction to the other side of zero.
  const Flight f = flight(of("K-39 atom"), 1000, 0.005, linear(0.3e-3, 0, 0, 0, 0, 14), 50e-3 / 14);
  EXPECT_LT(worst_difference(carried(f, 1), Laboratory(f).carried(1)), 1e-6);
}

TEST(LevelWay, IsSchroedingersEquationOfLevelsThatAreNear) {
  Flight f = flight(of("ortho-H2"), 1500, 0.06, linear(20e-6, 0, 0, 0, 0, -0.2), 0.05);
  f.apart = 1e7;
  for (const int level : {0, 3, 8})
    EXPECT_LT(worst_difference(carried(f, level), Laboratory(f).carried(level)), 1e-6);
  Flight own = past_zero(structure(3, 3, 2e6, 0.7e6, 1.3, 1e-4));
  own.apart = 1e8;
  EXPECT_LT(worst_difference(carried(own, 1), Laboratory(own).carried(1)), 1e-6);
}

TEST(LevelWay, IsSchroedingersEquationOfAnInvertedStructureAndOfNone) {
  // An inverted one has its largest F below.
  const Flight inverted = past_zero(structure(3, 1, -150e6, 0, 2.002, 2e-4));
  EXPECT_LT(worst_difference(carried(inverted, 0), Laboratory(inverted).carried(0)), 1e-6);
  const Flight free = past_zero(structure(1, 2, 0, 0, 1.5, 1e-3));
  EXPECT_LT(worst_difference(carried(free, 0), Laboratory(free).carried(0)), 1e-6);
}

TEST(LevelWay, IsSchroedingersEquationOfAFieldThatTurnsInTime) {
  // 2 MHz about a field that crosses the resonance: an adiabatic fast passage of potassium.
  Flight f = flight(of("K-39 atom"), 800, 0.03, linear(0, 0, 0.2857e-3, 0, 0, 0.004), 0.015);
  swing(f, 8e-6, 2e6);
  f.apart = 1e8;
  const std::vector<double> p = carried(f, 0);
  EXPECT_LT(worst_difference(p, Laboratory(f).carried(0)), 1e-6);
  EXPECT_LT(p[0], 0.9);
}

TEST(LevelWay, IsShiftedByTheOtherFThatADriveMixesIn) {
  // Potassium at 30 G and 18.4 MHz, near a line of F=2, for ten Rabi periods; F=1 is left to second order.
  Flight f = flight(of("K-39 atom"), 1000, 0.02, linear(0, 0, 3e-3, 0, 0, 0), 0);
  swing(f, 60e-6, 18.4e6);
  const std::vector<double> expected = Laboratory(f).carried(1), p = carried(f, 1);
  EXPECT_LT(worst_difference(p, expected), 3e-6);
  EXPECT_LT(p[1], 0.9);
  f.apart = 1e9;  // both F in one manifold
  EXPECT_LT(worst_difference(carried(f, 1), expected), 1e-6);
}

/// Landau-Zener: what leaves its level is exp(-pi gamma B_t^2/(2 |dB_l/dt|)), here with gamma B_t = 1 and
/// gamma dB_l/dt = 1; then Majorana for more levels.
TEST(LevelWay, FlipsASpinAsLandauZenerAndMajoranaSay) {
  for (const int twice_j : {1, 2, 3}) {
    const CoupledSpins spin = structure(0, twice_j, 0, 0, 2, 0);
    const double gamma = two_pi * spin.zeeman_j, across = 1e-6,
                 time = 1 / (gamma * across);  // [s] 1/(gamma B_t)
    const double speed = 1000, length = 400 * speed * time, slope = across / (speed * time);
    const Flight f = flight(spin, speed, length, linear(across, 0, 0, 0, 0, slope), length / 2);
    const double leaves = std::exp(-std::numbers::pi / 2);
    EXPECT_NEAR(leaves, 0.20788, 1e-5);
    const MajoranaTable table = majorana_table(twice_j);
    const std::vector<double> p = carried(f, 0);
    for (int to = 0; to <= twice_j; ++to) {
      double expected = 0;
      for (int power = twice_j; power >= 0; --power)
        expected =
            expected * leaves + table.coefficients[static_cast<std::size_t>(to * (twice_j + 1) + power)];
      EXPECT_NEAR(p[static_cast<std::size_t>(to)], expected, 2e-6) << twice_j << to;
    }
  }
}

TEST(LevelWay, LeavesLevelsWhereTheyAreInAFieldThatKeepsItsDirectionThroughZero) {
  const Flight f = flight(of("H atom"), 1000, 0.02, linear(0, 0, 0, 0, 0, 0.5), 0.01);
  const std::vector<double> p = carried(f, 0);  // F=1 m=1 is m=-1 of the opposite field
  EXPECT_NEAR(p[2], 1, 1e-9);
}

TEST(LevelWay, TurnsAtOnceWhereOneFieldEndsAndAnotherBegins) {
  // From no field, along +z, into one along x and out again: by a quarter turn twice, with Larmor phases
  // between.
  Flight f = flight(structure(0, 1, 0, 0, 2, 0), 1000, 0.01, linear(1e-6, 0, 0, 0, 0, 0), 0);
  f.fields.begins_in_field = f.fields.ends_in_field = false;
  const double angle = two_pi * f.spins.zeeman_j * 1e-6 * f.length / f.speed;
  EXPECT_NEAR(carried(f, 0)[0], std::pow(std::cos(angle / 2), 2), 1e-8);
  f.fields.begins_in_field = true;  // it starts in a level along x
  EXPECT_NEAR(carried(f, 0)[0], 0.5, 1e-8);
}

TEST(LevelWay, GivesTheSameBitsOnEachInstructionSet) {
  for (const char* atom : {"K-39 atom", "ortho-H2"}) {
    Flight f = past_zero(of(atom));
    if (f.spins.twice_j > 1) f.apart = 1e8;
    const std::vector<double> p = all_carried(f, 1, Isa::baseline);
    for (const Isa isa : {Isa::avx2, Isa::avx512}) {
      if (supported(isa)) {
        EXPECT_EQ(all_carried(f, 1, isa), p) << atom;
      }
    }
  }
}

/// One per cent of the field across is seen.
TEST(LevelWay, FeelsTheFieldAcross) {
  const Flight f = past_zero(of("K-39 atom"));
  Flight other = f;
  other.fields.shaped[0].linear.field[0] *= 1.01;
  EXPECT_GT(worst_difference(carried(f, 1), carried(other, 1)), 1e-3);
}

}  // namespace
}  // namespace rabiline
