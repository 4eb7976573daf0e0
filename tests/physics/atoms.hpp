#pragma once
// Beamlines of atoms that fly in levels, for tests.
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <vector>

#include "constants.hpp"
#include "particle/species.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test {

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
