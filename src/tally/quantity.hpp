#pragma once
// What a tally may be over. Plain, because kernels of every instruction set read it.

namespace rabiline {

/// A property of a particle in a plane across the beam.
enum class Quantity {
  x,                 // [m] across
  z,                 // [m] along the static field
  y,                 // [m] along the beam
  time_of_flight,    // [s] since emission
  speed,             // [m/s]
  wavelength,        // [m] h/(m v), de Broglie
  energy,            // [J] m v^2/2
  angle_x,           // [rad] atan(v_x/v_y)
  angle_z,           // [rad] atan(v_z/v_y)
  angle,             // [rad] between the velocity and the beam
  spin,              // of its projection on an axis, in units of I
  spin_polar_angle,  // [rad] of the spin from +z (vector laws)
  spin_azimuth,      // [rad] of the spin about +z, from +x towards +y; 0 of a spin along z (vector laws)
  level,             // m along +z
  prepared_level,    // m along +z that the source or a polarizer gave it last
  weight             // in particles
};

}  // namespace rabiline
