#include "scan/experiment.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <fstream>

namespace rabiline::experiment_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

const std::filesystem::path sample =
    std::filesystem::path(RABILINE_ROOT) / "beamline/suggested-experiment.yaml";

LoadedExperiment load(std::vector<std::string> set = {}, std::vector<std::string> scan = {}) {
  return load_experiment(load_file(sample), {std::move(set), std::move(scan), {}, {}});
}
std::string error_of(std::vector<std::string> set, std::vector<std::string> scan = {}) {
  try {
    load(std::move(set), std::move(scan));
  } catch (const InputError& e) {
    return e.what();
  }
  return {};
}
template <class P>
const P& part(const Beamline& beamline, std::string_view name) {
  for (const PlacedPart& p : beamline.parts)
    if (p.placement.name == name) return std::get<P>(p.part);
  throw std::runtime_error("no such part");
}

TEST(SpeciesOfOnesOwn, MayStateItsGFactorAndBeScannedOverIt) {
  const LoadedExperiment loaded = load_experiment(
      load_file(std::filesystem::path(RABILINE_ROOT) / "tests/corpus/good/species_with_g_factor.yaml"), {});
  const Species& s = loaded.base.species.at(0).species;
  EXPECT_EQ(s.name, "X");
  EXPECT_DOUBLE_EQ(s.gyromagnetic_ratio, s.charge / s.mass);  // g = 2
  EXPECT_EQ(s.spin, HalfInteger{1});
  EXPECT_EQ(s.source, "the beamline file");
  ASSERT_EQ(loaded.experiment.points.size(), 3U);
  EXPECT_DOUBLE_EQ(loaded.experiment.points[2].species.at(0).species.gyromagnetic_ratio,
                   2 * s.gyromagnetic_ratio);
}

TEST(SuggestedExperiment, IsReadAsItStands) {
  const LoadedExperiment loaded = load();
  const Beamline& b = loaded.base;
  EXPECT_EQ(b.title, "The experiment suggested to test the theory");
  ASSERT_EQ(b.species.size(), 1U);
  EXPECT_EQ(b.species[0].species, *find_species("neutron"));
  EXPECT_EQ(b.species[0].fraction, 1);
  EXPECT_EQ(std::get<DoradoLaw>(b.law), (DoradoLaw{Closure::torque, 1}));
  EXPECT_EQ(std::get<GaussianSpeed>(b.source.speed), (GaussianSpeed{1000, 10}));
  EXPECT_EQ(std::get<Rectangle>(b.source.opening), (Rectangle{0.2e-3, 1e-3}));
  EXPECT_TRUE(std::holds_alternative<ParallelDirection>(b.source.direction));
  EXPECT_EQ(b.chamber->radius, 0.05);
  ASSERT_EQ(b.parts.size(), 4U);
  EXPECT_EQ(b.parts[0].placement, (Placement{"B_prime", 0.1, "B\u2032"}));
  EXPECT_EQ(part<Polarizer>(b, "B_prime"), (Polarizer{0.1, 0.01, 1, {}}));
  EXPECT_EQ(part<UniformField>(b, "B"), (UniformField{0.25, 0.01, {}}));
  EXPECT_EQ(part<RotatingField>(b, "H0"),
            (RotatingField{0.2, 0.3e-6, 291600.0, Sense::co, {Phase::Kind::random, 0}, {}, {}}));
  EXPECT_EQ(part<Detector>(b, "screen"), (Detector{Rectangle{4e-3, 4e-3}, {80, 80}, {}}));
  EXPECT_EQ(b.particles, 10000U);
  EXPECT_EQ(b.seed, 1938U);
  ASSERT_EQ(loaded.inputs.size(), 1U);
  EXPECT_THAT(loaded.inputs[0].text, HasSubstr("rabiline: 1"));
}

