#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include <fstream>
#include <regex>

#include "commands/common.hpp"
#include "rabiline.hpp"

namespace rabiline::face_test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;

const std::string beamline = R"(rabiline: 1
title: A flip
species: neutron
law: dorado
source: {speed: {kind: gaussian, mean: 1000 m/s, sigma: 10 m/s}, opening: {radius: 0.3 mm}, direction: parallel}
parts:
  - {name: P,  kind: polarizer,      at: 0.10 m, length: 0.10 m, field: 10 mT, alignment: 1}
  - {name: B,  kind: uniform_field,  at: 0.30 m, length: 0.25 m, field: 10 mT}
  - {name: H0, kind: rotating_field, at: 0.35 m, length: 0.20 m, amplitude: 0.3 uT, frequency: 291.6 kHz, sense: co, phase: random}
  - {name: D,  kind: detector,       at: 1.2 m, width: 4 mm, height: 4 mm, bins: [20, 20]}
particles: 1003
seed: 7
scan: {parameter: H0.frequency, from: 288 kHz, to: 294 kHz, points: 3}
)";

const std::string model = R"(rabiline: 1
title: A cylinder
model: {kind: rotating_cylinder, mass: 1 kg, radius: 0.1 m, length: 0.2 m, spin: 30 Hz, speed: 1 m/s, torque: {kind: body_fixed, size: 0.5 N m}, axis_start: at_rest, duration: 0.1 s, samples: 21}
)";

const std::string coils = R"(rabiline: 1
species: neutron
law: quantum
source: {speed: {kind: single, value: 1000 m/s}, opening: {radius: 0.3 mm}, direction: parallel}
parts:
  - {name: S, kind: solenoid,     at: 1 m, winding: 0.4 m, radius: 50 mm, field: 1 mT}
  - {name: P, kind: coil_pair,    at: 4 m, radius: 0.1 m, field: 1 mT}
  - {name: L, kind: current_loop, at: 7 m, radius: 0.2 m, field: 1 mT}
  - {name: D, kind: detector,     at: 9 m, radius: 1 m, bins: [1, 1]}
particles: 10
seed: 7
)";

