#include "plan/level_lines.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "spin/level_labels.hpp"

namespace rabiline::level_lines_test {
namespace {

/// Two photons by way of one level that is off by d: the Rabi frequencies' product over 2 d (W. Demtroeder,
/// Laser Spectroscopy 2, 5th ed. (Springer, 2015), sect. 2.5).
TEST(TransitionsOfTwoPhotons, AreAsStrongAsBothStepsOverWhatTheLevelBetweenIsOff) {
  const Structure structure = *find_species("K-39 atom")->structure;
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(structure));
  const auto level = [&](int m) { return *find_weak_field_level(labels, 4, 2 * m); };
  LevelZone zone{0, 0.1};
  zone.field = 3e-3;
  zone.drive = RotatingTerm{};
  zone.drive->motion = FieldMotion::swings_in_rotating_wave;
  zone.drive->amplitude = 2e-6;
  zone.drive->first = {1, 0, 0};
  const auto between = [&](const std::vector<Transition>& all, int upper, int lower) {
    for (const Transition& t : all)
      if (t.upper == upper && t.lower == lower) return t;
    ADD_FAILURE() << "there is none";
    return Transition{};
  };
  const Transition first = between(transitions_near(structure, zone), level(1), level(0)),
                   second = between(transitions_near(structure, zone), level(2), level(1));
  zone.drive->oscillator.frequency = (first.frequency + second.frequency) / 2;
  const double off = zone.drive->oscillator.frequency - first.frequency;
  const Transition both = between(transitions_of_two_photons(structure, zone, 1e3), level(2), level(0));
  EXPECT_NEAR(both.detuning, 0, 1e-3);
  EXPECT_NEAR(both.rabi, std::abs(first.rabi * second.rabi / (2 * off)), 2e-3 * both.rabi);
  EXPECT_GT(std::abs(off), 10e3 + 10 * first.rabi);
  zone.drive->oscillator.frequency = first.frequency;
  for (const Transition& t : transitions_of_two_photons(structure, zone, 1e3))
    EXPECT_FALSE(t.upper == level(2) && t.lower == level(0)) << "one photon after the other";
}

}  // namespace
}  // namespace rabiline::level_lines_test
