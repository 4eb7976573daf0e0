#include "unit/transport/sample_parts.hpp"

#include <algorithm>
#include <cmath>

namespace rabiline::test::sample {
namespace {

DriveTerm drive(double spin_rate, double omega) {
  DriveTerm d{.spin_rate = spin_rate, .turn_rate = spin_rate, .omega = omega, .phase = 0.3};
  d.envelope = {Shape::rectangular, 0.1, 0.2, 0.05};
  return d;
}

}  // namespace

Aperture rectangle(double half_x, double half_z, double angle) {
  Aperture a{.y = 0.4, .x0 = 0.2e-3, .z0 = -0.1e-3, .half_x = half_x, .half_z = half_z};
  a.cosine = std::cos(angle);
  a.sine = std::sin(angle);
  return a;
}
Aperture disc(double radius) { return {.y = 0.4, .radius = radius}; }

Screen screen() {
  Screen s{.y = 0.4,
           .x0 = 1e-4,
           .z0 = 0,
           .half_x = 2e-3,
           .half_z = 1e-3,
           .low_x = -1.9e-3,
           .low_z = -1e-3,
           .dead = {}};
  s.bins_x = 7;
  s.bins_z = 3;
  s.bins_per_x = s.bins_x / 4e-3;
  s.bins_per_z = s.bins_z / 2e-3;
  s.part = part;
  return s;
}
Screen poor_screen() {
  Screen s = screen();
  s.cosine = 0.8;
  s.sine = 0.6;
  s.efficiency = 0.7;
  s.has_dead_area = true;
  s.dead = {.half_x = 0.3e-3, .half_z = 0.4e-3};
  return s;
}

SpinZone zone(ZoneKind kind) {
  SpinZone z{
      .begin = 0.1, .end = 0.3, .spin_rate = 2e4, .turn_rate = 2e4, .kind = kind, .drive = {}, .step = 2e-5};
  if (kind == ZoneKind::precession) return z;
  z.drives = 1;
  z.drive[0] = drive(8e3, 1.9e4);
  if (kind == ZoneKind::profiled) z.drive[0].envelope.shape = Shape::half_sine;
  if (kind != ZoneKind::general) return z;
  z.drives = 2;
  z.drive[1] = drive(3e3, -7e3);
  z.drive[1].oscillator = 4;  // of random phase
  z.drive[1].envelope.shape = Shape::gaussian;
  z.drive[1].first[0] = 0;
  z.drive[1].first[2] = 1;
  z.drive[1].in_xy = false;
  return z;
}
SpinZone turned(SpinZone z) {
  z.turned = true;
  const double frame[9] = {0, 0, 1, 1, 0, 0, 0, 1, 0};
  std::copy_n(frame, 9, z.frame);
  return z;
}
SpinZone twisted(SpinZone z) {
  z.drive[0].twist = 20;
  return z;
}
namespace {

/// Swept, in pulses, and different across the beam.
SpinZone shaped(SpinZone z) {
  DriveTerm& d = z.drive[0];
  d.sweep = {3e7, 0.15e-3, 0.25e-3};
  d.gate = {0.11e-3, 0.14e-3, 0.05e-3, 4};
  d.slopes = {200, -100, 30, 50, 1e-4, -2e-4};
  d.envelope.shape = Shape::standing_wave;
  d.envelope.half_waves = 3;
  d.envelope.is_cosine = true;
  return z;
}
SpinZone periodic() {
  SpinZone z = zone(ZoneKind::rotating);
  z.kind = ZoneKind::periodic;
  z.floquet.harmonics = 1;
  z.floquet.omega = z.drive[0].omega;
  z.floquet.rate = 3e3;
  z.floquet.axis[0] = 0.6;
  z.floquet.axis[2] = 0.8;
  z.floquet.cosine[1][0] = 1;
  z.floquet.sine[1][2] = 0.6;
  z.floquet.sine[1][3] = 0.8;
  return z;
}

}  // namespace

std::vector<NamedZones> all_zones() {
  return {{"precession", {zone(ZoneKind::precession)}},
          {"rotating", {zone(ZoneKind::rotating)}},
          {"rotating, turned", {turned(zone(ZoneKind::rotating))}},
          {"rotating, twisted", {twisted(zone(ZoneKind::rotating))}},
          {"profiled", {zone(ZoneKind::profiled)}},
          {"general", {zone(ZoneKind::general)}},
          {"profiled, shaped", {shaped(zone(ZoneKind::profiled))}},
          {"general, shaped", {shaped(zone(ZoneKind::general))}},
          {"periodic", {periodic()}},
          {"two", {zone(ZoneKind::rotating), zone(ZoneKind::precession)}}};
}

}  // namespace rabiline::test::sample
