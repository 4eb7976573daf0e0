#pragma once
// The fields of a section as one species sees them under one law: rates of turning instead of teslas.
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/spin_steps.hpp"
#include "section/section.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// What turns the velocity under a law: dv/dt = W x v with W = rate_per_tesla B.
struct Turning {
  double rate_per_tesla = 0;  // [rad/(s T)]
  bool take_off_spin_component = false;
  double path_error = usual_path_error;  // over the length of the flight: what steps are chosen for
  double answer_per_angle = 1;  // [1/rad] what a spin's angle moves a probability by, or the spin, at most
};
Turning turning_of(const Law&, const Species&);

/// Beyond this [rad] a phase omega t is not known well enough, and the kernels' sine has no digits left
/// (core/lanes.hpp): ten times slower particles still stay within 1e9.
inline constexpr double most_phase = 1e8;

/// Turns sections into zones for one species.
class ZoneMaker {
 public:
  /// `coil_species` is the one that coils are wound for; `speed` [m/s] is what steps are reckoned with;
  /// `latest_start` [s] is when the last particles are emitted.
  ZoneMaker(const Species& species, const Species& coil_species, Turning turning, double speed,
            double latest_start)
      : species_(species),
        coil_species_(coil_species),
        turning_(turning),
        speed_(speed),
        latest_start_(latest_start) {}

  SpinZone zone_of(const Section&) const;
  /// Puts the fields of a section that differ from place to place behind others: those that stand, then those
  /// that swing, for whose angles its zone gets drives without fields of their own.
  void add_shaped_fields(const Section&, SpinZone&, std::vector<ShapedTerm>&) const;
  /// Shortens the steps of spins through a zone that a straight flight passes until they keep the tolerance.
  void keep_tolerance(SpinZone&) const;
  /// By how much anything has turned when a particle leaves a zone [rad].
  double phase_behind(const SpinZone&) const;
  /// Sum of everything static in a section [T].
  Vector3 static_field(const Section&) const;
  double speed() const { return speed_; }
  /// The fastest turning in a zone [rad/s], of field, spin or velocity.
  double rate_of(const SpinZone&) const;

 private:
  SpinPace pace_of(const SpinZone&) const;
  DriveTerm drive_of(const RotatingTerm&, const Vector3& axis, double static_field) const;
  void choose_frame(SpinZone&, const Vector3& axis, bool is_static) const;

  const Species& species_;
  const Species& coil_species_;
  Turning turning_;
  double speed_;
  double latest_start_;
};

/// The one for a species of a beam, which must outlive it.
ZoneMaker zone_maker(const Beamline&, const Species&);

/// [rad/s] What its sweep adds to the rate of a drive in all.
double swept_in_all(const DriveTerm&);
/// Whether a drive differs in time, by a sweep or a gate, or across the beam.
bool is_shaped_otherwise(const DriveTerm&);
/// Whether anything but a static field along z acts on spins there.
bool moves_spin_along_z(const SpinZone&);

}  // namespace rabiline