TEST(Scan, HasBothEndsToTheBitAndOnePointForEachValue) {
  const Experiment e = load().experiment;
  ASSERT_EQ(e.axes.size(), 1U);
  EXPECT_EQ(e.axes[0].parameter, "H0.frequency");
  EXPECT_EQ(e.axes[0].dimension, Dimension::frequency);
  ASSERT_EQ(e.points.size(), 101U);
  EXPECT_EQ(e.axes[0].values.front(), 266600.0);
  EXPECT_EQ(e.axes[0].values[50], 291600.0);
  EXPECT_EQ(e.axes[0].values.back(), 316600.0);
  for (std::size_t i = 0; i < 101; ++i)
    EXPECT_EQ(part<RotatingField>(e.points[i], "H0").frequency, e.axes[0].values[i]);
  EXPECT_EQ(e.particles, ScanParticles::shared);
}

TEST(Scan, SpreadsALogarithmicRangeInEqualRatiosBetweenExactEnds) {
  const ScanAxis axis = load({}, {"H0.amplitude=3 nT:0.7 uT:6:log"}).experiment.axes[0];
  ASSERT_EQ(axis.values.size(), 6U);
  EXPECT_EQ(axis.values.front(), 3e-9);
  EXPECT_EQ(axis.values.back(), 0.7e-6);
  for (std::size_t i = 1; i < axis.values.size(); ++i)
    EXPECT_NEAR(axis.values[i] / axis.values[i - 1], std::pow(700.0 / 3, 0.2), 1e-13);
}

TEST(Scan, IsToldInTheUnitThatItIsWrittenIn) {
  const auto ends = [](const char* scan) {
    const ScanAxis axis = load({}, {scan}).experiment.axes[0];
    return value_at(axis, 0) + " to " + value_at(axis, axis.values.size() - 1);
  };
  EXPECT_EQ(ends("H0.frequency=280000 Hz:300000 Hz:3"), "280000 Hz to 300000 Hz");
  EXPECT_EQ(ends("H0.frequency=0 Hz:300.25 kHz:3"), "0 kHz to 300.25 kHz");
  EXPECT_EQ(ends("H0.phase=0 deg:360 deg:5"), "0 deg to 360 deg");
  EXPECT_EQ(ends("law.kappa=0,0.5"), "0 to 0.5");
}

TEST(CommandLine, SetsEachValueInOneLine) {
  for (const char* text : {"H0.amplitude=1 uT\nB.field: 2 mT", "H0.amplitude=[1,\n2]"})
    EXPECT_THAT(error_of({text}), HasSubstr("--set:2:1: error: what follows --set is one line\n"));
  EXPECT_THAT(error_of({}, {"law=dorado,\nclassical"}),
              HasSubstr("--scan:2:1: error: what follows --scan is one line\n"));
}

TEST(Scan, GoesLogarithmicallyThroughDecadesToTheBit) {
  const auto values = [](const char* scan) { return load({}, {scan}).experiment.axes[0].values; };
  EXPECT_THAT(values("H0.amplitude=1 nT:1 mT:7:log"), ElementsAre(1e-9, 1e-8, 1e-7, 1e-6, 1e-5, 1e-4, 1e-3));
  EXPECT_THAT(values("particles=1e6:1000:4:log"), ElementsAre(1e6, 1e5, 1e4, 1e3));
  EXPECT_THAT(values("B.field=-1 mT:-4 mT:3:log"), ElementsAre(-1e-3, -2e-3, -4e-3));
  EXPECT_THAT(values("H0.amplitude=2 nT:3 nT:2:log"), ElementsAre(2e-9, 3e-9));
}

TEST(Scan, ReadsItsSpacingFromTheFile) {
  const auto path = std::filesystem::temp_directory_path() / "rabiline_logarithmic_scan_test.yaml";
  const auto values = [&](const std::string& spacing) {
    std::ifstream in(sample);
    std::ofstream out(path);
    for (std::string line; std::getline(in, line);)
      if (!line.starts_with("scan:")) out << line << '\n';
    out << "scan: {parameter: H0.amplitude, from: 1 nT, to: 100 nT, points: 3" << spacing << "}\n"
        << std::flush;
    return load_experiment(load_file(path), {}).experiment.axes[0].values;
  };
  EXPECT_THAT(values(", spacing: logarithmic"), ElementsAre(1e-9, 1e-8, 1e-7));
  EXPECT_THAT(values(", spacing: linear"), ElementsAre(1e-9, testing::DoubleEq(50.5e-9), 1e-7));
  EXPECT_EQ(values(", spacing: linear"), values(""));
  std::filesystem::remove(path);
}

