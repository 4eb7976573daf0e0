// Scans of what filters let pass, from moments of the slowness, against the same points flown alone.
#include <numbers>
#include <random>

#include "apparatus.hpp"
#include "as_alone.hpp"

namespace rabiline::test::filter_moments_test {
namespace {

/// Draws the same numbers everywhere, which distributions of the library need not.
class Dice {
 public:
  explicit Dice(unsigned seed) : numbers_(seed) {}
  double between(double low, double high) {
    return low + (high - low) * static_cast<double>(numbers_()) * 0x1p-32;
  }
  bool is(double probability) { return between(0, 1) < probability; }
  int upto(int most) { return static_cast<int>(between(0, most + 1)); }
  UnitVector direction() {
    const double z = between(-1, 1), turn = between(0, 2 * std::numbers::pi), across = std::sqrt(1 - z * z);
    return {across * std::cos(turn), across * std::sin(turn), z};
  }

 private:
  std::mt19937 numbers_;
};

/// Filters between which one clock turns spins about z, or fields of any direction stand still; apertures
/// between them, and often magnets that separate what has passed.
struct FilteredBeam {
  explicit FilteredBeam(unsigned seed) : dice(seed), rotating(dice.is(0.6)), magnets(dice.is(0.4)) {
    beam = suggested(1e6);
    beam.law = QuantumLaw{Outcomes::split};
    beam.chamber.reset();
    beam.source = {GaussianSpeed{1000, 80}, Rectangle{2e-3, 1e-3}, BoxDirection{5e-4, 5e-4}};
    if (dice.is(0.3)) beam.source.direction = AimedDirection{"screen", CosineEmission{}};
    if (dice.is(0.7)) beam.source.spin = PolarisedSpin{direction(), dice.is(0.5) ? 0.3 : 1};
    beam.particles = 2000;
    beam.parts = {place("guide", 0.05, UniformField{1.9, field, {}})};
    const int filters = 1 + dice.upto(3);
    for (int k = 0; k < filters; ++k) add_turn_and_filter(k);
    if (magnets) {
      if (dice.is(0.5)) add_drive();
      beam.parts.push_back(place("B", 2, magnet(0.1, dice.between(300, 1000), Rectangle{6e-3, 2e-3})));
    }
    if (dice.is(0.3)) add_monitor();
    Detector detector{Rectangle{3e-3, 2e-3}, {1 + dice.upto(2), 3}, {}};
    if (dice.is(0.3))
      detector.tallies = {{"levels", {levels_of(Quantity::level), levels_of(Quantity::prepared_level)}}};
    if (dice.is(0.5)) detector.efficiency = 0.7;
    beam.parts.push_back(place("screen", 3, detector));
  }

  bool is_looked_at() const {
    return std::any_of(beam.parts.begin(), beam.parts.end(),
                       [](const PlacedPart& part) { return std::holds_alternative<Monitor>(part.part); });
  }

  /// A point of a scan over everything that does to spins what moments can tell.
  Beamline at(Dice& own) const {
    Beamline b = beam;
    const double detuning = 1 + own.between(-2e-2, 2e-2), strength = own.between(0.3, 2);
    for (PlacedPart& part : b.parts) {
      if (auto* drive = std::get_if<RotatingField>(&part.part)) {
        if (drive->frequency) *drive->frequency *= detuning;
        drive->amplitude *= strength;
      } else if (auto* coil = std::get_if<UniformField>(&part.part)) {
        if (part.placement.name != "guide") coil->field *= strength;
      } else if (auto* filter = std::get_if<SpinFilter>(&part.part)) {
        filter->up *= own.between(0.8, 1);
        if (!rotating) filter->axis = own.direction();
      }
    }
    return b;
  }

  Dice dice;
  const bool rotating, magnets;
  Beamline beam;

 private:
  static constexpr double field = 1e-3, resonance = 29164.7;  // [T], [Hz] of the neutron

