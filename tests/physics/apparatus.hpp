#pragma once
// Two deflecting magnets A and B with fields between them, for tests.
#include "constants.hpp"
#include "physics/atoms.hpp"

namespace rabiline::test {

inline constexpr double field = 10e-3;
inline const double larmor = std::abs(gamma_n) * field / two_pi;

inline Species moment_of(double mass, int twice_spin, double moment) {
  return {"test", mass * atomic_mass, 0, {twice_spin}, moment / (hbar * twice_spin / 2.0), ""};
}

/// A 0.1 to 0.5 m, fields 0.5 to 0.8 m, B 0.8 to 1.2 m; gradients of A and B [T/m].
struct Apparatus {
  Species species = neutron();
  SpeedLaw speed = SingleSpeed{1000};
  StartSpin spin = PolarisedSpin{{0, 0, 1}, 1};
  double a = 100, b = -100;
  std::vector<PlacedPart> between{};
  double screen = 1.2;  // [m]
  Detector detector{Rectangle{1, 2e-5}, {1, 1}, {}};
  std::uint64_t particles = 8;
  Outcomes outcomes = Outcomes::split;
};
inline Beamline beamline_of(const Apparatus& s) {
  Beamline b = suggested(0);
  b.law = QuantumLaw{s.outcomes};
  b.species = {{s.species, 1}};
  b.source.speed = s.speed;
  b.source.opening = Disc{0};
  b.source.spin = s.spin;
  b.chamber.reset();
  b.particles = s.particles;
  b.parts = {place("A", 0.1, gradient_magnet(0.4, 1, s.a))};
  b.parts.insert(b.parts.end(), s.between.begin(), s.between.end());
  b.parts.push_back(place("B", 0.8, gradient_magnet(0.4, 1, s.b)));
  b.parts.push_back(place("screen", s.screen, s.detector));
  return b;
}

/// Where m/I = `first` in A and `second` in B comes to at 1.2 m, of one speed: dB_z/dz of the moment along z.
inline double height(const Apparatus& s, double first, double second) {
  const double v = std::get<SingleSpeed>(s.speed).value.value, t = 0.4 / v, gap = 0.3 / v;
  const double per_gradient = s.species.gyromagnetic_ratio * hbar * s.species.spin.value() / s.species.mass;
  const double a = per_gradient * s.a * first, b = per_gradient * s.b * second;
  return a * t * t / 2 + a * t * (gap + t) + b * t * t / 2;
}

}  // namespace rabiline::test
