#pragma once
#include <array>

#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// `co` and `counter` follow the sign of a species' gamma; `positive` and `negative` are the same for every
/// species.
enum class Sense { co, counter, positive, negative };
template <>
inline constexpr auto choices<Sense> = std::array{
    Choice<Sense>{"co", Sense::co, "turns with the Larmor precession of the species in a field along +z"},
    Choice<Sense>{"counter", Sense::counter, "turns against it"},
    Choice<Sense>{"positive", Sense::positive, "turns right-handed about +z, from +x towards +y"},
    Choice<Sense>{"negative", Sense::negative, "turns left-handed about +z, from +x towards -y"},
};

/// The phase of a turning field at the moment a particle is emitted: drawn uniformly for each particle
/// (emission at any time of the period), zero for all (`locked`), or an angle from +x towards +y.
struct Phase {
  enum class Kind { random, locked, angle } kind = Kind::locked;
  double angle = 0;  // [rad]; 0 unless kind is angle
  bool operator==(const Phase&) const = default;
};

/// A field of constant size that turns in the xy plane, with hard edges. A zone may follow the clock of
/// another one (`oscillator`): then it takes that one's frequency, sense and start phase, and its own
/// `phase`, `locked` or an angle, is added: Ramsey's separated zones.
struct RotatingField {
  static constexpr std::string_view kind = "rotating_field",
                                    meaning = "a field H0 of constant size turning in the xy plane";
  double length = 0;                      // [m]
  double amplitude = 0;                   // [T] size of the turning field
  std::optional<double> frequency;        // [Hz] turns per second; from the oscillator where one is named
  std::optional<Sense> sense;             // from the oscillator where one is named
  Phase phase;                            // at emission
  std::optional<std::string> oscillator;  // name of the rotating_field whose clock this zone follows
  std::optional<Bore> bore;
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
    param("phase", &RotatingField::phase, "phase at emission: random, locked (zero) or an angle"),
    param("oscillator", &RotatingField::oscillator,
          "name of the rotating_field whose clock this zone follows; its own where it is missing"),
    param("bore", &RotatingField::bore, "wall around the field; none where it is missing"),
};

void contribute(const RotatingField&, const Placement&, SectionBuilder&);

}  // namespace rabiline
