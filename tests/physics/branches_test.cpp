// What splitting over levels and drawing them have in common, errors, the ledger by level, and scans.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>

#include "constants.hpp"
#include "physics/agreement.hpp"
#include "physics/apparatus.hpp"
#include "spin/atoms.hpp"

namespace rabiline::test::branches_test {
namespace {

// ---- split and sample ----

/// A, a field that drives atoms, B, and a screen that catches a part of them and counts a part of that.
Apparatus of_atoms(const char* species, double field_between, double amplitude, double frequency,
                   Sense sense) {
  Apparatus s;
  s.species = *find_species(species);
  s.speed = EffusiveSpeed{400};
  s.spin = UnpolarisedSpin{};
  s.a = 3;
  s.b = 2;
  s.between = {place("C", 0.5, UniformField{0.3, field_between, {}}),
               place("R", 0.55, turning(0.2, amplitude, frequency, sense))};
  s.detector = Detector{Rectangle{1, 1.2e-3}, {1, 6}, {}};
  s.detector.offset.z = 0.4e-3;
  s.detector.efficiency = 0.7;
  s.detector.dead = DeadArea{Disc{0.1e-3}, {0, 0.3e-3}};
  return s;
}
std::vector<std::pair<const char*, Apparatus>> several() {
  Apparatus half, three_halves;
  half = of_atoms("H atom", field, 40e-6, larmor + 400, Sense::co);
  half.species = neutron();
  half.a = 300;
  half.b = 200;
  three_halves = half;
  three_halves.species = moment_of(7, 3, 1e-26);
  std::get<RotatingField>(three_halves.between[1].part).frequency =
      three_halves.species.gyromagnetic_ratio * field / two_pi + 300;
  std::get<RotatingField>(three_halves.between[1].part).amplitude = 100e-6;
  three_halves.a = 3000;
  three_halves.b = 2000;
  for (Apparatus* s : {&half, &three_halves}) s->speed = GaussianSpeed{1000, 100};
  return {{"1/2", half},
          {"3/2", three_halves},
          {"Cs", of_atoms("Cs-133 atom", 10e-6, 0.1e-6, 35e3, Sense::positive)},
          {"H", of_atoms("H atom", 10e-6, 0.2e-6, 140e3, Sense::positive)}};
}

TEST(SplitAndSample, AgreeForMomentsAndAtoms) {
  for (auto [name, s] : several()) {
    s.particles = 200000;
    s.outcomes = Outcomes::split;
    const DetectorResult one = run_points({beamline_of(s)}).detectors.at(0);
    s.outcomes = Outcomes::sample;
    Beamline other_beam = beamline_of(s);
    other_beam.seed += 1;
    const DetectorResult other = run_points({other_beam}).detectors.at(0);
    EXPECT_GT(one.detected[0], 0.03) << name;
    EXPECT_LT(one.detected[0], 0.6) << name;
    EXPECT_NEAR(one.detected[0], other.detected[0],
                4.5 * std::hypot(one.detected_errors[0], other.detected_errors[0]))
        << name;
    EXPECT_LT(one.detected_errors[0], 1.02 * other.detected_errors[0]) << name;
    for (std::size_t i = 0; i < one.levels.size(); ++i)
      EXPECT_NEAR(one.levels[i], other.levels[i],
                  4.5 * std::hypot(one.levels_errors[i], other.levels_errors[i]) + 1e-5)
          << name << " level " << i;
    for (std::size_t i = 0; i < one.counts.size(); ++i)
      EXPECT_NEAR(one.counts[i], other.counts[i],
                  4.5 * std::hypot(one.counts_errors[i], other.counts_errors[i]))
          << name << " bin " << i;
  }
}

TEST(Errors, AreTheScatterOfManyRuns) {
  constexpr std::size_t seeds = 400;
  for (auto [name, s] : several())
    for (const Outcomes outcomes : {Outcomes::split, Outcomes::sample}) {
      s.outcomes = outcomes;
      s.particles = 400;
      s.detector.bins = {2, 6};
      std::vector<Beamline> runs(seeds, beamline_of(s));
      for (std::size_t i = 0; i < seeds; ++i) {
        runs[i].seed = 1000 + i;
        runs[i].source.opening = Disc{0.1e-3};
      }
      const DetectorResult d = run_points(runs).detectors.at(0);
      const auto expect_honest = [&](const std::vector<double>& values, const std::vector<double>& errors,
                                     std::size_t at, const std::string& what) {
        const std::size_t stride = values.size() / seeds;
        double sum = 0, squares = 0, variances = 0;
        for (std::size_t i = at; i < values.size(); i += stride) {
          sum += values[i] / seeds;
          squares += values[i] * values[i] / seeds;
          variances += errors[i] * errors[i] / seeds;
        }
        // The variance of 400 runs is known to 7 %.
        EXPECT_NEAR(variances / (squares - sum * sum), 1, 4 * 0.071)
            << name << (outcomes == Outcomes::split ? " split, " : " sample, ") << what << ": " << sum
            << " +- " << std::sqrt(variances);
      };
      expect_honest(d.detected, d.detected_errors, 0, "detected");
      expect_honest(d.counts, d.counts_errors, 4, "bin");
      expect_honest(d.counts_x, d.counts_x_errors, 0, "bin along x");
      expect_honest(d.counts_z, d.counts_z_errors, 4, "bin along z");
      for (std::size_t level = 0; level < d.level_labels.size(); ++level)
        if (d.levels[level] > 0.1) expect_honest(d.levels, d.levels_errors, level, d.level_labels[level]);
    }
}

TEST(Errors, OfWhatIsSplitAndWhollyCaughtKnowItsSharesBelongTogether) {
  // Every particle is caught, in two bins: no error but that of a share of all, and that of the mean flip.
  Apparatus s = several()[0].second;
  s.spin = PolarisedSpin{{0, 0, 1}, 1};
  s.detector = Detector{Rectangle{1, 20e-3}, {1, 2000}, {}};
  s.particles = 20000;
  const DetectorResult d = run_points({beamline_of(s)}).detectors.at(0);
  EXPECT_EQ(d.detected[0], 1);
  EXPECT_NEAR(d.counts_x_errors[0], d.detected_errors[0] * 20000, 1e-6);
  const auto flip = [&](double v) { return rabi(gamma_n * 40e-6, two_pi * 400, 0.2 / v); };
  double mean = 0, square = 0, all = 0;
  for (double u = -5; u < 5; u += 0.01) {
    const double weight = std::exp(-u * u / 2), p = flip(1000 + 100 * u);
    all += weight;
    mean += weight * p;
    square += weight * p * p;
  }
  const double spread = std::sqrt(square / all - mean * mean / all / all);
  EXPECT_GT(mean / all, 0.3);
  EXPECT_NEAR(d.levels[1], mean / all, 4 * spread / std::sqrt(20000));
  EXPECT_NEAR(d.levels_errors[1], spread / std::sqrt(20000), 0.03 * spread / std::sqrt(20000));
}

// ---- the ledger, threads and machines ----

TEST(LedgerByLevel, ClosesWithLossesEverywhere) {
  for (auto [name, s] : several())
    for (const Outcomes outcomes : {Outcomes::split, Outcomes::sample}) {
      s.outcomes = outcomes;
      s.particles = 3000;
      Beamline b = beamline_of(s);
      std::get<GradientMagnet>(b.parts.front().part).gap = Rectangle{1, 0.6e-3};
      b.parts.insert(b.parts.end() - 1, place("slit", 1.2, Slit{Rectangle{1, 2e-3}, {0, 0.2e-3}}));
      b.parts.back().placement.at = 1.3;
      const Result r = run_points({b});
      const std::size_t levels = r.ledger_levels.size();
      ASSERT_EQ(levels, static_cast<std::size_t>(s.species.levels()));
      double all = 0;
      int lossy = 0;
      for (std::size_t level = 0; level < levels; ++level) {
        double ended = 0;
        for (const FateResult& fate : r.fates) {
          ended += fate.by_level[level];
          lossy += level == 0 && fate.particles[0] > 0;
        }
        EXPECT_NEAR(ended, r.emitted_by_level[level], 1e-8) << name << " " << level;
        all += r.emitted_by_level[level];
      }
      EXPECT_NEAR(all, 3000, 1e-7);
      EXPECT_GE(lossy, 3) << name;
    }
}

TEST(AtomsThatAreSplit, GiveTheSameBitsHoweverTheyAreFlown) {
  for (auto [name, s] : several()) {
    s.particles = 3000;
    Experiment e;
    for (const double f : {0.9, 1.0, 1.1}) {
      Beamline b = beamline_of(s);
      *std::get<RotatingField>(b.parts[2].part).frequency *= f;
      e.points.push_back(b);
    }
    const Plan plan = make_plan(e);
    RunOptions options;
    const Sums reference = run(plan, options).sums;
    for (const int threads : {1, 2, 3})
      for (const int batch : {8, 64, 512})
        for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
          if (!supported(isa)) continue;
          options.threads = threads;
          options.batch = batch;
          options.isa = isa;
          EXPECT_TRUE(run(plan, options).sums == reference)
              << name << " " << threads << " threads, batch " << batch << ", " << name_of(isa);
        }
  }
}

// ---- scans ----

void expect_same(const Result& scan, std::size_t point, const Result& single, const char* what) {
  for (std::size_t k = 0; k < scan.detectors.size(); ++k) {
    const DetectorResult &d = scan.detectors[k], &one = single.detectors[k];
    EXPECT_EQ(d.detected[point], one.detected[0]) << what << point;
    EXPECT_EQ(d.detected_errors[point], one.detected_errors[0]) << what << point;
    const std::size_t levels = one.levels.size();
    for (std::size_t i = 0; i < levels; ++i) {
      EXPECT_EQ(d.levels[point * levels + i], one.levels[i]) << what << point;
      EXPECT_EQ(d.levels_errors[point * levels + i], one.levels_errors[i]) << what << point;
    }
    const std::size_t bins = one.counts.size();
    for (std::size_t i = 0; i < bins; ++i)
      EXPECT_EQ(d.counts[point * bins + i], one.counts[i]) << what << point;
  }
}

TEST(Scan, OfAnythingGivesAtEachPointWhatASingleRunGives) {
  const auto part = [](Beamline& b, const char* name) -> Part& {
    return std::find_if(b.parts.begin(), b.parts.end(),
                        [&](const PlacedPart& p) { return p.placement.name == name; })
        ->part;
  };
  using Change = std::function<void(Beamline&, double)>;
  const std::vector<std::pair<const char*, Change>> changes = {
      {"frequency", [&](Beamline& b, double f) { *std::get<RotatingField>(part(b, "R")).frequency *= f; }},
      {"C field", [&](Beamline& b, double f) { std::get<UniformField>(part(b, "C")).field *= f; }},
      {"gradient", [&](Beamline& b, double f) { std::get<GradientMagnet>(part(b, "B")).gradient *= f; }},
      {"temperature",
       [&](Beamline& b, double f) {
         if (auto* law = std::get_if<EffusiveSpeed>(&b.source.speed)) law->temperature *= f;
       }},
      {"current",
       [&](Beamline& b, double f) {
         TwoWireMagnet wires;
         wires.length = 0.4;
         wires.half_distance = 4e-3;
         wires.wire_radius = 1e-3;
         wires.strength = WireCurrent{20 * f};
         part(b, "A") = wires;
       }},
      {"slit", [&](Beamline& b, double f) {
         b.parts.insert(b.parts.end() - 1,
                        place("slit", 1.2, Slit{Rectangle{1, 0.8e-3}, {0, 0.4e-3 * (f - 0.9)}}));
       }}};
  for (auto [name, s] : several())
    for (const auto& [what, change] : changes) {
      s.particles = 500;
      std::vector<Beamline> points;
      for (const double f : {0.9, 1.0, 1.15}) {
        Beamline b = beamline_of(s);
        b.parts.insert(b.parts.begin(),
                       place("early", 0.05, Detector{Rectangle{1, 1e-3}, {1, 1}, {0, 0.501e-3}}));
        b.source.opening = Disc{0.1e-3};
        b.parts.back().placement.at = 1.3;
        change(b, f);
        points.push_back(b);
      }
      const Result scan = run_points(points);
      for (std::size_t p = 0; p < points.size(); ++p)
        expect_same(scan, p, run_points({points[p]}), (std::string(name) + " " + what + " ").c_str());
      EXPECT_GT(scan.detectors[0].detected[0] * 0 + scan.detectors[1].detected[0], 0) << name << what;
    }
}

TEST(Scan, OverSpeciesOfOtherLevelsKeepsTheirLedgersApart) {
  std::vector<Beamline> points;
  for (const auto& [name, s] : several()) {
    Apparatus one = s;
    one.particles = 1000;
    points.push_back(beamline_of(one));
  }
  const Result scan = run_points(points);
  const std::size_t columns = scan.ledger_levels.size();
  EXPECT_EQ(columns, 2U + 2U + 16U + 4U);  // m = +-1/2 are levels of both moments
  for (std::size_t p = 0; p < points.size(); ++p) {
    const Result single = run_points({points[p]});
    EXPECT_EQ(scan.detectors[0].detected[p], single.detectors[0].detected[0]);
    for (std::size_t i = 0; i < columns; ++i) {
      const auto own =
          std::find(single.ledger_levels.begin(), single.ledger_levels.end(), scan.ledger_levels[i]);
      const double found = scan.emitted_by_level[p * columns + i];
      if (own == single.ledger_levels.end())
        EXPECT_TRUE(std::isnan(found)) << p << scan.ledger_levels[i];
      else
        EXPECT_EQ(found,
                  single.emitted_by_level[static_cast<std::size_t>(own - single.ledger_levels.begin())]);
    }
  }
}

TEST(ManyParts, BehindASplitChangeNothingWhereTheyStopNothing) {
  Apparatus s = several()[2].second;
  s.particles = 1000;
  Beamline few = beamline_of(s), many = few;
  few.parts.back().placement.at = many.parts.back().placement.at = 1.4;
  for (int i = 0; i < 300; ++i)
    many.parts.insert(many.parts.end() - 1,
                      place("slit" + std::to_string(i), 1.21 + 5e-4 * i, Slit{Rectangle{1, 1}, {}}));
  expect_same(run_points({many}), 0, run_points({few}), "many ");
}

TEST(ThreeMagnets, AgreeWhetherTheFirstQuestionIsSplitOrAllAreDrawn) {
  for (auto [name, s] : several()) {
    s.particles = 100000;
    Beamline b = beamline_of(s);
    RotatingField again = std::get<RotatingField>(b.parts[2].part);
    again.length = 0.1;
    b.parts.insert(b.parts.end() - 1,
                   {place("C2", 1.25, UniformField{0.1, std::get<UniformField>(b.parts[1].part).field, {}}),
                    place("R2", 1.25, again), place("D", 1.4, gradient_magnet(0.2, 1, -s.b))});
    b.parts.back().placement.at = 1.8;
    const DetectorResult split = run_points({b}).detectors.at(0);
    b.law = QuantumLaw{Outcomes::sample};
    b.seed += 1;
    const DetectorResult sample = run_points({b}).detectors.at(0);
    EXPECT_GT(split.detected[0], 0.02) << name;
    EXPECT_NEAR(split.detected[0], sample.detected[0],
                4.5 * std::hypot(split.detected_errors[0], sample.detected_errors[0]))
        << name;
    for (std::size_t i = 0; i < split.levels.size(); ++i)
      EXPECT_NEAR(split.levels[i], sample.levels[i],
                  4.5 * std::hypot(split.levels_errors[i], sample.levels_errors[i]) + 1e-5)
          << name << " level " << i;
  }
}

TEST(DetectorInFrontOfAMagnet, TellsLevelsWhereThoseBehindAreSplit) {
  for (auto [name, s] : several()) {
    s.particles = 3000;
    Beamline b = beamline_of(s);
    b.source.opening = Disc{0.2e-3};
    b.parts.insert(b.parts.begin() + 1,
                   place("early", 0.5, Detector{Rectangle{1, 1e-3}, {1, 1}, {0, 0.5e-3}}));
    std::vector<Beamline> points{b, b};
    *std::get<RotatingField>(points[1].parts[3].part).frequency *= 1.01;
    const Result split = run_points(points);
    for (Beamline& p : points) p.law = QuantumLaw{Outcomes::sample};
    const Result sample = run_points(points);
    const DetectorResult &one = split.detectors.at(0), &other = sample.detectors.at(0);
    EXPECT_EQ(one.name, "early");
    EXPECT_GT(one.detected[0], 0.1);
    ASSERT_EQ(one.levels.size(), other.levels.size());
    for (std::size_t i = 0; i < one.levels.size(); ++i) {
      EXPECT_EQ(one.levels[i], other.levels[i]) << name;
      EXPECT_EQ(one.levels_errors[i], other.levels_errors[i]) << name;
    }
    EXPECT_NEAR(std::accumulate(one.levels.begin(), one.levels.end(), 0.0), 2, 1e-9) << name;
  }
}

TEST(Polarizer, InFrontOfAMagnetPreparesWhatIsDeflected) {
  Apparatus s;
  s.spin = UnpolarisedSpin{};
  s.particles = 20000;
  Beamline b = beamline_of(s);
  b.parts.insert(b.parts.begin(), place("P", 0.02, Polarizer{0.05, field, 0.6, {}}));
  // The moment along the field: S against it, m = -1/2.
  s.detector.offset.z = height(s, -1, -1);
  b.parts.back() = place("screen", s.screen, s.detector);
  expect_agreement(
      run_points({b}).detectors.at(0).detected.at(0), [](double scale) { return (1 + scale * 0.6) / 2; },
      1.01 * 2.9e-3, "polarised");
}

}  // namespace
}  // namespace rabiline::test::branches_test
