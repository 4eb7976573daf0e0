#pragma once
// How the rotating cylinder moves, moment by moment: the paper's closed solution, and its equations (6)
// integrated. Frames and signs stand in rotating_cylinder.hpp.
#include <vector>

#include "models/rotating_cylinder.hpp"

namespace rabiline::cylinder {

/// What follows from the values alone.
struct Numbers {
  double transverse = 0;        // [kg m2] I1 = I2, about an axis across the cylinder
  double longitudinal = 0;      // [kg m2] I3, about its long axis
  double spin_rate = 0;         // [rad/s] omega_3 at first
  double angular_momentum = 0;  // [kg m2/s] L = I3 omega_3
  double torque = 0;            // [N m] at first, perpendicular to the axis
  double precession = 0;        // [rad/s] Omega = M/L, eqs. 10 and 29
  double nutation_rate = 0;     // [rad/s] I3 omega_3 / I1
  double fast_top = 0;          // M I1 / L^2, small where L may be taken along the axis, eq. 7
  double radius = 0;            // [m] v/Omega of eqs. 14 and 32; 0 where there is no circle
};
Numbers numbers_of(const RotatingCylinder&);

/// The torque's size as it is written; the direction u of a torque by a field, else that of -Omega_1.
double size_of(const CylinderTorque&);
Vector3 pole_of(const CylinderTorque&);
/// [rad/s] The rate about the pole at which the axis precesses without nutation; 0 where there is none.
double steady_rate(const RotatingCylinder&, const Numbers&);
/// [rad/s] omega_1 of the axis at first; omega_2 is 0.
double start_rate(const RotatingCylinder&, const Numbers&);

/// The cylinder at one time; vectors are in the laboratory.
struct State {
  double time = 0;                  // [s]
  Vector3 position, velocity;       // [m], [m/s] of the centre of mass
  Vector3 axis;                     // e3
  Vector3 angular_momentum;         // [kg m2/s]
  Vector3 torque;                   // [N m]
  Vector3 impulse;                  // [N m s] of the torque since the start
  double omega_1 = 0, omega_2 = 0;  // [rad/s] of the frame, along e1 and e2
  double omega_3 = 0;               // [rad/s] of the spinning
  double work = 0;                  // [J] of the torque since the start
  double turned = 0;                // [rad] of the axis about the pole since the start
};

/// The fast top, L along the axis, with the velocity turning jointly: eqs. 10, 14 and 29-32, and the like for
/// the other torques.
std::vector<State> paper(const RotatingCylinder&, const Numbers&);
/// The modified Euler equations (6), with the velocity turning jointly with the frame.
std::vector<State> euler(const RotatingCylinder&, const Numbers&);

/// [rad/s] omega_1 and omega_2 that solve (6) for a torque along e2, for which they are linear.
struct Rates {
  double omega_1, omega_2;
};
Rates linear_solution(const RotatingCylinder&, const Numbers&, double time);

}  // namespace rabiline::cylinder
