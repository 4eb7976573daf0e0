// What `check` tells of the fields in one zone.
#include <cmath>
#include <numbers>
#include "core/portable_math.hpp"

#include "core/constants.hpp"
#include "transport/plan_report.hpp"

namespace rabiline {
namespace {

using constants::two_pi;

std::string hertz(double omega) { return pretty_quantity(std::abs(omega) / two_pi, Dimension::frequency); }

double length_of_second(const DriveTerm& drive) {
  return portable::hypot(drive.second[0], drive.second[1], drive.second[2]);
}
/// Mean of a drive's size over its length.
double mean_size(const DriveTerm& drive) {
  if (drive.envelope.shape == Shape::half_sine) return 2 / std::numbers::pi;
  if (drive.envelope.shape == Shape::standing_wave) {
    const double half_waves = drive.envelope.half_waves;
    const bool even = std::fmod(half_waves, 2) == 0;
    return drive.envelope.is_cosine || even ? 0 : 2 / (std::numbers::pi * half_waves);
  }
  if (drive.envelope.shape == Shape::gaussian) {
    const double ends = drive.envelope.length / (2 * drive.envelope.sigma);
    return std::sqrt(two_pi) * portable::erf(ends / std::numbers::sqrt2) / (2 * ends);
  }
  return 1;
}
/// Full width at half maximum [Hz] of Rabi's line, P = (w1/W)^2 sin^2(W T/2) with W^2 = w1^2 + (detuning)^2,
/// which falls steadily from its middle on where the tip angle w1 T is at most pi: 0.7987/T there.
double width_of_line(double w1, double time) {
  const auto flip = [&](double detuning) {
    const double rate = portable::hypot(w1, detuning);
    return portable::pow(w1 / rate * portable::sin(rate * time / 2), 2);
  };
  double inside = 0, outside = two_pi / time;
  for (int i = 0; i < 60; ++i) {
    const double middle = (inside + outside) / 2;
    (flip(middle) > flip(0) / 2 ? inside : outside) = middle;
  }
  return 2 * inside / two_pi;
}
/// What differs in time or across the beam.
void explain_shape(const DriveTerm& drive, PlanReport& report) {
  const auto seconds = [](double t) { return pretty_quantity(t, Dimension::time); };
  if (const Sweep& sweep = drive.sweep; sweep.rate != 0)
    report.line("{:>16}its frequency goes from {} to {} between {} and {}, by {:.4g} Hz/s", "",
                hertz(drive.omega), hertz(drive.omega + sweep.rate * (sweep.end - sweep.begin)),
                seconds(sweep.begin), seconds(sweep.end),
                std::copysign(sweep.rate / two_pi, sweep.rate * drive.omega));
  if (const Gate& gate = drive.gate; gate.begin != gate.end)
    report.line("{:>16}on from {} to {}{}", "", seconds(gate.begin), seconds(gate.end),
                gate.times > 1 ? fmt::format(", again every {}", seconds(gate.period)) : "");
  const Slopes& slopes = drive.slopes;
  if (slopes.phase_x != 0 || slopes.phase_z != 0)
    report.line("{:>16}phase ahead by {:.4g} deg/mm towards +x, {:.4g} deg/mm towards +z", "",
                slopes.phase_x * 0.18 / std::numbers::pi, slopes.phase_z * 0.18 / std::numbers::pi);
  if (slopes.size_x != 0 || slopes.size_z != 0)
    report.line("{:>16}amplitude grows by {:.4g} %/mm towards +x, {:.4g} %/mm towards +z", "",
                slopes.size_x / 10, slopes.size_z / 10);
}
void explain_drive(const SpinZone& zone, const DriveTerm& drive, double stay, PlanReport& report) {
  const double speed = report.flight.speed_between(zone.begin, zone.end),
               omega = drive.omega + drive.twist * speed, detuning = omega - zone.spin_rate;
  const double w1 = drive.spin_rate, rate = portable::hypot(detuning, w1);
  const bool closed = zone.kind == ZoneKind::rotating || zone.kind == ZoneKind::profiled;
  if (drive.twist != 0)
    report.line("{:>16}{} by {:.4g} deg/m along the beam: {} at this speed, {:.3g} of its precession", "",
                length_of_second(drive) > 0 ? "turns" : "its phase gets ahead",
                drive.twist * 180 / std::numbers::pi, hertz(drive.twist * speed),
                std::abs(drive.twist * speed / (zone.spin_rate != 0 ? zone.spin_rate : w1)));
  if (drive.omega == 0) return;
  explain_shape(drive, report);
  if (!closed) {
    report.line("{:>16}{} at {}, {:.4g} deg of precession in its full size", "",
                length_of_second(drive) > 0 ? "turns" : "oscillates", hertz(drive.omega),
                std::abs(w1) * stay * 180 / std::numbers::pi);
    return;
  }
  report.line("{:>16}rotates at {} about {}z, off resonance by {:+.4g} Hz, tip angle {:.4g} deg on resonance",
              "", hertz(drive.omega), drive.omega < 0 ? '-' : '+', (omega < 0 ? -1 : 1) * detuning / two_pi,
              std::abs(w1) * mean_size(drive) * stay * 180 / std::numbers::pi);
  if (zone.kind == ZoneKind::rotating) {
    const double tip = std::abs(w1) * stay;
    const bool one_peak = tip > 0 && tip < 1.001 * std::numbers::pi;
    report.line("{:>16}1/T = {}{}, flip probability of spin 1/2 here {:.4g}", "",
                pretty_quantity(1 / stay, Dimension::frequency),
                one_peak
                    ? fmt::format(", FWHM of the line {}, both at the mean speed",
                                  pretty_quantity(width_of_line(std::abs(w1), stay), Dimension::frequency))
                    : "",
                rate > 0 ? portable::pow(w1 / rate * portable::sin(rate * stay / 2), 2) : 0.0);
  }
}

/// [rad/s] About all that stands still, on average: the static field, and those that only turn along the
/// beam.
double precession_of(const SpinZone& zone) {
  constexpr int places = 64;
  double mean = 0;
  for (int i = 0; i < places; ++i) {
    const double y = zone.begin + (zone.end - zone.begin) * (i + 0.5) / places;
    double rate[3];
    for (int k = 0; k < 3; ++k) rate[k] = zone.spin_rate * zone.frame[6 + k];
    for (int d = 0; d < zone.drives; ++d) {
      const DriveTerm& drive = zone.drive[d];
      if (drive.omega != 0) continue;
      const double angle = drive.phase + drive.twist * y;
      for (int k = 0; k < 3; ++k)
        rate[k] += drive.spin_rate *
                   (portable::cos(angle) * drive.first[k] + portable::sin(angle) * drive.second[k]);
    }
    mean += portable::hypot(rate[0], rate[1], rate[2]) / places;
  }
  return mean;
}

/// What the rotating-wave approximation leaves out: the other half of the field shifts the resonance by
/// f0 (w1/w0)^2/4 (Bloch and Siegert 1940), by less where a profile makes it weaker towards its ends.
void explain_neglected(const SpinZone& zone, PlanReport& report) {
  for (const PlacedPart& part : report.beamline.parts) {
    const auto* field = std::get_if<OscillatingField>(&part.part);
    const double begin = part.placement.at;
    if (!field || field->approximation != Approximation::rotating_wave || field->amplitude == 0 ||
        begin > zone.begin || begin + field->length < zone.end)
      continue;
    if (zone.spin_rate == 0 || (zone.drives == 1 && zone.drive[0].spin_rate == 0)) continue;
    const double w0 = std::abs(zone.spin_rate),
                 w1 = std::abs(report.species->gyromagnetic_ratio) * field->amplitude / 2;
    const double shift = w0 / two_pi * (w1 / w0) * (w1 / w0) / 4,
                 width = 1 / report.flight.time(zone.begin, zone.end);
    report.line(
        "{:>16}{}: rotating-wave approximation; the half left out would shift the resonance by {}{} ({:.2g} "
        "of "
        "1/T)",
        "", part.placement.name, std::holds_alternative<RectangularProfile>(field->profile) ? "" : "up to ",
        pretty_quantity(shift, Dimension::frequency), shift / width);
  }
}

}  // namespace

void explain_zone(const SpinZone& zone, PlanReport& report) {
  const double stay = report.flight.time(zone.begin, zone.end);
  const double precession = precession_of(zone);
  const double* axis = zone.frame + 6;
  report.line("{:>12}{:.4f} to {:.4f} m, {}: Larmor {}, {:.4g} turns{}", "", zone.begin, zone.end,
              pretty_quantity(stay, Dimension::time), hertz(precession), precession * stay / two_pi,
              zone.turned && zone.spin_rate != 0
                  ? fmt::format(" about ({:.3f}, {:.3f}, {:.3f})", axis[0], axis[1], axis[2])
                  : "");
  for (int i = 0; i < zone.drives; ++i) explain_drive(zone, zone.drive[i], stay, report);
  if (zone.kind == ZoneKind::periodic)
    report.line("{:>16}one period of {} is worked out and repeated, {} harmonics (Floquet)", "",
                hertz(zone.floquet.omega), zone.floquet.harmonics);
  else if (zone.step > 0)
    report.line("{:>16}{}: {}", "",
                zone.kind != ZoneKind::profiled                      ? "no closed form"
                : zone.drive[0].envelope.shape != Shape::rectangular ? "its size runs along the beam"
                                                                     : "it changes on the way",
                PlanReport::about_steps(stay / zone.step));
  explain_neglected(zone, report);
}

}  // namespace rabiline
