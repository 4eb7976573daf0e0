#include "plan/regions.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "plan/courses.hpp"
#include "plan/geometry.hpp"

namespace rabiline {
namespace {

/// Steps per turn in a region. The path's error over the length of the flight was measured against an
/// independent integration as 1e-4 tip^2 (turns/58) (24/steps)^4, tip the largest sine of the angle between
/// spin and field, or on a short flight as tip/(2000 turns) (2 pi/steps)^4; it is proportional to how fast
/// the velocity turns, over the spin's rate, where that is less than 1. The steps are chosen to keep it, and
/// that of the direction at the end, below the usual error (tests/physics/dorado_test.cpp and
/// courses_test.cpp hold the path to it).
double steps_per_turn_of_path(double tip, double turns, double strength) {
  const double far = 32 * std::sqrt(std::sqrt(500 * tip * tip * turns / 58 * strength)),
               near = 2 * std::numbers::pi * std::sqrt(std::sqrt(tip * strength / (2e-3 * turns)));
  return std::clamp(std::max(far, near), 8.0, 1000.0);
}
/// How fast fields turn the velocity, over the rate at which they turn the spin, at most 1. Where the
/// velocity follows the field and not the spin, the tip has it already.
double strength_of(const SpinZone& zone, bool take_off) {
  if (!take_off) return 1;
  double spin = std::abs(zone.spin_rate), turn = std::abs(zone.turn_rate);
  for (int i = 0; i < zone.drives; ++i) {
    spin += std::abs(zone.drive[i].spin_rate);
    turn += std::abs(zone.drive[i].turn_rate);
  }
  return spin > 0 ? std::min(1.0, turn / spin) : 1;
}

}  // namespace

RegionGap gap_of(const GapTerm& gap) {
  return {
      gap.walls, gap.offset.x, gap.offset.z, gap.height, portable::cos(gap.tilt.y), portable::sin(gap.tilt.y),
      gap.part};
}

Aperture ChannelStretch::opening(double y) const {
  Aperture a;
  a.y = y;
  a.x0 = channel.x;
  a.z0 = channel.z;
  a.half_x = channel.half_x;
  a.half_z = channel.half_z;
  a.cosine = channel.cosine;
  a.sine = channel.sine;
  return a;
}

std::vector<ChannelStretch> channels_of(const Sections& sections) {
  std::vector<ChannelStretch> out;
  for (const Plane& plane : sections.planes) {
    const auto* plate = std::get_if<PlateTerm>(&plane.term);
    if (!plate || plate->length <= 0) continue;
    const Aperture a = aperture_of(plane.y, *plate);
    if (a.radius >= 0) continue;  // a round one is a wall of the section
    out.push_back(
        {plane.y - plate->length, plane.y, {a.x0, a.z0, a.half_x, a.half_z, a.cosine, a.sine, plane.part}});
  }
  return out;
}

void RegionMaker::begin(const Section& section) {
  section_ = &section;
  begin_ = section.begin;
}

void RegionMaker::edge(double y, RegionEdge edge) {
  if (y > begin_ || pending_.kind != EdgeKind::open) close_zone(y);
  pending_ = edge;
}

void RegionMaker::look(Sight sight) {
  const bool ends_last_zone = !region_.zones.empty() && sight.census.face.y <= begin_;
  region_.sights.push_back(std::move(sight));
  if (ends_last_zone && pending_.kind == EdgeKind::open)
    region_.zones.back().sights_passed = static_cast<int>(region_.sights.size());
}

void RegionMaker::end() { close_zone(section_->end); }

TurningRegion RegionMaker::finish(const StretchOutlook& outlook) {
  region_.outlook = outlook;
  region_.take_off_spin_component = turning_.take_off_spin_component;
  region_.most_way = 200 * (region_.zones.back().field.end -
                            region_.zones.front().field.begin);  // what circles for longer gives up
  return std::move(region_);
}

void RegionMaker::close_zone(double end) {
  if (!region_.zones.empty()) region_.edges.push_back(pending_);
  pending_ = {};
  region_.zones.push_back(zone_up_to(end));
  region_.zones.back().sights_passed = static_cast<int>(region_.sights.size());
  begin_ = end;
}

/// Largest sine of the angle that drives can open between spin and field in a zone: the tip of a spin that
/// entered along the field; the drives' own turning where the velocity follows the field and not the spin.
/// Where the path turns by much, the particle stays longer than straight flight would, and so can the tip.
double RegionMaker::tip_in(const SpinZone& zone, double stay) const {
  double tip = 0, most = 0;
  for (int i = 0; i < zone.drives; ++i) {
    const double w1 = std::abs(zone.drive[i].spin_rate),
                 rate = portable::hypot(zone.drive[i].omega - zone.spin_rate, w1);
    most += rate > 0 ? 2 * w1 / rate : 0;
    tip += turning_.take_off_spin_component ? w1 * stay : std::abs(zone.drive[i].turn_rate) * stay;
  }
  if (!turning_.take_off_spin_component) return tip;
  const double turned = std::abs(zone.turn_rate) * stay * std::min(tip, most) * std::min(tip, most);
  return turned > 0.5 ? most : std::min(tip, most);
}

void RegionMaker::fly_through_field(RegionZone& zone) {
  constexpr double fewest_steps = 8;
  zone.course = ZoneCourse::through_field;
  zone.longest = (section_->end - section_->begin) / fewest_steps;
  zone.step = zone.longest / speed_;
  const Vector3 uniform = zones_.static_field(*section_);
  zone.uniform[0] = uniform.x, zone.uniform[1] = uniform.y, zone.uniform[2] = uniform.z;
  zone.shaped_begin = static_cast<int>(region_.shaped.size());
  zones_.add_shaped_fields(*section_, zone.field, region_.shaped);
  zone.shaped_end = static_cast<int>(region_.shaped.size());
  region_.shaped.insert(region_.shaped.end(), section_->electric.begin(), section_->electric.end());
  zone.electric_end = static_cast<int>(region_.shaped.size());
  zone.gap_begin = static_cast<int>(region_.gaps.size());
  for (const GapTerm& gap : section_->gaps) region_.gaps.push_back(gap_of(gap));
  zone.gap_end = static_cast<int>(region_.gaps.size());
}

void RegionMaker::keep_in_channels(RegionZone& zone) {
  constexpr double slack = 1e-12;  // [m] places closer than that are one
  zone.channel_begin = static_cast<int>(region_.channels.size());
  for (const ChannelStretch& c : channels_) {
    if (c.begin > zone.field.begin + slack || c.end < zone.field.end - slack) continue;
    region_.channels.push_back(c.channel);
  }
  zone.channel_end = static_cast<int>(region_.channels.size());
}

RegionZone RegionMaker::zone_up_to(double end) {
  const Section& section = *section_;
  RegionZone zone;
  zone.field = zones_.zone_of(section);
  zone.field.begin = begin_;
  zone.field.end = end;
  zone.wall_radius = section.wall.radius;
  zone.wall_part = section.wall.part;
  zone.wall_x = section.wall.offset.x;
  zone.wall_z = section.wall.offset.z;
  keep_in_channels(zone);
  if (const Vector3 field = zones_.static_field(section);
      field != Vector3{} && !is_parallel(field, spins_.aligned))
    spins_.tip = 1;
  const double stay = (section.end - section.begin) / speed_,
               turns = zones_.rate_of(zone.field) * stay / (2 * std::numbers::pi);
  const double slowest_tip = std::min(1.0, slowness_ * spins_.tip + tip_in(zone.field, slowness_ * stay));
  spins_.tip = std::min(1.0, spins_.tip + tip_in(zone.field, stay));
  zone.step = stay / std::max(4.0, turns * steps_per_turn_of_path(
                                               spins_.tip, turns,
                                               strength_of(zone.field, turning_.take_off_spin_component)));
  if (zone.field.step > 0) zone.step = std::min(zone.step, zone.field.step);
  zone.step *= std::sqrt(std::sqrt(turning_.path_error / usual_path_error));  // steps are of fourth order
  SpinZone of_spin = zone.field;
  zones_.keep_tolerance(of_spin);
  // Steps of a path carry spins by way of two Gauss points, in three parts whose errors add up to a
  // fifteenth.
  if (of_spin.step < zone.field.step) zone.step = std::min(zone.step, 1.9 * of_spin.step);
  // Where the path turns by more than a radian for good, particles go round in circles and come back.
  const bool circles = turning_.take_off_spin_component && zone.field.drives > 0 &&
                       std::abs(zone.field.turn_rate) * stay * spins_.tip * spins_.tip / 4 > 1;
  if (circles) zone.detour = 2;
  const double* gravity = region_.feels.gravity;
  const DriveTerm *drives = zone.field.drive, *last = drives + zone.field.drives;
  if (section.needs_steps() || gravity[0] != 0 || gravity[2] != 0 ||
      std::any_of(drives, last, is_shaped_otherwise)) {
    fly_through_field(zone);
    return zone;
  }
  choose_course(zone, {slowness_ * stay, slowness_, zones_.rate_of(zone.field), slowest_tip,
                       turning_.path_error, turning_.take_off_spin_component});
  return zone;
}

}  // namespace rabiline
