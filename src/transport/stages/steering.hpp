#pragma once
// A deflecting magnet whose force depends on the place: stepped paths.
#include <vector>

#include "transport/kernels.hpp"
#include "transport/moment_law.hpp"
#include "transport/stage_concept.hpp"

namespace rabiline {

/// A force mu(|B|) grad |B| across the beam, from one plane to another. A level, or S_z, is that along the
/// field wherever it points: the spin follows it (adiabatically), also where the field is not along z.
struct Steering {
  double begin = 0, end = 0;  // [m]
  MagnetShape shape;
  MagnetWalls walls;
  double x0 = 0, z0 = 0;        // [m] of the point (0, shape.height) of the magnet's frame
  double cosine = 1, sine = 0;  // of the frame's turn about the beam, from +z towards +x
  double mass = 1;              // [kg]
  double moment = 0;            // [J/T] the largest; signed, that of m = I or S along the field, if constant
  int levels = 0;               // quantum: how many levels; 0: a vector law
  MomentLaw moments;
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
};
static_assert(StageKind<Steering>);
/// Its path takes VEFRL steps, symplectic and of fourth order (I. Omelyan, I. Mryglod, R. Folk, Comput. Phys.
/// Commun. 146, 188 (2002)), of h = step_angle/w at most, w^2 = |mu|/m (bend + d^2) + v^2 (sharpness + e^2):
/// bend and sharpness of FieldSize, v the speed across the beam; of moments that depend on the field, d^2 =
/// |grad B|^2/(B + scale), e = |grad B|/(B + scale) and |mu| the largest, else d = e = 0. What is left of the
/// magnet is shared out in equal steps. For particles a few mm from the beam the exit was then measured to be
/// off by less than 1e-9 m + 1e-6 of the deflection (tests/unit/transport/steering_test.cpp). No flight takes
/// more than most_steps but for those that end where the force jumps: at the zero of a constant gradient, and
/// close to the axis of a quadrupole. What comes there again within `seldom` of the shortest steps is not
/// followed that finely; what comes seldom crosses it in `hair` of one.
/// Walls are asked about at the begin and behind every step: between them a path may cut a convex wall by
/// (v h)^2/8R, less than step_angle^2/8 of its radius R.
namespace steering {
inline constexpr double step_angle = 0.06, most_steps = 4096, seldom = 32, hair = 0x1p-16;
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