/// A folder for one test; tests run side by side.
class Face : public testing::Test {
 protected:
  Face() { std::filesystem::create_directories(folder_); }
  ~Face() override { std::filesystem::remove_all(folder_); }
  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() /
      (std::string("rabiline_face_") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

std::vector<double> numbers_in(const std::filesystem::path& path, const char* dataset, std::size_t size) {
  std::vector<double> out(size);
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t data = H5Dopen2(file, dataset, H5P_DEFAULT), space = H5Dget_space(data);
  EXPECT_EQ(H5Sget_simple_extent_npoints(space), static_cast<hssize_t>(size));
  EXPECT_GE(H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, out.data()), 0);
  H5Sclose(space);
  H5Dclose(data);
  H5Fclose(file);
  return out;
}

void expect_same_bits(const Result& a, const Result& b) {
  EXPECT_EQ(a.detectors.front().counts, b.detectors.front().counts);
  EXPECT_EQ(a.detectors.front().counts_errors, b.detectors.front().counts_errors);
  EXPECT_EQ(a.emitted_quanta_low, b.emitted_quanta_low);
  ASSERT_EQ(a.fates.size(), b.fates.size());
  for (std::size_t i = 0; i < a.fates.size(); ++i) EXPECT_EQ(a.fates[i].quanta_low, b.fates[i].quanta_low);
}

TEST_F(Face, GivesTheResultOfATextThatTheCommandGivesOfAFile) {
  std::ofstream(folder_ / "flip.yaml") << beamline;
  testing::internal::CaptureStdout();
  ASSERT_EQ(run_program({"run", folder_ / "flip.yaml", "-o", folder_ / "flip.h5", "--set", "B.field=9.9 mT",
                         "--particles", "500", "--progress", "none"}),
            0);
  testing::internal::GetCapturedStdout();
  const auto setup = load_text(beamline, folder_, {.set = {"B.field=9.9 mT"}, .particles = "500"});
  EXPECT_EQ(setup.title(), "A flip");
  EXPECT_EQ(setup.points(), 3U);
  const std::optional<Result> result = run(setup, {.threads = 2, .arguments = {"mine"}});
  ASSERT_TRUE(result);
  EXPECT_EQ(result->particles, 500U);
  const DetectorResult& detector = result->detectors.front();
  EXPECT_EQ(detector.counts, numbers_in(folder_ / "flip.h5", "/entry/D/counts", 3 * 20 * 20));
  EXPECT_EQ(detector.detected_errors, numbers_in(folder_ / "flip.h5", "/entry/scan/detected_errors", 3));
  EXPECT_THAT(result->provenance.arguments, ElementsAre("mine"));
  EXPECT_EQ(result->provenance.inputs.front().text, beamline);
  EXPECT_EQ(result->provenance.threads, 2);

  write(*result, folder_ / "mine.h5");
  EXPECT_EQ(numbers_in(folder_ / "mine.h5", "/entry/D/counts", 3 * 20 * 20), detector.counts);
  EXPECT_THROW(write(*result, folder_ / "nowhere/mine.h5"), StorageError);
}

/// What a run will take is told as it was timed.
std::string without_time(const std::string& report) {
  return std::regex_replace(report, std::regex("(about|core,) \\S+ s "), "");
}
TEST_F(Face, TellsTheSameAsTheCommandBeforeARun) {
  std::ofstream(folder_ / "flip.yaml") << beamline;
  testing::internal::CaptureStdout();
  ASSERT_EQ(run_program({"check", folder_ / "flip.yaml"}), 0);
  const std::string told = testing::internal::GetCapturedStdout();
  const Report report = check(load(folder_ / "flip.yaml"));
  EXPECT_THAT(report.text, HasSubstr("A flip"));
  EXPECT_EQ(without_time(told), without_time(report.text + render(report.warnings)));
}

TEST_F(Face, FindsTheLineOfATextThatAFaultOrAWarningStandsIn) {
  std::string text = beamline;
  text.replace(text.find("10 mT, alignment"), 5, "10 mm");
  try {
    load_text(text, {});
    FAIL() << "nothing is wrong";
  } catch (const InputError& error) {
    ASSERT_THAT(error.diagnostics(), SizeIs(1));
    EXPECT_EQ(error.diagnostics().front().place.line, 7);
    EXPECT_THAT(error.what(), HasSubstr("text:7:73: error: "));
  }
  const auto setup = load_text(beamline, {}, {.set = {"H0.frequency=1 MHz"}, .without_scan = true});
  const std::vector<Diagnostic> warnings = check(setup).warnings;
  ASSERT_FALSE(warnings.empty());
  EXPECT_EQ(warnings.front().severity, Severity::warning);
  EXPECT_GT(warnings.front().place.line, 0);
  std::vector<Diagnostic> before_the_flight;
  RunSettings settings;
  settings.planned = [&](const std::vector<Diagnostic>& told) { before_the_flight = told; };
  const std::optional<Result> result = run(setup, settings);
  EXPECT_EQ(render(before_the_flight), render(warnings));
  EXPECT_THAT(result->provenance.warnings.front(), testing::StartsWith(warnings.front().message));
}

TEST_F(Face, ReadsWhatATextNamesInItsFolder) {
  std::ofstream(folder_ / "bench.yaml")
      << "rabiline: 1\nparts:\n  - {name: S, kind: slit, at: 5 cm, width: 1 mm, height: 1 mm}\n";
  const auto setup = load_text("geometry: bench.yaml\n" + beamline, folder_);
  ASSERT_THAT(setup.inputs(), SizeIs(2));
  EXPECT_EQ(setup.inputs().back().path, (folder_ / "bench.yaml").string());
  EXPECT_THAT(check(setup).text, HasSubstr("S"));
  EXPECT_THROW(load_text("geometry: bench.yaml\n" + beamline, folder_ / "elsewhere"), InputError);
}

TEST_F(Face, GoesOnFromASnapshotToTheSameBits) {
  const auto setup = load_text(beamline, {}, {.particles = "500000"});
  const std::optional<Result> whole = run(setup, {.threads = 2});
  ASSERT_TRUE(whole);

  std::atomic<bool> stop{false};
  int snapshots = 0;
  RunSettings settings;
  settings.threads = 1;
  settings.stop = &stop;
  settings.snapshot_seconds = 0;
  settings.snapshot = [&](const Snapshot& snapshot) {
    write(snapshot, folder_ / "kept");
    EXPECT_FALSE(snapshot.complete);
    ++snapshots;
    stop = true;
  };
  EXPECT_FALSE(run(setup, settings));
  EXPECT_GT(snapshots, 0);

  const Snapshot kept = read_snapshot(folder_ / "kept");
  EXPECT_EQ(kept.fingerprint, setup.fingerprint());
  EXPECT_FALSE(kept.finished.empty());
  const std::optional<Result> resumed = run(setup, {.start = &kept});
  ASSERT_TRUE(resumed);
  expect_same_bits(*whole, *resumed);
  EXPECT_THROW(run(load_text(beamline, {}, {.particles = "60001"}), {.start = &kept}), std::invalid_argument);
}

TEST_F(Face, RefusesSettingsThatDoNotFit) {
  const auto setup = load_text(beamline, {});
  EXPECT_THROW(run(setup, {.threads = -1}), std::invalid_argument);
  EXPECT_THROW(run(setup, {.isa = "sse9"}), std::invalid_argument);
  EXPECT_THROW(run(setup, {.batch = 12}), std::invalid_argument);
  EXPECT_THROW(solve(setup), std::invalid_argument);
  const auto solved = load_text(model, {});
  EXPECT_TRUE(solved.is_model());
  EXPECT_THROW(run(solved), std::invalid_argument);
  EXPECT_THROW(trace(solved, 0, 1), std::invalid_argument);
  std::ofstream(folder_ / "model.yaml") << model;
  EXPECT_THROW(load_beamline(folder_ / "model.yaml"), InputError);
}

TEST_F(Face, EndsARunThatItsCallerRefusesBeforeTheFlight) {
  RunSettings settings;
  settings.planned = [](const std::vector<Diagnostic>&) { throw InputError({}); };
  settings.progress = [](const Progress&) { FAIL() << "it flies"; };
  EXPECT_THROW(run(load_text(beamline, {}), settings), InputError);
}

TEST_F(Face, FollowsParticlesByTheirNumbers) {
  const auto setup = load_text(beamline, {}, {.set = {"law=quantum"}});
  const std::vector<Track> tracks = trace(setup, 1001, 5);
  ASSERT_THAT(tracks, SizeIs(2));  // the run has 1003
  EXPECT_EQ(tracks.front().particle, 1001U);
  EXPECT_EQ(tracks.front().where, "D");
  EXPECT_THROW(trace(setup, 1003, 1), std::invalid_argument);
  write(tracks, setup, folder_ / "tracks.h5");
  EXPECT_EQ(numbers_in(folder_ / "tracks.h5", "/entry/particle_1002/t", tracks[1].t.size()), tracks[1].t);
}

TEST_F(Face, SolvesAModelOverItsScan) {
  const auto setup = load_text(model, {}, {.scan = {"model.spin=10 Hz:30 Hz:3"}});
  EXPECT_EQ(setup.points(), 3U);
  EXPECT_THAT(check(setup).text, HasSubstr("A cylinder"));
  const SolvedModel solved = solve(setup, {"mine"});
  EXPECT_THAT(solved.points, SizeIs(3));
  EXPECT_EQ(solved.kind, "rotating_cylinder");
  EXPECT_EQ(solved.axis->values, (std::vector<double>{10, 20, 30}));
  EXPECT_FALSE(solved.points.front().motions.empty());
  write(solved, folder_ / "cylinder.h5");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "cylinder.h5"));
}

TEST_F(Face, TellsWhereTheTurnsOfCoilsStandHoweverFarTheirFieldReaches) {
  const std::vector<PartName> parts = parts_of(load_text(coils, folder_ / "coils.yaml"));
  const auto stretch = [&](std::size_t part) { return std::pair(parts.at(part).begin, parts.at(part).end); };
  EXPECT_EQ(stretch(0), std::pair(0.8, 1.2));
  EXPECT_EQ(stretch(1), std::pair(3.9, 4.1));  // about z
  EXPECT_EQ(stretch(2), std::pair(7.0, 7.0));
}

}  // namespace
}  // namespace rabiline::face_test
