#pragma once
// Rabi's and Ramsey's apparatus for a point spin, small enough to be flown at each scan point alone.
#include <numbers>

#include "physics/suggested.hpp"

namespace rabiline::test {

inline Species point_of_spin(int twice) { return {"point", 3e-26, 0, {twice}, 5.86e10, ""}; }

/// A magnet, a field that turns or two of them on one oscillator, a second magnet, a screen.
struct Apparatus {
  static constexpr Rectangle gap{6e-3, 0.5e-3};
  Species species = point_of_spin(1);
  Bins bins{1, 1};
  double efficiency = 1;
  bool ramsey = false, aimed = false;
  DriveProfile profile{};
  double twist = 0;
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
    b.parts = {place("A", 0.1, magnet(0.1, 8, gap)), place("C", 0.25, UniformField{0.2, resonant_field, {}}),
               place("drive", 0.27, drive)};
    if (ramsey) b.parts.push_back(place("second", 0.39, drive));
    b.parts.push_back(place("B", 0.5, magnet(0.1, 20, gap)));
    b.parts.push_back(place("screen", 0.8, detector));
    b.particles = particles;
    return b;
  }
  static constexpr double resonant_field = 1e-3;
  double resonance() const { return 5.86e10 * resonant_field / (2 * std::numbers::pi); }
  std::vector<Beamline> scan(int points) const {
    std::vector<Beamline> out;
    for (int i = 0; i < points; ++i) out.push_back(at(resonance() * (1 + 2e-3 * (i - points / 2) / points)));
    return out;
  }
};

}  // namespace rabiline::test