TEST(Scan, OfTheCommandLineReplacesTheSameOneAndElseGoesOutside) {
  const Experiment same = load({}, {"H0.frequency=1 kHz,2 kHz"}).experiment;
  EXPECT_THAT(same.axes.at(0).values, ElementsAre(1000, 2000));
  EXPECT_EQ(same.axes.size(), 1U);
  const Experiment grid = load({}, {"law=quantum,{name: dorado, closure: larmor}"}).experiment;
  ASSERT_EQ(grid.axes.size(), 2U);
  EXPECT_EQ(grid.axes[0].parameter, "law");
  EXPECT_EQ(grid.axes[0].dimension, std::nullopt);
  EXPECT_THAT(grid.axes[0].values, ElementsAre(0, 1));
  EXPECT_THAT(grid.axes[0].labels, ElementsAre("quantum", "dorado (larmor, kappa = 1)"));
  ASSERT_EQ(grid.points.size(), 202U);
  EXPECT_TRUE(std::holds_alternative<QuantumLaw>(grid.points[100].law));
  EXPECT_TRUE(std::holds_alternative<DoradoLaw>(grid.points[101].law));
  EXPECT_EQ(part<RotatingField>(grid.points[101 + 7], "H0").frequency, grid.axes[1].values[7]);
}

TEST(Scan, ReachesNumbersWordsCountsAndKeysThatTheFileLeavesOut) {
  for (const char* scan :
       {"source.speed.mean=900 m/s:1100 m/s:3", "source.opening.width=0.1 mm:0.3 mm:3", "law.kappa=0:1:3",
        "screen.offset.x=-1 mm:1 mm:3", "particles=100:300:3", "seed=1,2,3", "chamber.radius=40 mm:60 mm:3",
        "B_prime.alignment=0:1:3", "B.bore.radius=10 mm:30 mm:3", "H0.phase=0 deg,90 deg,180 deg"}) {
    const Experiment e = load({}, {std::string(scan), "H0.frequency=1 kHz"}).experiment;
    EXPECT_TRUE(e.axes[0].dimension) << scan;
    EXPECT_EQ(e.points.size(), 3U) << scan;
  }
  for (const char* scan :
       {"species=neutron,proton,H", "H0.sense=co,counter,positive", "H0.phase=random,locked,30 deg",
        "source.direction=parallel,{kind: cone, half_angle: 1 mrad},{kind: aimed, target: screen}"}) {
    try {
      const Experiment e = load({}, {std::string(scan), "H0.frequency=1 kHz"}).experiment;
      EXPECT_EQ(e.axes[0].labels.size(), 3U) << scan;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), HasSubstr("nothing may act before")) << scan;
    }
  }
}

TEST(Scan, OfParticlesRefusesAFractionBetweenItsEnds) {
  EXPECT_THAT(error_of({}, {"particles=1:2:3"}), HasSubstr("whole number"));
}

TEST(Scan, CanDrawItsParticlesAnewFromTheCommandLine) {
  EXPECT_EQ(load({"scan.particles=independent"}).experiment.particles, ScanParticles::independent);
}

TEST(Scan, OfAThousandPointsTakesLessThanASecond) {
  const std::clock_t start = std::clock();  // of the processor
  EXPECT_EQ(load({}, {"H0.frequency=1 kHz:2 kHz:1000"}).experiment.points.size(), 1000U);
  EXPECT_LT(std::clock() - start, CLOCKS_PER_SEC);
}

TEST(Settings, ChangeTheFileAndEveryPointOfItsScan) {
  const LoadedExperiment loaded = load({"B.field=11 mT", "law=quantum", "particles=5", "title=Another"});
  EXPECT_EQ(part<UniformField>(loaded.base, "B").field, 0.011);
  EXPECT_EQ(part<UniformField>(loaded.experiment.points[77], "B").field, 0.011);
  EXPECT_TRUE(std::holds_alternative<QuantumLaw>(loaded.base.law));
  EXPECT_EQ(loaded.base.particles, 5U);
  EXPECT_EQ(loaded.base.title, "Another");
}

