#pragma once
// What acts on the spins of a straight flight before they reach a plane.
#include <optional>
#include <vector>

#include "plan/stretches.hpp"
#include "plan/zones.hpp"

namespace rabiline {

/// Whether every spin of a vector law starts along the static field or against it.
bool spins_along_z(const StartSpin& spin, bool quantum);

class SpinHistory {
 public:
  /// All must outlive it.
  SpinHistory(const Sections& sections, const ZoneMaker& zones, const Source& source,
              std::vector<Stretch> stepped)
      : sections_(sections), zones_(zones), source_(source), stepped_(std::move(stepped)) {}

  /// The fields since spins were last set anew or brought up to date: at the source, an alignment, a filter,
  /// or behind a stretch that is flown in steps.
  std::vector<SpinZone> zones_before(const Plane&) const;
  /// The same for levels along an axis at that plane: along z they do not care for precession about z at the
  /// end, nor at the beginning where they start along z.
  std::vector<SpinZone> zones_before_levels(const Plane&, const UnitVector& axis) const;
  /// The same at the begin of such a stretch.
  std::vector<SpinZone> zones_before(const Stretch&) const;
  /// Where spins were last set anew or brought up to date before the plane, 0 at the source [m].
  double known_before(const Plane&) const;
  /// The axis of the levels behind the source, an alignment or a magnet, whichever came last before the
  /// plane; nothing where it differs from particle to particle, as behind a filter.
  std::optional<UnitVector> start_before(const Plane&) const;

 private:
  const Plane* last_known_spin(double y, const Plane* before) const;
  double known_before(double y, const Plane*) const;
  /// The last stretch that begins before `y`, or null.
  const Stretch* last_stretch(double y) const;
  std::vector<SpinZone> zones_between(double from, double to) const;

  const Sections& sections_;
  const ZoneMaker& zones_;
  const Source& source_;
  const std::vector<Stretch> stepped_;
};

}  // namespace rabiline