  UnitVector direction() {
    if (!rotating) return dice.direction();
    return {0, 0, dice.is(0.5) ? 1.0 : -1.0};
  }
  void add_drive() {
    if (!rotating) {
      UniformField coil{0.05, dice.between(0.1e-3, 1e-3), {}};
      const UnitVector along = dice.direction();
      coil.direction = {along.x, along.y, along.z};
      beam.parts.push_back(place("coil" + std::to_string(number++), here, coil));
    } else {
      RotatingField drive;
      drive.length = 0.1;
      drive.amplitude = dice.between(0.05e-3, 0.3e-3);
      drive.sense = Sense::co;
      drive.phase = {Phase::Kind::random, 0};
      drive.frequency = resonance;
      if (dice.is(0.3)) drive.profile = HalfSineProfile{};
      if (oscillator.empty()) {
        oscillator = "drive" + std::to_string(number);
      } else {
        drive.frequency.reset();
        drive.sense.reset();
        drive.oscillator = oscillator;
        drive.phase = {Phase::Kind::angle, dice.between(0, 6)};
      }
      beam.parts.push_back(place("drive" + std::to_string(number++), here, drive));
    }
    here += 0.15;
  }
  void add_turn_and_filter(int k) {
    if (k > 0 || dice.is(0.3)) add_drive();
    if (dice.is(0.3))
      beam.parts.push_back(
          place("slit" + std::to_string(k), here += 0.01, Slit{Rectangle{4e-3, 1.5e-3}, {}}));
    if (dice.is(0.3)) add_monitor();
    SpinFilter filter;
    filter.axis = direction();
    filter.up = dice.between(0.3, 1);
    filter.down = dice.is(0.4) ? 0 : dice.between(0, 1);
    beam.parts.push_back(place("filter" + std::to_string(k), here += 0.01, filter));
    here += 0.02;
  }
  /// Often with two planes.
  void add_monitor() {
    Monitor monitor{Rectangle{3e-3, 1.5e-3}, {}};
    monitor.planes = 1 + static_cast<std::uint64_t>(dice.upto(1));
    monitor.length = monitor.planes > 1 ? 5e-3 : 0;
    monitor.tallies = {{"prepared", {levels_of(Quantity::prepared_level)}}};
    if (rotating)  // else there are too many cells for means
      monitor.tallies.push_back(
          {"times", {axis(Quantity::time_of_flight, 0, 4e-3, 2), axis(Quantity::x, -1e-3, 1e-3, 2)}});
    beam.parts.push_back(place("look" + std::to_string(number++), here += 0.01, monitor));
    here += 0.01;
  }
  double here = 0.1;
  int number = 0;
  std::string oscillator;
};

TEST(FilterMoments, GiveEachPointOfRandomBeamsAsIfItWereFlownAlone) {
  int rotating = 0, standing = 0, with_magnets = 0, looked_at = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(seed);
    FilteredBeam drawn(seed);
    std::vector<Beamline> scan;
    for (int i = 0; i < 4; ++i) scan.push_back(drawn.at(drawn.dice));
    expect_as_alone(scan, {true});
    if (HasFailure()) break;
    ++(drawn.rotating ? rotating : standing);
    with_magnets += drawn.magnets ? 1 : 0;
    looked_at += drawn.is_looked_at() ? 1 : 0;
  }
  EXPECT_GT(rotating, 15);
  EXPECT_GT(standing, 15);
  EXPECT_GT(with_magnets, 15);
  EXPECT_GT(looked_at, 15);
}

/// A polariser, a flipper and an analyser, as neutrons fly.
std::vector<Beamline> flipper(int points) {
  std::vector<Beamline> scan;
  for (int i = 0; i < points; ++i) {
    Beamline b = suggested(29164.7 * (1 + 0.02 * (i - points / 2)), 0.1e-3);
    b.law = QuantumLaw{Outcomes::split};
    b.source.speed = GaussianSpeed{1000, 60};
    b.parts.erase(b.parts.begin());
    b.parts.insert(b.parts.begin(), place("polariser", 0.1, SpinFilter{UnitVector{0, 0, 1}, 0.98, 0.02, {}}));
    std::get<UniformField>(b.parts[1].part).field = 1e-3;
    std::get<Detector>(b.parts.back().part).bins = {3, 4};
    b.parts.insert(b.parts.end() - 1,
                   place("analyser", 0.8, SpinFilter{UnitVector{0, 0, 1}, 0.98, 0.02, {}}));
    scan.push_back(b);
  }
  return scan;
}

TEST(FilterMoments, ServeAScanOfAFlipperAndOneOfAnAxis) {
  expect_as_alone(flipper(9));
  std::vector<Beamline> turned = flipper(5);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    std::erase_if(turned[i].parts, [](const PlacedPart& part) { return part.placement.name == "H0"; });
    std::get<UniformField>(turned[i].parts[1].part).field = 1e-6 * static_cast<double>(i);
    std::get<SpinFilter>(turned[i].parts[0].part).axis = {1, 0, 0};
    const double turn = 0.3 * static_cast<double>(i);
    std::get<SpinFilter>(turned[i].parts[2].part).axis = {std::cos(turn), 0, std::sin(turn)};
  }
  expect_as_alone(turned);
}

