#pragma once
#include <array>

#include "parts/drive_shape.hpp"
#include "parts/fringe.hpp"
#include "parts/phase.hpp"
#include "parts/placement.hpp"
#include "parts/profile.hpp"

namespace rabiline {

class SectionBuilder;

/// What of an oscillating field acts on the spins.
enum class Approximation { rotating_wave, none };
template <>
inline constexpr auto choices<Approximation> = std::array{
    Choice<Approximation>{"rotating_wave", Approximation::rotating_wave,
                          "only the half that turns with the precession: a closed form"},
    Choice<Approximation>{"none", Approximation::none, "the whole field, integrated step by step"},
};

/// A field A cos(2 pi f t + phase) along one axis: two counter-rotating fields of A/2 each. In the
/// rotating-wave approximation only the one is kept that turns with the precession of a species about the
/// static field; what is left out shifts the resonance by the Bloch-Siegert shift, about f0 (w1/w0)^2 / 4
/// with w1 = |gamma| A/2 (Bloch and Siegert 1940). A zone may follow the clock of another oscillating_field.
struct OscillatingField {
  static constexpr std::string_view
      kind = "oscillating_field",
      meaning = "a field A cos(2 pi f t) along one axis, as a radio-frequency coil makes it";
  static constexpr PartTraits traits{.field = true, .drives = true};
  double length = 0;                // [m]
  double amplitude = 0;             // [T] peak
  std::optional<double> frequency;  // [Hz]; from the oscillator where one is named
  Approximation approximation = Approximation::rotating_wave;
  Phase phase;                            // at emission
  std::optional<std::string> oscillator;  // name of the oscillating_field whose clock this zone follows
  UnitVector direction{1, 0, 0};
  double phase_advance = 0;  // [rad]
  DriveProfile profile{};
  Fringe fringe{};
  std::optional<Bore> bore;
  std::optional<FrequencySweep> sweep{};  // of its own clock
  std::optional<PulseTrain> pulses{};
  PhaseGradient phase_gradient{};
  AmplitudeGradient amplitude_gradient{};
  Offset offset{};
  Tilt tilt{};
  bool operator==(const OscillatingField&) const = default;
};
template <>
inline constexpr auto parameters<OscillatingField> = std::tuple{
    param("length", &OscillatingField::length, Dimension::length, range::positive, "extent along the beam"),
    param("amplitude", &OscillatingField::amplitude, Dimension::magnetic_field, range::not_negative,
          "peak of the field: twice the size of each of its turning halves"),
    param("frequency", &OscillatingField::frequency, Dimension::frequency, range::not_negative,
          "periods per second; omitted where an oscillator is named"),
    param("approximation", &OscillatingField::approximation, "which part of the field acts"),
    param("phase", &OscillatingField::phase,
          "phase at emission: random, locked (zero) or an angle; beside an oscillator the angle is added to "
          "that of its "
          "clock"),
    param("oscillator", &OscillatingField::oscillator,
          "name of the oscillating_field whose clock this zone follows; its own if omitted"),
    param("direction", &OscillatingField::direction, "axis along which it oscillates; x if omitted",
          UnitVector{1, 0, 0}),
    param("profile", &OscillatingField::profile,
          "how its amplitude runs along its length; rectangular if omitted", DriveProfile{}),
    param("fringe", &OscillatingField::fringe,
          "how it ends along the beam, followed as a whole field; hard if omitted", Fringe{}),
    param("phase_advance", &OscillatingField::phase_advance, Dimension::angle, range::any,
          "angle by which its phase gets ahead over its length: a wave that travels against the beam", 0.0),
    param("bore", &OscillatingField::bore, "wall around the field; none if omitted"),
    param("sweep", &OscillatingField::sweep, "how its frequency changes in time; not at all if omitted"),
    param("pulses", &OscillatingField::pulses, "when it is on; always if omitted"),
    param("phase_gradient", &OscillatingField::phase_gradient,
          "how its phase differs across the beam, from its axis; not at all if omitted", PhaseGradient{}),
    param("amplitude_gradient", &OscillatingField::amplitude_gradient,
          "how its amplitude differs across the beam, from its axis; not at all if omitted",
          AmplitudeGradient{}),
    param("offset", &OscillatingField::offset, "displacement of its axis and of the bore from the beam's",
          Offset{}),
    param("tilt", &OscillatingField::tilt, "how the field is turned inside its slab", Tilt{}),
};

void contribute(const OscillatingField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const OscillatingField&, const Placement&);

}  // namespace rabiline
