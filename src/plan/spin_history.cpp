#include "plan/spin_history.hpp"

#include <algorithm>

#include "plan/period.hpp"
#include "section/magnet_field.hpp"

namespace rabiline {
namespace {

/// Where the source's levels have their axis.
UnitVector axis_of(const StartSpin& spin) {
  if (const auto* polarised = std::get_if<PolarisedSpin>(&spin)) return upwards(polarised->axis);
  if (const auto* populated = std::get_if<PopulatedSpin>(&spin)) return upwards(populated->axis);
  return {};
}

bool is_along_z(const UnitVector& axis) { return axis.x == 0 && axis.y == 0; }

}  // namespace

bool spins_along_z(const StartSpin& spin, bool quantum) {
  const auto* polarised = std::get_if<PolarisedSpin>(&spin);
  return !quantum && polarised != nullptr && polarised->axis.x == 0 && polarised->axis.y == 0;
}

const Plane* SpinHistory::last_known_spin(double y, const Plane* before) const {
  const Plane* last = nullptr;
  for (const Plane& plane : sections_.planes) {
    if (&plane == before || plane.y > y)
      break;  // what stands at the same place comes in the order of the list
    if (std::holds_alternative<AlignTerm>(plane.term) || std::holds_alternative<FilterTerm>(plane.term) ||
        std::holds_alternative<MagnetTerm>(plane.term))
      last = &plane;
  }
  return last;
}

const Stretch* SpinHistory::last_stretch(double y) const {
  const Stretch* last = nullptr;
  for (const Stretch& stretch : stepped_)
    if (stretch.begin < y) last = &stretch;
  return last;
}

double SpinHistory::known_before(const Plane& plane) const { return known_before(plane.y, &plane); }

double SpinHistory::known_before(double y, const Plane* plane) const {
  const Stretch* stepped = last_stretch(y);
  const double carried = stepped != nullptr ? std::min(stepped->end, y) : 0;
  const Plane* last = last_known_spin(y, plane);
  if (last == nullptr) return carried;
  // In a magnet whose field points elsewhere from place to place spins follow it.
  const auto* magnet = std::get_if<MagnetTerm>(&last->term);
  return std::max(carried,
                  magnet != nullptr && magnet->shape.kind != MagnetKind::gradient ? magnet->end : last->y);
}

std::vector<SpinZone> SpinHistory::zones_between(double from, double to) const {
  std::vector<SpinZone> zones;
  const auto is_between = [&](const Section& section) {
    return std::max(section.begin, from) < std::min(section.end, to);
  };
  zones.reserve(static_cast<std::size_t>(std::ranges::count_if(sections_.sections, is_between)));
  for (const Section& section : sections_.sections) {
    if (!is_between(section)) continue;
    SpinZone& zone = zones.emplace_back(zones_.zone_of(section));
    zone.begin = std::max(zone.begin, from);
    zone.end = std::min(zone.end, to);
    if (zone.spin_rate == 0 && zone.drives == 0) {
      zones.pop_back();
      continue;
    }
    repeat_period(zone, zones_.speed());
    zones_.keep_tolerance(zone);
  }
  return zones;
}

std::vector<SpinZone> SpinHistory::zones_before(const Plane& plane) const {
  return zones_between(known_before(plane), plane.y);
}

/// What stands at its begin comes before it.
std::vector<SpinZone> SpinHistory::zones_before(const Stretch& stretch) const {
  const auto behind = std::ranges::upper_bound(sections_.planes, stretch.begin, {}, &Plane::y);
  const Plane* next = behind == sections_.planes.end() ? nullptr : &*behind;
  return zones_between(known_before(stretch.begin, next), stretch.begin);
}

std::vector<SpinZone> SpinHistory::zones_before_levels(const Plane& plane, const UnitVector& axis) const {
  const std::vector<SpinZone> zones = zones_before(plane);
  const std::optional<UnitVector> start = start_before(plane);
  const bool starts_along_z = start && is_along_z(*start);
  const auto last =
      is_along_z(axis) ? std::find_if(zones.rbegin(), zones.rend(), moves_spin_along_z).base() : zones.end();
  const auto first =
      starts_along_z ? std::find_if(zones.begin(), zones.end(), moves_spin_along_z) : zones.begin();
  return first < last ? std::vector<SpinZone>(first, last) : std::vector<SpinZone>{};
}

std::optional<UnitVector> SpinHistory::start_before(const Plane& plane) const {
  const Plane* last = last_known_spin(plane.y, &plane);
  const Stretch* stepped = last_stretch(plane.y);
  if (stepped != nullptr && (last == nullptr || last->y < stepped->end))
    return stepped->outlook.sorts ? std::optional(stepped->exit) : std::nullopt;
  if (last == nullptr) return axis_of(source_.spin);
  if (const auto* magnet = std::get_if<MagnetTerm>(&last->term)) return spin_axis(*magnet);
  const auto* align = std::get_if<AlignTerm>(&last->term);
  return align != nullptr ? std::optional(UnitVector{align->axis.x, align->axis.y, align->axis.z})
                          : std::nullopt;
}

}  // namespace rabiline
