#pragma once
// The paper's Fig. 2 and eqs. 33-41: one charged particle with spin in a uniform magnetic field along z.
#include <cstdint>
#include <numbers>
#include <variant>
#include <vector>

#include "core/constants.hpp"
#include "core/unit_vector.hpp"
#include "models/motion.hpp"
#include "models/times.hpp"
#include "particle/species.hpp"

namespace rabiline {

/// How fast the particle starts.
struct StartSpeed {
  static constexpr std::string_view kind = "speed", meaning = "the speed at the start";
  double speed = 0;  // [m/s]
  bool operator==(const StartSpeed&) const = default;
};
template <>
inline constexpr auto parameters<StartSpeed> = std::tuple{
    param("speed", &StartSpeed::speed, Dimension::speed,
          {0, constants::speed_of_light, false, false, "greater than zero and less than that of light"},
          "speed at the start"),
};
struct StartLorentzFactor {
  static constexpr std::string_view kind = "lorentz_factor", meaning = "energy over rest energy at the start";
  double lorentz_factor = 1;
  bool operator==(const StartLorentzFactor&) const = default;
};
template <>
inline constexpr auto parameters<StartLorentzFactor> = std::tuple{
    param("lorentz_factor", &StartLorentzFactor::lorentz_factor, Dimension::number,
          {1, range::infinite, false, true, "greater than 1"}, "1/sqrt(1 - (v/c)^2) at the start"),
};
using ParticleSpeed = std::variant<StartSpeed, StartLorentzFactor>;
template <>
inline constexpr std::string_view tag_key<ParticleSpeed> = "";
template <>
inline constexpr std::string_view said_by_keys<ParticleSpeed> = "a speed";

/// How long it is followed.
struct ForDuration {
  static constexpr std::string_view kind = "duration", meaning = "for a time";
  double duration = 0;  // [s]
  bool operator==(const ForDuration&) const = default;
};
template <>
inline constexpr auto parameters<ForDuration> = std::tuple{
    param("duration", &ForDuration::duration, Dimension::time, range::positive,
          "how long the particle is followed"),
};
struct ForTurns {
  static constexpr std::string_view kind = "turns", meaning = "for a number of turns";
  double turns = 0;
  bool operator==(const ForTurns&) const = default;
};
template <>
inline constexpr auto parameters<ForTurns> = std::tuple{
    param("turns", &ForTurns::turns, Dimension::number, range::positive,
          "how many turns of the velocity under the Lorentz force the particle is followed"),
};
using FollowedTime = std::variant<ForTurns, ForDuration>;
template <>
inline constexpr std::string_view tag_key<FollowedTime> = "";
template <>
inline constexpr std::string_view said_by_keys<FollowedTime> = "a time";

struct ChargedParticle {
  static constexpr std::string_view
      kind = "charged_particle",
      meaning =
          "a charged particle with spin in a uniform field: Lorentz force and Thomas-BMT, or the hypothesis";
  /// Keys that go together, for help.
  static constexpr std::string_view example =
      "species: proton, field: 1 T, speed: 1000 km/s, turns: 3, samples: 1001";
  std::vector<Component> species{};  // one
  double field = 0;                  // [T] along z
  double electric_field = 0;         // [V/m]
  UnitVector electric_direction{1, 0, 0};
  ParticleSpeed speed{};
  double pitch = 0;         // [rad] between v and +z
  double spin_angle = 0;    // [rad] between S and +z: the paper's theta
  double spin_azimuth = 0;  // [rad] of S about +z, from the part of v across the field
  FollowedTime time{};
  std::uint64_t samples = 0;  // times that are written, both ends included
  bool operator==(const ChargedParticle&) const = default;
};
template <>
inline constexpr auto parameters<ChargedParticle> = std::tuple{
    param("species", &ChargedParticle::species, "the particle: of the library or one's own, with one moment"),
    param("field", &ChargedParticle::field, Dimension::magnetic_field, range::any, "uniform field along z"),
    param("electric_field", &ChargedParticle::electric_field, Dimension::electric_field, range::any,
          "uniform electric field along its direction; the hypothesis does not feel it", 0.0),
    param("electric_direction", &ChargedParticle::electric_direction,
          "direction of the electric field; x if omitted", UnitVector{1, 0, 0}),
    param("", &ChargedParticle::speed, "how fast the particle starts"),
    param("pitch", &ChargedParticle::pitch, Dimension::angle,
          {0, std::numbers::pi, true, true, "between 0 and 180 deg"},
          "angle between velocity and +z at the start; the part across z starts along +y",
          std::numbers::pi / 2),
    param("spin_angle", &ChargedParticle::spin_angle, Dimension::angle,
          {0, std::numbers::pi, true, true, "between 0 and 180 deg"},
          "angle between spin and +z at the start: theta of the paper's Fig. 2", std::numbers::pi / 2),
    param("spin_azimuth", &ChargedParticle::spin_azimuth, Dimension::angle, range::any,
          "angle about +z from the velocity's part across z to the spin's, right-handed", 0.0),
    param("", &ChargedParticle::time, "how long the particle is followed"),
    param("samples", &ChargedParticle::samples, Dimension::number, range_of_samples,
          "times that are written, both ends included"),
};

/// Motions `standard`, `larmor` and `torque` from the same start.
ModelResult solve(const ChargedParticle&);
std::vector<Fact> facts_of(const ChargedParticle&);
std::vector<Fault> faults_of(const ChargedParticle&);

}  // namespace rabiline
