#pragma once
// How the model `charged_particle` moves: its start, what turns spin and momentum, and the paths.
#include <vector>

#include "core/vector3.hpp"
#include "models/charged_particle.hpp"

namespace rabiline::charged {

/// The start in SI, and the two rates that everything turns by.
struct Particle {
  double mass = 0, charge = 0;  // [kg], [C]
  double gamma = 0;             // [rad/(s T)] of mu = gamma S
  double charge_rate = 0;       // [rad/(s T)] q/m
  double anomalous_rate = 0;    // [rad/(s T)] a q/m = gamma - q/m, which has a meaning without a charge, too
  Vector3 b{}, e{};             // [T], [V/m]
  double speed = 0, lorentz = 1;  // [m/s]
  Vector3 velocity{}, spin{};     // [m/s], unit vector
};

Particle particle_of(const ChargedParticle&);

/// The spin turns with this, dS/dt = W x S (V. Bargmann, L. Michel, V. Telegdi, Phys. Rev. Lett. 2, 435
/// (1959); J. Jackson, Classical Electrodynamics, 3rd ed., eq. 11.170): in the laboratory's time, S in the
/// rest frame,
///   W = -(q/m) [(a + 1/g) B - a g/(g+1) (v.B) v/c^2 - (a + 1/(g+1)) v x E/c^2],  g the Lorentz factor.
Vector3 bmt(const Particle&, const Vector3& v, double lorentz);
/// The momentum turns with this where no field does work: v x (v x E) = -v^2 E for E across v.
Vector3 turning_of_momentum(const Particle&, const Vector3& v, double lorentz);
/// The fastest turning that any motion has [rad/s], or 0.
double fastest_rate(const Particle&);

/// Position, velocity and direction of the spin at all times.
struct Path {
  std::vector<Vector3> position{}, velocity{}, spin{};
  std::vector<double> lorentz{};
};

/// Exact special relativity: dp/dt = q (E + v x B) for u = p/p0; dS/dt = W x S.
Path standard_path(const Particle&, const std::vector<double>& times);
/// The hypothesis: dS/dt = gamma S x B, dv/dt = W x v instead of the Lorentz force.
Path hypothesis_path(const Particle&, const std::vector<double>& times, bool torque);

}  // namespace rabiline::charged
