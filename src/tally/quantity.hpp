#pragma once
// What a tally may be over: one row for each quantity. How kernels get its value from a particle in a plane
// stands in transport/tally_kernels.cpp. Plain, because kernels of every instruction set read it.
#include "core/dimension.hpp"

namespace rabiline {

/// A property of a particle in a plane across the beam.
enum class Quantity {
  x,
  z,
  y,
  time_of_flight,
  start_time,
  speed,
  wavelength,
  energy,
  angle_x,
  angle_z,
  angle,
  spin,
  spin_polar_angle,
  spin_azimuth,
  level,
  prepared_level,
  adiabaticity,
  adiabaticity_y,
  weight
};

/// Values that a quantity can have, in SI; `words` completes "must be ...".
struct Limits {
  double low = -1e300, high = 1e300;
  const char* words = "finite";
};

struct QuantityRow {
  Quantity quantity;
  const char *word, *meaning;
  Dimension dimension;  // what the ends of an axis are written in
  Limits limits;
  const char *from, *to;        // the ends of an axis that a bench could have
  const char* title = nullptr;  // what plots write along the axis, where it is not the word
  bool categorical = false;     // has one bin for each value instead of a range
  bool of_spin = false;         // asks what the fields have done to the spin
  bool of_vector_spin = false;  // is known of a spin that is a vector only
  bool circular = false;        // goes in a circle, so that its mean is that of directions
};

namespace limits {
inline constexpr double pi = 3.141592653589793;
inline constexpr Limits any{}, not_negative{0, 1e300, "zero or greater"};
}  // namespace limits

inline constexpr QuantityRow quantity_rows[] = {
    {Quantity::x, "x", "place across the beam", Dimension::length, limits::any, "-2 mm", "2 mm"},
    {Quantity::z, "z", "place along the static field", Dimension::length, limits::any, "-2 mm", "2 mm"},
    {Quantity::y, "y", "place along the beam: that of the plane", Dimension::length, limits::any, "0 m",
     "2 m"},
    {Quantity::time_of_flight, "time_of_flight",
     "time since emission; of a pulsed source since the pulse's t = 0, so start time and flight together",
     Dimension::time, limits::any, "0 ms", "5 ms"},
    {Quantity::start_time, "start_time",
     "when the particle left the source, from the pulse's t = 0 on; 0 without a pulse", Dimension::time,
     limits::any, "0 us", "100 us"},
    {Quantity::speed, "speed", "size of the velocity", Dimension::speed, limits::not_negative, "0 m/s",
     "2000 m/s"},
    {Quantity::wavelength, "wavelength", "de Broglie's h/(m v)", Dimension::length, limits::not_negative,
     "0 nm", "2 nm"},
    {Quantity::energy, "energy", "kinetic energy m v^2/2", Dimension::energy, limits::not_negative, "0 meV",
     "100 meV"},
    {Quantity::angle_x, "angle_x", "atan(v_x/v_y)", Dimension::angle, limits::any, "-5 mrad", "5 mrad"},
    {Quantity::angle_z, "angle_z", "atan(v_z/v_y)", Dimension::angle, limits::any, "-5 mrad", "5 mrad"},
    {Quantity::angle, "angle", "between the velocity and the beam, 0 to 180 deg", Dimension::angle,
     limits::not_negative, "0 mrad", "10 mrad"},
    {.quantity = Quantity::spin,
     .word = "spin",
     .meaning = "projection of the spin on `axis` over I, -1 to 1; under quantum each particle's weight is "
                "split over "
                "the outcomes",
     .dimension = Dimension::number,
     .limits = {-1, 1, "between -1 and 1"},
     .from = "-1",
     .to = "1",
     .of_spin = true},
    {.quantity = Quantity::spin_polar_angle,
     .word = "spin_polar_angle",
     .meaning = "angle between the spin and +z, 0 to 180 deg (classical, dorado)",
     .dimension = Dimension::angle,
     .limits = {0, limits::pi, "from 0 to 180 deg"},
     .from = "0 deg",
     .to = "180 deg",
     .title = "polar angle of the spin from +z",
     .of_spin = true,
     .of_vector_spin = true},
    {.quantity = Quantity::spin_azimuth,
     .word = "spin_azimuth",
     .meaning = "angle of the spin about +z, from +x towards +y, -180 to 180 deg, 0 of a spin along z; its "
                "mean is that "
                "of directions (classical, dorado)",
     .dimension = Dimension::angle,
     .limits = {-limits::pi, limits::pi, "from -180 to 180 deg"},
     .from = "-180 deg",
     .to = "180 deg",
     .title = "azimuth of the spin about +z",
     .of_spin = true,
     .of_vector_spin = true,
     .circular = true},
    {.quantity = Quantity::level,
     .word = "level",
     .meaning =
         "m along +z, one bin for each from I down to -I, or an atom's level along the field there; the "
         "weight split over them (quantum)",
     .dimension = Dimension::number,
     .limits = limits::any,
     .from = "",
     .to = "",
     .title = "m along +z, or an atom's level along the field there",
     .categorical = true,
     .of_spin = true},
    {.quantity = Quantity::prepared_level,
     .word = "prepared_level",
     .meaning = "m that the source or a polarizer gave the particle last, from I down to -I (quantum)",
     .dimension = Dimension::number,
     .limits = limits::any,
     .from = "",
     .to = "",
     .title = "m along +z, or an atom's level along the field there, that the particle was prepared in",
     .categorical = true},
    {Quantity::adiabaticity, "adiabaticity",
     "the smallest Larmor frequency over the rate at which the static field turns, on the way through fields "
     "that differ "
     "from place to place (Majorana)",
     Dimension::number, limits::not_negative, "0", "10", "smallest adiabaticity on the way"},
    {Quantity::adiabaticity_y, "adiabaticity_y", "place along the beam where the adiabaticity was smallest",
     Dimension::length, limits::any, "0 m", "2 m"},
    {Quantity::weight, "weight", "what one particle counts; 1 where nothing takes off", Dimension::number,
     limits::not_negative, "0", "1", "weight in particles"},
};

/// Rows stand in the order of the enum.
constexpr const QuantityRow& row_of(Quantity q) { return quantity_rows[static_cast<int>(q)]; }
constexpr bool rows_are_in_order() {
  int i = 0;
  for (const QuantityRow& row : quantity_rows)
    if (static_cast<int>(row.quantity) != i++) return false;
  return true;
}
static_assert(rows_are_in_order());

constexpr bool is_categorical(Quantity q) { return row_of(q).categorical; }
constexpr bool is_of_vector_spin(Quantity q) { return row_of(q).of_vector_spin; }
constexpr bool asks_for_spin(Quantity q) { return row_of(q).of_spin; }
constexpr bool is_circular(Quantity q) { return row_of(q).circular; }
constexpr Dimension dimension_of(Quantity q) { return row_of(q).dimension; }

}  // namespace rabiline
