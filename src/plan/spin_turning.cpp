#include "plan/spin_turning.hpp"

#include <cmath>
#include <utility>
#include <vector>

#include "core/portable_math.hpp"
#include "plan/zones.hpp"

namespace rabiline {
namespace {

constexpr std::string_view no_closed_form = "the fields before it are no closed form of the slowness alone",
                           phases_differ =
                               "it depends on phases of the fields, which differ from particle to particle";

bool is_along_z(const double* axis) { return axis[0] == 0 && axis[1] == 0; }

/// A frame that turns with a clock about an axis.
struct Frame {
  UnitVector axis{};
  double omega = 0;  // [rad/s]
  int oscillator = -1;
  double random_turn = 0;
  bool operator==(const Frame&) const = default;

  bool is_about_z() const { return axis.x == 0 && axis.y == 0; }
  bool is_alike(bool pulsed) const { return oscillator < 0 && (omega == 0 || !pulsed); }
};

Frame frame_of(const SpinZone& zone) {
  const DriveTerm& drive = zone.drive[0];
  const bool is_random = drive.oscillator >= 0;
  if (!zone.turned || (drive.omega == 0 && !is_random))
    return {{}, drive.omega, drive.oscillator, is_random ? drive.random_turn : 0};
  const UnitVector axis{zone.frame[6], zone.frame[7], zone.frame[8]};
  // Against z with omega is along z with -omega.
  const double sign = is_along_z(zone.frame + 6) && axis.z < 0 ? -1 : 1;
  return {sign < 0 ? UnitVector{} : axis, sign * drive.omega, drive.oscillator,
          is_random ? sign * drive.random_turn : 0};
}

/// Goes along the way in the frame of what acts there.
class SpinTurning {
 public:
  explicit SpinTurning(bool pulsed) : pulsed_(pulsed) {}

  void start_along(const UnitVector& axis) {
    if (axis.x != 0 || axis.y != 0) frame_ = laboratory;
  }
  void pass(const SpinZone& zone) {
    const double length = zone.end - zone.begin;
    if (zone.drives == 0 && !zone.turned) return about_z(zone.spin_rate * length, length, zone.begin);
    if (zone.drives == 0) {
      enter(laboratory, zone.begin);
      return turn(std::abs(zone.spin_rate) * length);
    }
    if (zone.kind == ZoneKind::periodic) {
      enter(laboratory, zone.begin);
      alike_ = alike_ && frame_of(zone).is_alike(pulsed_);
      const FloquetForm& form = zone.floquet;
      // The harmonics are those of quaternions.
      return turn(std::abs(form.rate) * length +
                  2 * form.harmonics * std::abs(form.omega) * (zone.begin + zone.end));
    }
    const DriveTerm& drive = zone.drive[0];
    closed_ = closed_ && zone.kind != ZoneKind::general && !is_shaped_otherwise(drive);
    enter(frame_of(zone), zone.begin);
    turn(portable::hypot(zone.spin_rate - drive.omega, drive.spin_rate) * length);
  }
  void ask_along(const double* axis, double y) {
    if (is_along_z(axis) && (!frame_ || frame_->is_about_z())) return;
    enter(laboratory, y);
    turn(0);
  }

  std::optional<double> angle(std::string_view& why_not) const {
    why_not = closed_ ? phases_differ : no_closed_form;
    return closed_ && alike_ ? std::optional(angle_) : std::nullopt;
  }

 private:
  static constexpr Frame laboratory{};

  void turn(double angle) { angle_ += std::abs(std::exchange(about_z_, 0)) + angle; }
  /// A turn about z adds to others before and behind.
  void about_z(double angle, double length, double begin) {
    if (!frame_) return;
    if (!frame_->is_about_z()) enter(laboratory, begin);
    about_z_ += angle - frame_->omega * length;
  }
  /// Spins along z are the same in all frames about z.
  void enter(const Frame& next, double y) {
    if (!frame_) frame_ = next.is_about_z() ? next : laboratory;
    if (*frame_ == next) return;
    alike_ = alike_ && frame_->is_alike(pulsed_) && next.is_alike(pulsed_);
    if (frame_->is_about_z() && next.is_about_z())
      about_z_ += (frame_->omega - next.omega) * y;
    else
      turn((std::abs(frame_->omega) + std::abs(next.omega)) * y);
    frame_ = next;
  }

  const bool pulsed_;
  std::optional<Frame> frame_;  // nothing: spins are along z
  double angle_ = 0;
  double about_z_ = 0;  // by what spins have turned about z since something else has turned them
  bool closed_ = true, alike_ = true;
};

}  // namespace

std::optional<double> turning_along(const SpinPath& path, bool pulsed, std::string_view& why_not) {
  why_not = no_closed_form;
  if (!path.start || path.of_atom || path.transitions != nullptr || path.way != nullptr || path.levels < 2)
    return {};
  SpinTurning turning(pulsed);
  turning.start_along(*path.start);
  double end = 0;
  const auto pass = [&](const SpinZones& zones) {
    for (const SpinZone& zone : zones) {
      turning.pass(zone);
      end = zone.end;
    }
  };
  for (const FilteredZones& before : path.filters) {
    pass(before.zones);
    turning.ask_along(before.filter.axis, before.filter.at);
  }
  pass(path.zones);
  const double axis[3] = {path.axis.x, path.axis.y, path.axis.z};
  turning.ask_along(axis, end);
  return turning.angle(why_not);
}

}  // namespace rabiline
