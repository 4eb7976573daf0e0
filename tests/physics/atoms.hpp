#pragma once
// Beamlines of atoms that fly in levels, for tests.
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "particle/species.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test {

inline constexpr double two_pi = 2 * std::numbers::pi, hbar = 1.054571817e-34, planck = 6.62607015e-34,
                        magneton = 9.2740100657e-24, boltzmann = 1.380649e-23;

inline StartSpin in_level(int f, int m) { return LevelsSpin{{{false, 2 * f, 2 * m}}}; }

/// Parallel atoms of one speed from a point on the axis, one level.
inline Beamline atoms(const std::string& species, double speed, StartSpin spin) {
  Beamline b = suggested(0);
  b.law = QuantumLaw{};
  b.species = {{*find_species(species), 1}};
  b.source.speed = SingleSpeed{speed};
  b.source.opening = Disc{0};
  b.source.spin = std::move(spin);
  b.chamber.reset();
  b.parts.clear();
  b.particles = 8;
  return b;
}

inline RotatingField turning(double length, double amplitude, double frequency, Sense sense) {
  RotatingField rf;
  rf.length = length;
  rf.amplitude = amplitude;
  rf.frequency = frequency;
  rf.sense = sense;
  rf.phase = {Phase::Kind::random, 0};
  return rf;
}
inline OscillatingField swinging(double length, double amplitude, std::optional<double> frequency) {
  OscillatingField rf;
  rf.length = length;
  rf.amplitude = amplitude;
  rf.frequency = frequency;
  return rf;
}
inline GradientMagnet gradient_magnet(double length, double field, double gradient) {
  GradientMagnet part;
  part.length = length;
  part.field = field;
  part.gradient = gradient;
  return part;
}
inline PlacedPart wide_screen(double y) { return place("screen", y, Detector{Rectangle{1, 1}, {1, 1}, {}}); }
/// The detected part in each level at the first detector.
inline std::vector<double> levels_of(const Beamline& b) { return run_points({b}).detectors.at(0).levels; }

/// Rabi's flip probability.
inline double rabi(double w1, double detuning, double time) {
  const double rate = std::hypot(w1, detuning);
  return rate > 0 ? std::pow(w1 / rate * std::sin(rate * time / 2), 2) : 0;
}

}  // namespace rabiline::test
