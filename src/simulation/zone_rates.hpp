#pragma once
// The fields of a zone as independent integrations see them: in plain numbers, without lanes.
#include "core/vector3.hpp"
#include "field/shaped_term.hpp"
#include "transport/kernels.hpp"
#include "transport/moment_law.hpp"

namespace rabiline {

/// As angular velocities of spin and velocity, or of whatever unit the zone's rates have.
struct ZoneRates {
  Vector3 spin, turn;
};
/// At a place and time, from the phases of its drives at emission. `moment`: pulses are as at that time.
ZoneRates rates_of(const SpinZone&, const double* phases, const Vector3& place, double t, double moment);

/// Adds a field that stands, or swings with the angle of a drive of the zone.
void add_field_at(const ShapedTerm&, const SpinZone&, const double* phases, const Vector3& place, double t,
                  FieldHere<double>&);

/// [J/T] of a level where |B| has that size.
double moment_at(const MomentLaw&, std::uint64_t level, double size);

/// A drive's phase at the particle's emission, as kernels draw it.
double phase_of(const DriveTerm&, const RandomKey&, std::uint64_t particle);

inline Vector3 vector_at(const double* v) { return {v[0], v[1], v[2]}; }

}  // namespace rabiline