TEST(Settings, WriteAShortFormOut) {
  const LoadedExperiment loaded = load({"law=dorado", "law.kappa=0.5", "law.closure=larmor"});
  EXPECT_EQ(std::get<DoradoLaw>(loaded.base.law), (DoradoLaw{Closure::larmor, 0.5}));
  EXPECT_EQ(load({"gravity=9.81 m/s^2", "gravity.acceleration=5 m/s^2"}).base.gravity->acceleration, 5);
}

TEST(Settings, OfParticlesAndSeedHaveOptionsOfTheirOwn) {
  const LoadedExperiment loaded = load_experiment(load_file(sample), {{}, {}, "7", "18446744073709551615"});
  EXPECT_EQ(loaded.base.particles, 7U);
  EXPECT_EQ(loaded.base.seed, 18446744073709551615ULL);
}

TEST(Settings, OfParticlesAreReadAsTheFileReadsThem) {
  EXPECT_EQ(load_experiment(load_file(sample), {{}, {}, "1e5", {}}).base.particles, 100000U);
  EXPECT_THROW(load_experiment(load_file(sample), {{}, {}, "010", {}}), InputError);
  EXPECT_EQ(read_argument("--batch", "512", range::positive), 512U);
  EXPECT_THROW(read_argument("--batch", "512 MiB", range::positive), InputError);
}

TEST(Settings, ReportEveryMistakeAtOnceInTheOrderGiven) {
  const std::string error = error_of({"B.field=1", "H0.amplitude=1 Hz"});
  const auto first = error.find("`field` is a magnetic field"), second = error.find("`1 Hz` is a frequency");
  EXPECT_NE(first, std::string::npos);
  EXPECT_NE(second, std::string::npos);
  EXPECT_LT(first, second);
}

/// The sample with some texts put in place of others.
LoadedExperiment load_changed(const std::vector<std::pair<std::string, std::string>>& changes,
                              std::vector<std::string> set = {}, std::vector<std::string> scan = {}) {
  std::ifstream in(sample);
  std::string file{std::istreambuf_iterator<char>(in), {}};
  for (const auto& [text, other] : changes) file.replace(file.find(text), text.size(), other);
  const auto path = std::filesystem::temp_directory_path() / "rabiline_changed_experiment_test.yaml";
  std::ofstream(path) << file;
  return load_experiment(load_file(path), {std::move(set), std::move(scan), {}, {}});
}

/// The beamline at a point is the one of a file that states the values of that point, to the bit.
TEST(ParameterSpace, MakesEachPointAsTheReaderDoes) {
  for (const char* name :
       {"source.speed.mean=900 m/s,1100 m/s", "source.opening.width=0.1 mm,0.3 mm", "law.kappa=0.5,1",
        "law=quantum,{name: dorado, closure: larmor},classical", "screen.offset.x=-1 mm,1 mm",
        "chamber.radius=40 mm,60 mm", "B_prime.alignment=0.5,1", "B.bore.radius=10 mm,30 mm",
        "H0.phase=random,90 deg", "H0.at=0.31 m,0.36 m", "B_prime.at=0.1 m,0.9 m", "species=neutron,proton",
        "B.label=one,two", "H0.enabled=true,false", "source.speed.kind=gaussian", "H0.sense=co,negative"}) {
    const std::string scan = name;
    const Experiment e = load({}, {scan, "seed=1,2", "H0.frequency=1 kHz,2 kHz"}).experiment;
    const std::string parameter = scan.substr(0, scan.find('='));
    ASSERT_EQ(e.axes.size(), 3U);
    const std::size_t values = e.axes[0].values.size();
    ASSERT_EQ(e.points.size(), 4 * values);
    std::size_t from = scan.find('=') + 1;
    for (std::size_t i = 0; i < values; ++i) {
      const std::size_t brace = scan.find('}', from);
      std::size_t end = scan.find(',', scan[from] == '{' ? brace : from);
      end = std::min(end, scan.size());
      for (std::size_t k = 0; k < 4; ++k) {
        const Beamline alone =
            load({parameter + "=" + scan.substr(from, end - from), k < 2 ? "seed=1" : "seed=2"},
                 {k % 2 == 0 ? "H0.frequency=1 kHz" : "H0.frequency=2 kHz"})
                .experiment.points.front();
        EXPECT_TRUE(e.points[4 * i + k] == alone) << scan << ", point " << 4 * i + k;
      }
      from = end + 1;
    }
  }
}

