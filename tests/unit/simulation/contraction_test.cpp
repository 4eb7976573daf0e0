// Scan points from moments of the slowness, against the same points flown alone.
#include <gtest/gtest.h>

#include "apparatus.hpp"
#include "as_alone.hpp"

namespace rabiline::test::contraction_test {
namespace {

using test::expect_as_alone;
void expect_as_alone(const Apparatus& apparatus, int points) { expect_as_alone(apparatus.scan(points)); }

TEST(Moments, GiveEachPointOfAScanAsIfItWereFlownAlone) { expect_as_alone({}, 9); }
TEST(Moments, GiveEveryBinOfAScreenThatCountsTwoThirds) {
  Apparatus apparatus;
  apparatus.bins = {3, 4};
  apparatus.efficiency = 2.0 / 3;
  expect_as_alone(apparatus, 7);
}
TEST(Moments, GiveEveryBinAndMeanThatMonitorsAndTalliesSee) {
  for (const int twice : {1, 3})
    for (const bool aimed : {false, true}) {
      Apparatus apparatus;
      apparatus.species = point_of_spin(twice);
      apparatus.tallied = true;
      apparatus.aimed = aimed;
      apparatus.efficiency = 2.0 / 3;
      apparatus.particles = 10000;
      expect_as_alone(apparatus.scan(5), {true});
    }
}
TEST(Moments, OfASpinThreeHalvesFollowMajorana) {
  Apparatus apparatus;
  apparatus.species = point_of_spin(3);
  expect_as_alone(apparatus, 7);
}
TEST(Moments, OfTwoFieldsOnOneOscillatorGiveRamseysFringes) {
  Apparatus apparatus;
  apparatus.ramsey = true;
  apparatus.particles = 100000;
  expect_as_alone(apparatus, 9);
}
TEST(Moments, OfFieldsWhoseSizeOrDirectionRunsAlongTheBeam) {
  for (const bool twisted : {false, true})
    for (const bool ramsey : {false, true}) {
      Apparatus apparatus;
      apparatus.ramsey = ramsey;
      apparatus.particles = 10000;
      if (twisted)
        apparatus.twist = 2;
      else
        apparatus.profile = HalfSineProfile{};
      expect_as_alone(apparatus.scan(7));
    }
}
TEST(Moments, OfACoilThatTiltsSpins) {
  Apparatus apparatus;
  apparatus.particles = 10000;
  std::vector<Beamline> scan = apparatus.scan(7);
  for (std::size_t i = 0; i < scan.size(); ++i) {
    std::erase_if(scan[i].parts, [](const PlacedPart& part) { return part.placement.name == "drive"; });
    UniformField coil{0.02, 0.1e-6 * static_cast<double>(i + 1), {}};
    coil.direction = {1, 0, 0};
    std::get<UniformField>(scan[i].parts[1].part).field = 0.5e-6;
    scan[i].parts.insert(scan[i].parts.begin() + 2, place("coil", 0.3, coil));
  }
  expect_as_alone(scan);
}
/// A spin across z arrives at a clock with a phase that is its slowness times omega y.
TEST(Moments, OfSpinsThatStartAcrossZ) {
  for (const int twice : {1, 3})
    for (const bool levels_at_screen : {false, true}) {
      Apparatus apparatus;
      apparatus.species = point_of_spin(twice);
      apparatus.particles = 10000;
      apparatus.resonant_field = 1e-5;
      std::vector<Beamline> scan = apparatus.scan(7);
      for (Beamline& b : scan) {
        b.source.spin = PolarisedSpin{{0.6, 0.64, 0.48}, 0.7};
        std::erase_if(b.parts, [&](const PlacedPart& part) {
          return part.placement.name == "A" || (levels_at_screen && part.placement.name == "B");
        });
        for (PlacedPart& part : b.parts)
          if (auto* drive = std::get_if<RotatingField>(&part.part)) drive->phase = {Phase::Kind::locked, 0};
      }
      expect_as_alone(scan, {true});
      for (Beamline& b : scan) b.source.pulse = RectanglePulse{1e-4};
      EXPECT_FALSE(has_moments(plan_of(scan, {true}).trees.front().next));
    }
}
/// The second one turns against the first, the third oscillates.
TEST(Moments, OfFieldsWithClocksOfTheirOwn) {
  Apparatus apparatus;
  apparatus.particles = 10000;
  apparatus.resonant_field = 1e-5;
  std::vector<Beamline> scan = apparatus.scan(7);
  for (Beamline& b : scan) {
    const auto first = std::find_if(b.parts.begin(), b.parts.end(), [](const PlacedPart& part) {
      return std::holds_alternative<RotatingField>(part.part);
    });
    auto& drive = std::get<RotatingField>(first->part);
    drive.phase = {Phase::Kind::angle, 1};
    RotatingField other = drive;
    *other.frequency *= 0.9;
    other.sense = Sense::counter;
    other.length = 0.02;
    OscillatingField whole;
    whole.length = 0.06;
    whole.amplitude = 3 * drive.amplitude;
    whole.direction = {0.6, 0, 0.8};
    whole.frequency = 1.1 * *drive.frequency;
    whole.phase = {Phase::Kind::locked, 0};
    const double behind = first->placement.at + drive.length;
    b.parts.insert(first + 1, {place("other", behind, other), place("whole", behind + 0.02, whole)});
  }
  expect_as_alone(scan, {true});
  for (Beamline& b : scan)
    for (PlacedPart& part : b.parts)
      if (auto* drive = std::get_if<RotatingField>(&part.part)) drive->phase = {Phase::Kind::random, 0};
  EXPECT_FALSE(has_moments(plan_of(scan, {true}).trees.front().next));
}
TEST(Moments, OfParticlesThatWeighDifferently) {
  Apparatus apparatus;
  apparatus.aimed = true;
  expect_as_alone(apparatus, 7);
}

/// Without a magnet nothing depends on the level, and a detector counts levels behind the fields.
TEST(Moments, OfWhatADetectorCaughtGiveItsLevels) {
  for (const int twice : {1, 2, 3}) {
    Apparatus apparatus;
    apparatus.species = point_of_spin(twice);
    apparatus.efficiency = 0.9;
    std::vector<Beamline> scan = apparatus.scan(8);
    for (Beamline& b : scan)
      std::erase_if(b.parts, [](const PlacedPart& part) {
        return part.placement.name.size() == 1 && part.placement.name != "C";
      });
    for (Beamline& b : scan) {
      PopulatedSpin populated;
      populated.values.assign(static_cast<std::size_t>(twice) + 1, 0.1);
      populated.values[0] = 1 - 0.1 * twice;
      b.source.spin = populated;
    }
    ASSERT_TRUE(has_moments(scan));
    const DetectorResult all = run_points(scan).detectors[0];
    for (std::size_t i = 0; i < scan.size(); ++i) {
      const DetectorResult alone = run_points({scan[i]}).detectors[0];
      EXPECT_EQ(all.detected[i], alone.detected[0]);
      for (std::size_t level = 0; level < alone.levels.size(); ++level) {
        EXPECT_NEAR(all.levels[i * alone.levels.size() + level], alone.levels[level], 1e-9);
        EXPECT_NEAR(all.levels_errors[i * alone.levels.size() + level], alone.levels_errors[level], 1e-8);
      }
    }
    EXPECT_GT(std::abs(all.levels[4 * all.levels.size() / 8] - all.levels[0]), 0.05);
  }
}

TEST(Moments, ServeSpinsThatAPolariserPrepared) {
  std::vector<Beamline> scan;
  for (int i = 0; i < 9; ++i) {
    Beamline b = suggested(291.6e3 + 1e3 * (i - 4), 80e-6);
    b.law = QuantumLaw{Outcomes::split};
    b.particles = 20000;
    scan.push_back(b);
  }
  ASSERT_TRUE(has_moments(scan));
  const DetectorResult all = run_points(scan).detectors[0];
  for (std::size_t i = 0; i < scan.size(); ++i) {
    const DetectorResult alone = run_points({scan[i]}).detectors[0];
    EXPECT_NEAR(all.levels[2 * i], alone.levels[0], 1e-9);
    EXPECT_NEAR(all.levels_errors[2 * i], alone.levels_errors[0], 1e-8);
  }
}

/// With one point more, whose particles fly otherwise.
std::vector<Beamline> flown_apart(std::vector<Beamline> scan) {
  scan.push_back(scan.back());
  std::get<GradientMagnet>(scan.back().parts.front().part).gradient *= 1.01;
  return scan;
}

/// Parts of a scan would each fly all of it, as far as a tree is cut by what one particle costs.
TEST(Moments, AreOfOneFlightHoweverMuchAParticleCosts) {
  Experiment e;
  e.points = Apparatus{}.scan(9);
  EXPECT_EQ(make_plan(e, 1, 1e-9).trees.size(), 1U);
  e.points = flown_apart(Apparatus{}.scan(8));
  EXPECT_EQ(make_plan(e, 1, 1e-9).trees.size(), 9U);
}

TEST(Moments, GiveTheSameBitsForAnyThreadsBatchesAndInstructionSets) {
  Apparatus apparatus;
  apparatus.bins = {3, 4};
  apparatus.tallied = true;
  expect_same_bits(apparatus.scan(7));
}

/// Those that keep their level are what is detected where no field turns spins.
TEST(Moments, TellTheSlownessOfWhatADetectorCatches) {
  for (const int twice : {1, 3}) {
    Apparatus apparatus;
    apparatus.species = point_of_spin(twice);
    apparatus.bins = {3, 4};
    const DetectorResult screen = run_points(apparatus.scan(9)).detectors[0];
    ASSERT_EQ(screen.transits.size(), 1U);
    const TransitResult& transit = screen.transits[0];
    const std::size_t cells = transit.edges.size() - 1;
    double kept = 0, squares = 0, slowness = 0;
    for (std::size_t path = 0; path < transit.paths.size(); ++path) {
      const std::string& name = transit.paths[path];
      const std::size_t to = name.find(" to ");
      if (name.substr(0, to) != name.substr(to + 4)) continue;
      for (std::size_t cell = 0; cell < cells; ++cell) {
        const double caught = transit.caught[path * cells + cell],
                     error = transit.errors[path * cells + cell];
        kept += caught;
        squares += error * error;
        slowness += caught * (transit.edges[cell] + transit.edges[cell + 1]) / 2;
      }
    }
    Beamline still = apparatus.at(apparatus.resonance());
    std::erase_if(still.parts, [](const PlacedPart& part) { return part.placement.name == "drive"; });
    const double detected = run_points({still}).detectors[0].detected[0] * 30000;
    EXPECT_NEAR(kept, detected, 1e-6 * detected);
    EXPECT_NEAR(squares, detected, 1e-6 * detected);  // all weigh 1
    EXPECT_NEAR(slowness / kept, 1 / 800.0, 0.008 / 800);
  }
}

/// What gas takes of each particle's weight in front of the magnets leaves the counts of emitted particles
/// that weigh 1.
TEST(Moments, KnowTheErrorsOfABeamThatGasThins) {
  const Apparatus apparatus;
  std::vector<Beamline> scan = apparatus.scan(7);
  GasCell gas;
  gas.length = 0.02;
  gas.gas = GasDensity{1e20};
  gas.cross_section = 1e-18;  // transmits exp(-2)
  for (Beamline& b : scan) b.parts.insert(b.parts.begin(), place("gas", 0.05, gas));
  ASSERT_TRUE(has_moments(scan));
  const DetectorResult screen = run_points(scan).detectors[0];
  for (std::size_t i = 0; i < scan.size(); ++i)
    EXPECT_NEAR(screen.detected_covariance[i * 8], screen.detected_errors[i] * screen.detected_errors[i],
                1e-6 * screen.detected_covariance[i * 8]);
  const Beamline alone = [&] {
    Beamline b = scan[3];
    b.particles = 200000;
    return b;
  }();
  const DetectorResult one = run_points({alone}).detectors[0];
  EXPECT_NEAR(screen.detected_errors[3], one.detected_errors[0] * std::sqrt(200000.0 / 30000),
              0.02 * screen.detected_errors[3]);
  for (Beamline& b : scan) b.source.direction = AimedDirection{"screen", CosineEmission{}};
  EXPECT_FALSE(has_moments(scan));
}

/// Two points that drive nothing but another power of their Larmor angle see the same particles: what both
/// count varies as each alone.
TEST(Moments, TellHowPointsVaryTogether) {
  for (const bool aimed : {false, true}) {
    Apparatus apparatus;
    apparatus.aimed = aimed;
    apparatus.tallied = true;
    std::vector<Beamline> scan = apparatus.scan(6);
    scan.push_back(apparatus.at(apparatus.resonance() * (1 + 1e-12)));
    ASSERT_TRUE(has_moments(scan));
    const Result all = run_points(scan);
    const DetectorResult& screen = all.detectors[0];
    const auto covariance = [&](std::size_t a, std::size_t b) {
      return screen.detected_covariance[a * 7 + b];
    };
    for (std::size_t i = 0; i < 7; ++i) {
      EXPECT_NEAR(covariance(i, i), screen.detected_errors[i] * screen.detected_errors[i],
                  1e-6 * covariance(i, i));
      for (std::size_t j = 0; j < 7; ++j)
        EXPECT_NEAR(covariance(i, j), covariance(j, i), 1e-9 * covariance(i, i));
    }
    EXPECT_NEAR(covariance(3, 6), covariance(3, 3), 1e-6 * covariance(3, 3));

    // Against groups of particles, as points are flown beside one of another flight.
    scan = flown_apart(scan);
    ASSERT_FALSE(has_moments(scan));
    const Result groups = run_points(scan);
    expect_as_groups_scatter(screen.detected_covariance, groups.detectors[0].detected_covariance);
    const MonitorResult& monitor = all.monitors[0];
    for (std::size_t i = 0; i < 14; ++i) {
      const double variance = monitor.passed_covariance[i % 2 * 49 + i / 2 * 8];
      EXPECT_NEAR(variance, monitor.passed_errors[i] * monitor.passed_errors[i], 1e-6 * variance);
    }
    for (const std::size_t plane : {0U, 1U})
      expect_as_groups_scatter(std::span(all.monitors[0].passed_covariance).subspan(plane * 7 * 7, 7 * 7),
                               std::span(groups.monitors[0].passed_covariance).subspan(plane * 8 * 8, 8 * 8));
  }
}

}  // namespace
}  // namespace rabiline::test::contraction_test
