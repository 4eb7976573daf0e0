#pragma once
#include <array>

#include "parts/drive_shape.hpp"
#include "parts/fringe.hpp"
#include "parts/phase.hpp"
#include "parts/placement.hpp"
#include "parts/profile.hpp"

namespace rabiline {

class SectionBuilder;

/// `co` and `counter` follow the sign of a species' gamma; `positive` and `negative` are the same for every
/// species.
enum class Sense { co, counter, positive, negative };
template <>
inline constexpr auto choices<Sense> = std::array{
    Choice<Sense>{
        "co", Sense::co,
        "turns with the Larmor precession of the species in a field along +z, and so against it in one along "
        "-z"},
    Choice<Sense>{"counter", Sense::counter, "turns the other way: with the precession in a field along -z"},
    Choice<Sense>{"positive", Sense::positive, "turns right-handed about +z, from +x towards +y"},
    Choice<Sense>{"negative", Sense::negative, "turns left-handed about +z, from +x towards -y"},
};

/// A field of constant size that turns in the xy plane, with hard edges. A zone may follow the clock of
/// another one (`oscillator`): then it takes that one's frequency, sense and start phase, and its own
/// `phase`, `locked` or an angle, is added: Ramsey's separated zones.
struct RotatingField {
  static constexpr std::string_view kind = "rotating_field",
                                    meaning = "a field H0 of constant size turning in the xy plane";
  static constexpr PartTraits traits{.field = true, .drives = true};
  double length = 0;                      // [m]
  double amplitude = 0;                   // [T] size of the turning field
  std::optional<double> frequency;        // [Hz] turns per second; from the oscillator where one is named
  std::optional<Sense> sense;             // from the oscillator where one is named
  Phase phase;                            // at emission
  std::optional<std::string> oscillator;  // name of the rotating_field whose clock this zone follows
  std::optional<Bore> bore;
  DriveProfile profile{};
  Fringe fringe{};
  double twist = 0;                       // [rad]
  std::optional<FrequencySweep> sweep{};  // of its own clock
  std::optional<PulseTrain> pulses{};
  PhaseGradient phase_gradient{};
  AmplitudeGradient amplitude_gradient{};
  Offset offset{};
  Tilt tilt{};
  bool operator==(const RotatingField&) const = default;
};
template <>
inline constexpr auto parameters<RotatingField> = std::tuple{
    param("length", &RotatingField::length, Dimension::length, range::positive, "extent along the beam"),
    param("amplitude", &RotatingField::amplitude, Dimension::magnetic_field, range::not_negative,
          "size of the turning field, H0"),
    param("frequency", &RotatingField::frequency, Dimension::frequency, range::not_negative,
          "turns per second; omitted where an oscillator is named"),
    param("sense", &RotatingField::sense, "sense of turning; omitted where an oscillator is named"),
    param("phase", &RotatingField::phase,
          "azimuth at emission, from +x towards +y whatever the sense: random, locked (zero) or an angle; "
          "beside an "
          "oscillator the angle is added to that of its clock"),
    param("oscillator", &RotatingField::oscillator,
          "name of the rotating_field whose clock this zone follows; its own if omitted"),
    param("bore", &RotatingField::bore, "wall around the field; none if omitted"),
    param("profile", &RotatingField::profile, "how its size runs along its length; rectangular if omitted",
          DriveProfile{}),
    param("fringe", &RotatingField::fringe,
          "how it ends along the beam, followed as a whole field; hard if omitted", Fringe{}),
    param("twist", &RotatingField::twist, Dimension::angle, range::any,
          "angle by which the field's direction also turns over its length, right-handed about +z", 0.0),
    param("sweep", &RotatingField::sweep, "how its frequency changes in time; not at all if omitted"),
    param("pulses", &RotatingField::pulses, "when it is on; always if omitted"),
    param("phase_gradient", &RotatingField::phase_gradient,
          "how its phase differs across the beam, from its axis; not at all if omitted", PhaseGradient{}),
    param("amplitude_gradient", &RotatingField::amplitude_gradient,
          "how its amplitude differs across the beam, from its axis; not at all if omitted",
          AmplitudeGradient{}),
    param("offset", &RotatingField::offset, "displacement of its axis and of the bore from the beam's",
          Offset{}),
    param("tilt", &RotatingField::tilt, "how the field is turned inside its slab", Tilt{}),
};

void contribute(const RotatingField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const RotatingField&, const Placement&);

}  // namespace rabiline
