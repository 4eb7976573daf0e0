#pragma once
// Plain, because kernels of every instruction set read what uses it.

namespace rabiline {

/// What kind of quantity a number is. Each dimension has one SI unit that the program computes in.
enum class Dimension {
  number,          // a pure number
  length,          // m
  time,            // s
  speed,           // m/s
  mass,            // kg
  charge,          // C
  magnetic_field,  // T
  frequency,       // Hz: turns per second, never radians
  angle,           // rad
  gyromagnetic,    // rad/(s T): "MHz/T" is accepted and means gamma/2pi, turns; "rad/s/T" means gamma itself
  temperature,     // K, absolute
  energy,          // J
  rate,            // 1/s: what happens so many times a second; never a frequency
  field_gradient,  // T/m
  current,         // A
  torque,          // N m
  electric_field,  // V/m
  area,            // m^2
  number_density,  // 1/m^3
  pressure,        // Pa
  acceleration,    // m/s^2
  angle_per_length,  // rad/m
  per_length,        // 1/m
  electric_dipole    // C m
};
inline constexpr Dimension last_dimension = Dimension::electric_dipole;

}  // namespace rabiline
