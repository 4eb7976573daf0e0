#pragma once
// Rabi's and Ramsey's apparatus for a point spin, small enough to be flown at each scan point alone.
#include <numbers>

#include "physics/suggested.hpp"

namespace rabiline::test {

inline Species point_of_spin(int twice) { return {"point", 3e-26, 0, {twice}, 5.86e10, ""}; }

inline TallyAxis levels_of(Quantity quantity) { return {quantity, {}, {}, {}, {}}; }

/// A magnet, a field that turns or two of them on one oscillator, a second magnet, a screen.
struct Apparatus {
  static constexpr Rectangle gap{6e-3, 0.5e-3};
  Species species = point_of_spin(1);
  Bins bins{1, 1};
  double efficiency = 1;
  bool ramsey = false, aimed = false;
  bool tallied = false;  // by two planes behind the second magnet, and the screen
  DriveProfile profile{};
  double twist = 0, resonant_field = 1e-3;  // [rad], [T]
  std::uint64_t particles = 30000;

  Beamline at(double frequency) const {
    Beamline b = suggested(1e6);
    b.law = QuantumLaw{Outcomes::split};
    b.species = {{species, 1}};
    b.source = {GaussianSpeed{800, 60}, Rectangle{0.2e-3, 0.1e-3}, BoxDirection{1e-4, 1e-4}};
    if (aimed) b.source.direction = AimedDirection{"screen", CosineEmission{}};
    b.chamber.reset();
    RotatingField drive;
    drive.length = ramsey ? 0.02 : 0.05;
    drive.amplitude = 1e-6;
    drive.frequency = frequency;
    drive.sense = Sense::co;
    drive.profile = profile;
    drive.twist = twist;
    Detector detector{Rectangle{4e-3, 0.6e-3}, bins, {}};
    detector.efficiency = efficiency;
    if (efficiency < 1) detector.dead = DeadArea{Rectangle{4e-3, 0.02e-3}, {}};
    Monitor monitor{Rectangle{4e-3, 0.4e-3}, {}};
    if (tallied) {
      monitor.length = 0.05;
      monitor.planes = 2;
      monitor.tallies = {
          {"places",
           {axis(Quantity::z, -0.15e-3, 0.2e-3, 5), axis(Quantity::time_of_flight, 0.7e-3, 1e-3, 2)}},
          {"levels", {levels_of(Quantity::prepared_level), levels_of(Quantity::level)}}};
      detector.tallies = {{"speeds", {levels_of(Quantity::level), axis(Quantity::speed, 700, 900, 4)}}};
    }
    b.parts = {place("A", 0.1, magnet(0.1, 8, gap)), place("C", 0.25, UniformField{0.2, resonant_field, {}}),
               place("drive", 0.27, drive)};
    if (ramsey) b.parts.push_back(place("second", 0.39, drive));
    b.parts.push_back(place("B", 0.5, magnet(0.1, 20, gap)));
    if (tallied) b.parts.push_back(place("look", 0.65, monitor));
    b.parts.push_back(place("screen", 0.8, detector));
    b.particles = particles;
    return b;
  }
  double resonance() const { return 5.86e10 * resonant_field / (2 * std::numbers::pi); }
  std::vector<Beamline> scan(int points) const {
    std::vector<Beamline> out;
    for (int i = 0; i < points; ++i) out.push_back(at(resonance() * (1 + 2e-3 * (i - points / 2) / points)));
    return out;
  }
};

}  // namespace rabiline::test
