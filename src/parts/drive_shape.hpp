#pragma once
// How a field with a clock changes in time, and how it differs across the beam. Times count as the clock
// does: from a particle's emission, or from t = 0 of a pulse.
#include <optional>

#include "field/terms.hpp"
#include "parameter/parameter.hpp"
#include "particle/opening.hpp"

namespace rabiline {

/// A chirp: the frequency goes evenly from the field's own to another one.
struct FrequencySweep {
  double to = 0;              // [Hz]
  double begin = 0, end = 0;  // [s]
  bool operator==(const FrequencySweep&) const = default;
};
template <>
inline constexpr auto parameters<FrequencySweep> = std::tuple{
    param("to", &FrequencySweep::to, Dimension::frequency, range::any, "frequency at its end and behind it"),
    param("begin", &FrequencySweep::begin, Dimension::time, range::not_negative,
          "when it begins: until then the field has its `frequency`", 0.0),
    param("end", &FrequencySweep::end, Dimension::time, range::positive, "when it ends"),
};

/// A pulse, or a train of them with sharp edges.
struct PulseTrain {
  double begin = 0, end = 0;           // [s] of the first
  std::optional<double> period;        // [s]
  std::optional<std::uint64_t> times;  // how many; without end where it is missing
  bool operator==(const PulseTrain&) const = default;
};
template <>
inline constexpr auto parameters<PulseTrain> = std::tuple{
    param("begin", &PulseTrain::begin, Dimension::time, range::not_negative, "when the field is switched on",
          0.0),
    param("end", &PulseTrain::end, Dimension::time, range::positive, "when it is switched off"),
    param("period", &PulseTrain::period, Dimension::time, range::positive,
          "from one pulse to the next; one pulse alone if omitted"),
    param("times", &PulseTrain::times, Dimension::number, range::at_least_one,
          "how many pulses; without end if omitted"),
};

/// Where a cavity's walls take up power its phase differs over the opening.
struct PhaseGradient {
  double x = 0, z = 0;  // [rad/m]
  bool operator==(const PhaseGradient&) const = default;
};
template <>
inline constexpr auto parameters<PhaseGradient> = std::tuple{
    param("x", &PhaseGradient::x, Dimension::angle_per_length, range::any,
          "by how much the phase is ahead towards +x; of a rotating field its azimuth, whatever the sense",
          0.0),
    param("z", &PhaseGradient::z, Dimension::angle_per_length, range::any,
          "by how much the phase is ahead towards +z; of a rotating field its azimuth, whatever the sense",
          0.0),
};
struct AmplitudeGradient {
  double x = 0, z = 0;  // [1/m]
  bool operator==(const AmplitudeGradient&) const = default;
};
template <>
inline constexpr auto parameters<AmplitudeGradient> = std::tuple{
    param("x", &AmplitudeGradient::x, Dimension::per_length, range::any,
          "share of the amplitude by which it grows towards +x", 0.0),
    param("z", &AmplitudeGradient::z, Dimension::per_length, range::any,
          "share of the amplitude by which it grows towards +z", 0.0),
};

inline Gate gate_of(const std::optional<PulseTrain>& train) {
  if (!train) return {};
  const double times = train->times ? static_cast<double>(*train->times) : train->period ? 1e15 : 1;
  return {train->begin, train->end, train->period.value_or(0), times};
}
inline Sweep sweep_of(const std::optional<FrequencySweep>& sweep, double frequency) {
  if (!sweep) return {};
  return {(sweep->to - frequency) / (sweep->end - sweep->begin), sweep->begin, sweep->end};
}
inline Slopes slopes_of(const PhaseGradient& phase, const AmplitudeGradient& size, const Offset& centre) {
  return {phase.x, phase.z, size.x, size.z, centre.x, centre.z};
}

}  // namespace rabiline
