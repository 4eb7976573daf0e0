#include "plan/courses.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "core/vector3.hpp"

namespace rabiline {
namespace {

using constants::two_pi;
constexpr double gauss_points[span_points] = {
    -0.932469514203152027812301554493994609, -0.661209386466264513661399595019905347,
    -0.238619186083196908630501721680711935, 0.238619186083196908630501721680711935,
    0.661209386466264513661399595019905347,  0.932469514203152027812301554493994609};
constexpr double longer = 1.01;  // than the stay are all spans, since paths are bent
constexpr double most_spans = 4096;

/// W is constant in the frame of the field, or in that of the precession.
bool has_constant_turning(const SpinZone& zone, bool take_off) {
  if (zone.kind == ZoneKind::precession) return true;
  return zone.kind == ZoneKind::rotating && zone.drive[0].twist == 0 && !take_off;
}
/// One rotating field, closure torque.
bool follows_one_drive(const SpinZone& zone, bool take_off) {
  return take_off && zone.kind == ZoneKind::rotating && zone.drive[0].twist == 0 && zone.spin_rate != 0;
}
bool turns_with_spin(const SpinZone& zone) { return zone.turn_rate == zone.spin_rate; }  // kappa = 1

/// The rate at which the spin turns in the frame of the rotating field.
double turning_in_frame(const SpinZone& zone) {
  return portable::hypot(zone.drive[0].spin_rate, zone.spin_rate - zone.drive[0].omega);
}

/// Spans for the velocity's quadrature. Measured against an independent integration, the place inside of a
/// span is off by K tip (2 turns)^8.5 over the turns of the flight, and less at the end of each. Where much
/// turns the path, flights may be short: half a circle takes about 1/tip^2 turns.
double quadrature_spans(const ZoneOutlook& outlook) {
  constexpr double k = 1e-5;
  const double turns = std::max(outlook.rate * outlook.stay / two_pi, 1e-3),
               tip = std::max(outlook.tip, 1e-6), shortest = std::min(turns, 1 / (tip * tip));
  const double of_a_turn =
      std::min(0.6, 0.5 * portable::pow(outlook.path_error * shortest / (k * tip), 1 / 8.5));
  return std::ceil(longer * turns / of_a_turn);
}

/// What is beyond the sixth Legendre coefficient of e^{ix}, 13 j_6(x); its largest value from there on.
double beyond_sixth(double x) {
  const double y = std::min(x, 9.5);
  return 1e-4 * portable::pow(y, 6) * portable::exp(-y * y / 30);
}
/// Error of a place over the length of the flight, and of the direction, with slow spans of that number, at
/// most as measured against an independent integration. The place is off by what is missing at the ends of a
/// span, which counts for more on the shorter flight at the mean speed, and by the quadrature; inside of it
/// also by the chirp that the spin's tip gives the velocity's turning. For kappa other than 1 the axis is off
/// likewise, and by what two corrections leave of it.
double slow_error(const SpinZone& zone, const ZoneOutlook& outlook, double spans) {
  const double kappa = zone.turn_rate / zone.spin_rate, w0 = std::abs(zone.spin_rate), tip = outlook.tip,
               rate = turning_in_frame(zone), h = longer * outlook.stay / spans,
               chirp = std::max(1.0, std::abs(kappa * (2 - kappa))) * w0 * tip * tip * h / 4,
               x = rate * h / 2 + 1.5 * chirp;
  const auto quadrature = [](double y) { return std::min(1.0, 1.5e-12 * portable::pow(y, 12)); };
  const double at_ends = 2.5 * tip * std::max(1.0, std::abs(kappa)) * outlook.slowness / (w0 * outlook.stay) *
                         std::sqrt(spans) * beyond_sixth(x);
  const double inside =
      2.5e-5 * chirp * chirp / portable::pow(spans, 4) + tip * tip * quadrature(x) + quadrature(chirp);
  const double left = std::abs(kappa * (kappa - 1)) * tip * rate / std::abs(zone.drive[0].omega),
               correction = 2.2 * std::abs(kappa) * tip * tip;
  return at_ends + inside +
         left * (0.8 * beyond_sixth(x) + w0 * outlook.stay * tip * correction * correction);
}
std::optional<double> slow_spans(const SpinZone& zone, const ZoneOutlook& outlook) {
  constexpr double largest_tip = 0.4;  // of the axis from the field, for kappa other than 1
  if (!turns_with_spin(zone) &&
      outlook.tip * std::max(1.0, std::abs(zone.turn_rate / zone.spin_rate)) > largest_tip)
    return std::nullopt;
  const double omega = zone.drive[0].omega,
               slowest =
                   std::min({std::abs(omega), std::abs(zone.spin_rate), std::abs(omega + zone.spin_rate)});
  for (double spans = 1; spans < most_spans; spans = std::ceil(1.1 * spans)) {
    if (slowest * outlook.stay / spans < two_pi) break;  // less than a turn: nothing is slow
    if (slow_error(zone, outlook, spans) < outlook.path_error) return spans;
  }
  return std::nullopt;
}

}  // namespace

SpanTable span_table(const SpinZone& zone, double span, ZoneCourse course) {
  SpanTable t;
  t.span = span;
  const double w1 = zone.drive[0].spin_rate, omega = zone.drive[0].omega, rate = turning_in_frame(zone);
  const Vector3 z{0, 0, 1}, n{w1, 0, zone.spin_rate - omega}, u = rate > 0 ? (1 / rate) * n : z;
  for (int i = 0; i <= span_points; ++i) {
    const double time = i == span_points ? span : span * (0.5 * (1 + gauss_points[i]));
    t.time[i] = time;
    const Vector3 columns[3] = {turned_about(u, rate * time, {1, 0, 0}),
                                turned_about(u, rate * time, {0, 1, 0}), turned_about(u, rate * time, z)};
    for (int k = 0; k < 3; ++k) {
      t.turn[i][k] = columns[k].x;
      t.turn[i][3 + k] = columns[k].y;
      t.turn[i][6 + k] = columns[k].z;
    }
    // chi = n . S t + omega int z . R_u(rate t) S dt
    Vector3 chi = time * n + (omega * time) * z;
    if (rate > 0) {
      const double half = portable::sin(rate * time / 2);
      chi = time * n + (omega * time * u.z) * u +
            (omega * portable::sin(rate * time) / rate) * (z - u.z * u) -
            (2 * omega * half * half / rate) * cross(u, z);
    }
    t.phase[i][0] = chi.x;
    t.phase[i][1] = chi.y;
    t.phase[i][2] = chi.z;
    const double angle =
        (course == ZoneCourse::slow_turns && i < span_points ? omega - zone.spin_rate : omega) * time;
    t.cosine[i] = portable::cos(angle);
    t.sine[i] = portable::sin(angle);
  }
  t.tip = std::min({1.0, std::abs(w1) * span, rate > 0 ? 2 * std::abs(w1) / rate : 0.0});
  t.bend = std::abs(zone.turn_rate);
  t.drive_bend = std::abs(zone.drive[0].turn_rate);
  return t;
}

void choose_course(RegionZone& zone, const ZoneOutlook& outlook) {
  const SpinZone& field = zone.field;
  if (outlook.stay == 0) return;  // between two planes at one place
  if (has_constant_turning(field, outlook.take_off_spin_component)) {
    zone.course = ZoneCourse::constant;
    zone.table.span = 4 * outlook.stay;
    return;
  }
  if (!follows_one_drive(field, outlook.take_off_spin_component)) return;
  const double mean_speed = (field.end - field.begin) / outlook.stay * outlook.slowness;
  double least = cost_of(zone, mean_speed);
  const auto offer = [&](ZoneCourse course, double spans) {
    RegionZone other = zone;
    other.course = course;
    other.table.span = longer * outlook.stay / spans;
    const double cost = cost_of(other, mean_speed);
    if (cost >= least) return;
    least = cost;
    zone.course = course;
    zone.table = span_table(field, other.table.span, course);
  };
  if (turns_with_spin(field)) offer(ZoneCourse::joint_turns, quadrature_spans(outlook));
  if (const auto spans = slow_spans(field, outlook)) offer(ZoneCourse::slow_turns, *spans);
}

}  // namespace rabiline
