#pragma once
// A deflecting magnet whose force depends on the place: stepped paths.
#include <limits>
#include <vector>

#include "transport/kernels.hpp"
#include "transport/moment_law.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// A force mu(|B|) grad |B| across the beam, from one plane to another. A level, or the part of S, is that
/// along the axis of the field where the beam enters; beside it the spin follows the field (adiabatically).
struct Steering {
  double begin = 0, end = 0;  // [m]
  MagnetShape shape;
  MagnetWalls walls;
  double x0 = 0, z0 = 0;          // [m] of the point (0, shape.height) of the magnet's frame
  double cosine = 1, sine = 0;    // of the frame's turn about the beam, from +z towards +x
  double axis_x = 0, axis_z = 1;  // of that axis: what pushes a vector is its S along it
  double mass = 1;                // [kg]
  double moment = 0;              // [J/T] the largest; signed, that of m = I or S along the axis, if constant
  int levels = 0;                 // quantum: how many levels; 0: a vector law
  MomentLaw moments;
  double tolerance = 1e-6;  // of direction, and place over the length of the magnet
  double whole = 0;         // [m] length of the magnet that this is a piece of; 0: all of it
  double chamber = std::numeric_limits<double>::infinity();  // [m] radius of its wall where it may be met
  int part = 0;
  bool operator==(const Steering&) const = default;

  static constexpr StageTraits traits{
      .ends_particles = true, .spins = SpinEffect::carried, .levels = LevelEffect::separated};
  std::size_t sums() const;
  void pass(StageContext&) const;
  void list_sums(SumSink&) const;
  double y() const;
  double cost(double speed) const;
  void explain(PlanReport&) const;
  bool follows_paths() const;
  /// A part of it from one place to another.
  Steering piece(double from, double to) const;
  /// What has met the chamber before a pole flies on with its mark (WallStop).
  bool marks_walls() const { return chamber < std::numeric_limits<double>::infinity(); }
  /// Of the magnet.
  double share() const { return whole > 0 ? (end - begin) / whole : 1; }
};
static_assert(StageKind<Steering>);
/// Its path takes VEFRL steps, symplectic and of fourth order (I. Omelyan, I. Mryglod, R. Folk, Comput. Phys.
/// Commun. 146, 188 (2002)), of h = step_angle/w at most, w^2 = |mu|/m (bend + d^2) + v^2 (sharpness + e^2):
/// bend and sharpness of FieldSize, v the speed across the beam; of moments that depend on the field, d^2 =
/// |grad B|^2/(B + scale), e = |grad B|/(B + scale) and |mu| the largest, else d = e = 0. What is left of the
/// magnet is shared out in equal steps. For particles a few mm from the beam the exit was then measured to be
/// off by less than 1e-9 m + 1e-6 of the deflection (tests/unit/transport/steering_test.cpp).
/// A step may be off by a tenth of its share of the tolerance, and by a thousandth of the tolerance where the
/// force jumps: at the zero of a constant gradient, and on the axis of a quadrupole. Where a bound by h w is
/// more than that, the force is integrated along the step by a rule of sixth order, and a step that differs
/// by more is taken anew, shorter. w asks for no step below 1/most_steps of the magnet, but close to where
/// the force jumps. What comes there again within `seldom` of these is not followed that finely; what comes
/// seldom crosses it in `hair` of one, as no step is shorter. Behind most_fine steps none is below
/// 1/most_steps any more: so much work is the most that one particle takes. Walls are asked about at the
/// begin and behind every step: between them a path may cut a convex wall by (v h)^2/8R, less than
/// step_angle^2/8 of its radius R.
namespace steering {
inline constexpr double step_angle = 0.06, most_steps = 4096, seldom = 32, hair = 0x1p-16, of_jump = 0.01;
inline constexpr double most_fine = 16384, fewest_fine = 64;  // of a whole magnet, of a piece
}  // namespace steering

/// The batch must be referred to the magnet's begin. Returns the weight that stopped at its walls [quanta].
RABILINE_KERNEL(steer, std::uint64_t(const Steering&, BatchView&))

/// What a stepped magnet does at one place: at the beam's height, or of a multipole halfway to the poles.
struct SteeringOutlook {
  double field = 0, gradient = 0;  // [T], [T/m] of |B|
  double acceleration = 0;         // [m/s^2] of the largest moment
  double rate = 0;                 // [1/s] w of Steering, for particles along the beam
  double steps = 0;                // about, at that speed
};
SteeringOutlook outlook_of(const Steering&, double speed);

/// Where what enters along the beam's axis in one of these levels meets a wall [m], in rising order, as the
/// kernel flies it; less of them than levels where some come through.
std::vector<double> stops_of(const Steering&, const std::vector<int>& levels, double speed);

}  // namespace rabiline
