#pragma once
// A histogram that a user wants of what crosses a plane.
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "parameter/parameter.hpp"
#include "core/unit_vector.hpp"
#include "tally/quantity.hpp"

namespace rabiline {

template <>
inline constexpr auto choices<Quantity> = std::array{
    Choice<Quantity>{"x", Quantity::x, "place across the beam"},
    Choice<Quantity>{"z", Quantity::z, "place along the static field"},
    Choice<Quantity>{"y", Quantity::y, "place along the beam: that of the plane"},
    Choice<Quantity>{"time_of_flight", Quantity::time_of_flight, "time since emission"},
    Choice<Quantity>{"speed", Quantity::speed, "size of the velocity"},
    Choice<Quantity>{"wavelength", Quantity::wavelength, "de Broglie's h/(m v)"},
    Choice<Quantity>{"energy", Quantity::energy, "kinetic energy m v^2/2"},
    Choice<Quantity>{"angle_x", Quantity::angle_x, "atan(v_x/v_y)"},
    Choice<Quantity>{"angle_z", Quantity::angle_z, "atan(v_z/v_y)"},
    Choice<Quantity>{"angle", Quantity::angle, "between the velocity and the beam, 0 to 180 deg"},
    Choice<Quantity>{"spin", Quantity::spin,
                     "projection of the spin on `axis` over I, -1 to 1; under quantum each particle's weight "
                     "is split over the outcomes"},
    Choice<Quantity>{"spin_polar_angle", Quantity::spin_polar_angle,
                     "angle between the spin and +z, 0 to 180 deg (classical, dorado)"},
    Choice<Quantity>{"spin_azimuth", Quantity::spin_azimuth,
                     "angle of the spin about +z, from +x towards +y, -180 to 180 deg, 0 of a spin along z; "
                     "its mean is that of directions (classical, dorado)"},
    Choice<Quantity>{"level", Quantity::level,
                     "m along +z, one bin for each from -I to I, the weight split over them (quantum)"},
    Choice<Quantity>{"prepared_level", Quantity::prepared_level,
                     "m that the source or a polarizer gave the particle last, from -I to I (quantum)"},
    Choice<Quantity>{"weight", Quantity::weight, "what one particle counts; 1 where nothing takes off"},
};

constexpr std::string_view word_of(Quantity quantity) {
  for (const auto& choice : choices<Quantity>)
    if (choice.value == quantity) return choice.word;
  return "";
}

/// What the ends of an axis are written in.
constexpr Dimension dimension_of(Quantity q) {
  switch (q) {
    case Quantity::x:
    case Quantity::z:
    case Quantity::y:
    case Quantity::wavelength:
      return Dimension::length;
    case Quantity::time_of_flight:
      return Dimension::time;
    case Quantity::speed:
      return Dimension::speed;
    case Quantity::energy:
      return Dimension::energy;
    case Quantity::angle_x:
    case Quantity::angle_z:
    case Quantity::angle:
    case Quantity::spin_polar_angle:
    case Quantity::spin_azimuth:
      return Dimension::angle;
    default:
      return Dimension::number;
  }
}
/// Has one bin for each value instead of a range.
constexpr bool is_categorical(Quantity q) { return q == Quantity::level || q == Quantity::prepared_level; }
/// Is known of a spin that is a vector only.
constexpr bool is_of_vector_spin(Quantity q) {
  return q == Quantity::spin_polar_angle || q == Quantity::spin_azimuth;
}
/// Asks what the fields have done to the spin.
constexpr bool asks_for_spin(Quantity q) {
  return q == Quantity::spin || q == Quantity::level || is_of_vector_spin(q);
}
/// Goes in a circle, so that its mean is that of directions.
constexpr bool is_circular(Quantity q) { return q == Quantity::spin_azimuth; }

/// One end of an axis, in SI; its unit follows the quantity.
struct AxisEnd {
  double value = 0;
  bool operator==(const AxisEnd&) const = default;
};
inline constexpr std::uint64_t most_tally_bins = 1'000'000;  // of one tally
inline constexpr std::size_t most_tally_axes = 3;
inline constexpr Range tally_bins{1, static_cast<double>(most_tally_bins), true, true, "from 1 to 1000000"};

struct TallyAxis {
  Quantity quantity = Quantity::x;
  std::optional<AxisEnd> from, to;    // none of a categorical quantity
  std::optional<std::uint64_t> bins;  // likewise
  std::optional<UnitVector> axis;     // of `spin` only
  bool operator==(const TallyAxis&) const = default;
};
template <>
inline constexpr auto parameters<TallyAxis> = std::tuple{
    param("quantity", &TallyAxis::quantity, "what the axis is over"),
    param("from", &TallyAxis::from, "where the axis begins, in the unit of the quantity; not of levels"),
    param("to", &TallyAxis::to, "where it ends; this end belongs to the last bin"),
    param("bins", &TallyAxis::bins, Dimension::number, tally_bins,
          "how many; those of all axes multiply to at most 1000000"),
    param("axis", &TallyAxis::axis, "direction that `spin` is projected on, and of nothing else"),
};

struct Tally {
  std::string name;
  std::vector<TallyAxis> axes;
  bool operator==(const Tally&) const = default;
};
template <>
inline constexpr auto parameters<Tally> = std::tuple{
    param("name", &Tally::name, "results call it by the part's name, `_` and this name"),
    param("axes", &Tally::axes, "one to three axes"),
};
/// The default of a list of tallies.
struct NoTallies {
  operator std::vector<Tally>() const { return {}; }
};

}  // namespace rabiline