/// Behind an axis across z the phase of a clock matters, which differs from particle to particle.
TEST(FilterMoments, AreNotKeptWhereWhatPassesDependsOnMoreThanTheSlowness) {
  ASSERT_TRUE(has_moments(flipper(9)));
  const auto refuses = [](auto change) {
    std::vector<Beamline> scan = flipper(9);
    for (Beamline& b : scan) change(b);
    return !has_moments(scan);
  };
  const auto part = [](Beamline& b, const std::string& name) -> Part& {
    return std::find_if(b.parts.begin(), b.parts.end(),
                        [&](const PlacedPart& p) { return p.placement.name == name; })
        ->part;
  };
  EXPECT_TRUE(refuses([&](Beamline& b) { std::get<SpinFilter>(part(b, "analyser")).axis = {1, 0, 0}; }));
  EXPECT_TRUE(refuses([&](Beamline& b) { std::get<SpinFilter>(part(b, "polariser")).axis = {1, 0, 0}; }));
  EXPECT_TRUE(refuses([&](Beamline& b) { b.source.spin = PolarisedSpin{{1, 0, 0}, 1}; }));
  EXPECT_TRUE(refuses([&](Beamline& b) { b.law = ClassicalLaw{}; }));
  const auto tallied = [](double at, TallyAxis axis) {
    return [=](Beamline& b) {
      const auto behind = std::find_if(b.parts.begin(), b.parts.end(),
                                       [&](const PlacedPart& other) { return other.placement.at > at; });
      Monitor monitor{Rectangle{6e-3, 0.4e-3}, {}};
      monitor.tallies = {{"of", {axis}}};
      b.parts.insert(behind, place("look", at, monitor));
    };
  };
  EXPECT_TRUE(refuses(tallied(0.2, axis(Quantity::weight, 0, 1, 2))));
  EXPECT_TRUE(refuses(tallied(0.2, levels_of(Quantity::level))));
  EXPECT_FALSE(refuses(tallied(0.2, levels_of(Quantity::prepared_level))));
  EXPECT_FALSE(refuses(tallied(0.9, levels_of(Quantity::level))));
}

/// A polariser that passes (1 + 0.96)/2 and (1 - 0.96)/2, whatever turns spins and filters them behind.
TEST(FilterMoments, KnowTheLevelsOfWhatAScreenCaughtBeforeFieldsAndAFilter) {
  std::vector<Beamline> scan = flipper(5);
  for (Beamline& b : scan)
    b.parts.insert(b.parts.begin() + 1, place("mid", 0.2, Detector{Rectangle{2e-3, 0.4e-3}, {1, 1}, {}}));
  const DetectorResult screen = run_points(scan).detectors[0];
  EXPECT_GT(screen.detected[0], 0.05);
  for (std::size_t i = 0; i < scan.size(); ++i) EXPECT_NEAR(screen.levels[2 * i], 0.98, 1e-3);
}

TEST(FilterMoments, GiveTheSameBitsForAnyThreadsBatchesAndInstructionSets) { expect_same_bits(flipper(9)); }

/// Against groups of particles, as points are flown where the weight behind a filter is asked for.
TEST(FilterMoments, TellHowPointsVaryTogether) {
  std::vector<Beamline> scan = flipper(7);
  for (Beamline& b : scan) {
    b.particles = 40000;
    b.parts.insert(b.parts.begin() + 1, place("look", 0.2, Monitor{Rectangle{6e-3, 3e-3}, {}}));
    b.parts.insert(b.parts.end() - 2, place("before", 0.75, Monitor{Rectangle{6e-3, 3e-3}, {}}));
  }
  ASSERT_TRUE(has_moments(scan));
  const Result exact = run_points(scan);
  for (Beamline& b : scan)
    std::get<Monitor>(b.parts[1].part).tallies = {{"weights", {axis(Quantity::weight, 0, 1, 2)}}};
  ASSERT_FALSE(has_moments(scan));
  const Result groups = run_points(scan);
  const DetectorResult& screen = exact.detectors[0];
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_NEAR(screen.detected_covariance[i * 8], screen.detected_errors[i] * screen.detected_errors[i],
                1e-6 * screen.detected_covariance[i * 8]);
  expect_as_groups_scatter(screen.detected_covariance, groups.detectors[0].detected_covariance);
  for (const std::size_t monitor : {0U, 1U})
    expect_as_groups_scatter(exact.monitors[monitor].passed_covariance,
                             groups.monitors[monitor].passed_covariance);
}

}  // namespace
}  // namespace rabiline::test::filter_moments_test