TEST(Scan, MayChangeSeveralParametersTogether) {
  const Experiment e = load({}, {"B.field, B_prime.field=9 mT:11 mT:3", "H0.frequency=1 kHz"}).experiment;
  ASSERT_EQ(e.axes.size(), 2U);
  EXPECT_EQ(e.axes[0].parameter, "B.field, B_prime.field");
  EXPECT_THAT(e.axes[0].values, ElementsAre(0.009, testing::DoubleEq(0.01), 0.011));
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(part<UniformField>(e.points[i], "B").field, e.axes[0].values[i]);
    EXPECT_EQ(part<Polarizer>(e.points[i], "B_prime").field, e.axes[0].values[i]);
  }
}

TEST(Scan, IsOmittedOnDemand) {
  Changes line{{}, {}, {}, {}, true};
  EXPECT_EQ(load_experiment(load_file(sample), line).experiment.points.size(), 1U);
  line.scan = {"B.field=9 mT,10 mT"};
  const Experiment e = load_experiment(load_file(sample), line).experiment;
  ASSERT_EQ(e.axes.size(), 1U);
  EXPECT_EQ(e.axes[0].parameter, "B.field");
}

TEST(Variables, StandForValuesAndInsideOfThem) {
  const std::string stated = "variables: {B1: 9 mT, number: 4, size: \"${number} mm\"}\nseed: 1938";
  const auto changed = [&](std::vector<std::string> set, std::vector<std::string> scan) {
    set.insert(set.begin(), {"B.field=${B1}", "screen.width=${size}"});
    return load_changed({{"seed: 1938", stated}}, std::move(set), std::move(scan));
  };
  const Beamline plain = changed({}, {}).base;
  EXPECT_EQ(part<UniformField>(plain, "B").field, 0.009);
  EXPECT_EQ(std::get<Rectangle>(part<Detector>(plain, "screen").face).width, 0.004);
  EXPECT_EQ(part<UniformField>(changed({"variables.B1=8 mT"}, {}).base, "B").field, 0.008);
  const Experiment e = changed({}, {"variables.B1=7 mT:8 mT:3", "H0.frequency=1 kHz"}).experiment;
  EXPECT_THAT(e.axes.at(0).values, ElementsAre(0.007, 0.0075, 0.008));
  EXPECT_EQ(e.axes[0].dimension, Dimension::magnetic_field);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_EQ(part<UniformField>(e.points[i], "B").field, e.axes[0].values[i]);
}

TEST(Variables, ThatStandNowhereAreToldInAWarning) {
  const std::string stated = "variables: {B1: 9 mT, size: 4 mm, half: \"${size}\"}\nseed: 1938";
  const auto unused = load_changed({{"seed: 1938", stated}}, {"screen.width=${half}"}).unused;
  ASSERT_EQ(unused.size(), 1U);
  EXPECT_EQ(unused[0].message, "the variable `B1` stands nowhere");
  EXPECT_EQ(unused[0].severity, Severity::warning);
}

TEST(Variables, StandUnquotedInsideOfBraces) {
  const Beamline b =
      load_changed({{"field: 10 mT}", "field: ${B1}}"}, {"seed:", "variables: {B1: 12 mT}\nseed:"}}).base;
  EXPECT_EQ(part<UniformField>(b, "B").field, 0.012);
}

TEST(Parts, ThatAreNotEnabledAreAsIfAbsent) {
  const Beamline without = load({"B.enabled=false"}).base;
  ASSERT_EQ(without.parts.size(), 3U);
  EXPECT_EQ(without.parts[1].placement.name, "H0");
  EXPECT_TRUE(load({"B.enabled=true"}).base == load().base);
  EXPECT_EQ(load({"B.enabled=false", "B.field=1 mT"}).base.parts.size(), 3U);
}

TEST(Parts, AreSortedByWhereTheyBegin) {
  const LoadedExperiment loaded = load({"B_prime.at=0.9 m"});
  EXPECT_EQ(loaded.base.parts[2].placement.name, "B_prime");
  EXPECT_EQ(loaded.base.parts[3].placement.name, "screen");
}

}  // namespace
}  // namespace rabiline::experiment_test
