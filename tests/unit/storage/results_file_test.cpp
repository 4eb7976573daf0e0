#include "storage/results_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <random>

#include "forked.hpp"
#include "samples.hpp"
#include "storage/contents.hpp"
#include "storage/hdf5_writer.hpp"
#include "storage/origin.hpp"
#include "storage/seal.hpp"
#include "storage/tracks_file.hpp"

namespace rabiline::results_file_test {
namespace {

using samples::Folder;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct Dataset {
  std::vector<hsize_t> shape;
  std::vector<double> values;
};

Dataset read(const std::filesystem::path& path, const std::string& name) {
  const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const hid_t dataset = H5Dopen2(file, name.c_str(), H5P_DEFAULT), space = H5Dget_space(dataset);
  Dataset read;
  read.shape.resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
  H5Sget_simple_extent_dims(space, read.shape.data(), nullptr);
  read.values.resize(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  H5Dread(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, read.values.data());
  H5Sclose(space);
  H5Dclose(dataset);
  H5Fclose(file);
  return read;
}

/// The file's bytes with the time of writing blanked out, without the last line, which is a digest of all
/// before.
std::string timeless(const std::filesystem::path& path) {
  std::string bytes = samples::bytes_of(path);
  bytes.erase(bytes.rfind('\n', bytes.size() - 2));
  const std::string century = "20";
  for (std::size_t at = bytes.find(century); at != std::string::npos; at = bytes.find(century, at + 1)) {
    if (at + 20 <= bytes.size() && bytes[at + 10] == 'T' && bytes[at + 19] == 'Z')
      bytes.replace(at, 20, 20, ' ');
  }
  return bytes;
}

TEST(ResultsFile, KeepsAGridInOrder) {
  const Folder folder;
  const Result result = samples::result({samples::frequency_axis(5), samples::field_axis(2)}, {"screen"});
  const DetectorResult& screen = result.detectors.front();
  write_results(result, folder / "a.h5");
  const Dataset counts = read(folder / "a.h5", "/entry/screen/counts");
  EXPECT_THAT(counts.shape, ElementsAre(5, 2, 4, 3));
  EXPECT_EQ(counts.values, screen.counts);
  const Dataset detected = read(folder / "a.h5", "/entry/scan/detected");
  EXPECT_THAT(detected.shape, ElementsAre(5, 2));
  EXPECT_EQ(detected.values, screen.detected);
  EXPECT_EQ(read(folder / "a.h5", "/entry/scan/detected_covariance").values, screen.detected_covariance);
  EXPECT_EQ(read(folder / "a.h5", "/entry/scan/B_field").values, result.axes[1].values);
}

TEST(ResultsFile, StatesWhatAnAimedSourceStandsForAndHowMuchItGives) {
  const Folder folder;
  const Result result = samples::result({samples::frequency_axis(5)}, {"screen"});
  write_results(result, folder / "a.h5");
  EXPECT_EQ(read(folder / "a.h5", "/entry/aimed_fraction").values, result.aimed_fraction);
  EXPECT_THAT(read(folder / "a.h5", "/entry/rate").values, ElementsAre(1e6));
}

TEST(ResultsFile, KeepsTalliesBehindTheScanUnderNamesThatDoNotCollide) {
  // Two axes over the same quantity, and a scan of `spin.mean`, which is what their mean would be called.
  ScanAxis scanned = samples::frequency_axis(2);
  scanned.parameter = "spin.mean";
  Result result = samples::result({scanned}, {"screen"});
  TallyAxisResult spin{"spin",     Dimension::number, {-1, 0, 1}, {},        {1, 0, 0},
                       {0.1, 0.2}, {0.01, 0.02},      {1, 2},     {0.5, 0.5}};
  TallyAxisResult level{"level", Dimension::number, {-1, 0, 1}, {"m = -1/2", "m = +1/2"}, {}, {}, {}, {}, {}};
  result.monitors = {{"M", "M", 0.5, {0.25, 0.5}, {0.1, 0.2}, {1, 2, 2, 3}}};
  std::vector<double> counts(16);
  for (std::size_t i = 0; i < counts.size(); ++i) counts[i] = static_cast<double>(i);
  result.tallies = {{"M", "M", "t", true, true, {spin, spin, level}, counts, counts, {7, 8}, {0.7, 0.8}}};
  const Folder folder;
  write_results(result, folder / "a.h5");
  const Dataset read_counts = read(folder / "a.h5", "/entry/M_t/counts");
  EXPECT_THAT(read_counts.shape, ElementsAre(2, 2, 2, 2));
  EXPECT_EQ(read_counts.values, counts);
  EXPECT_THAT(read(folder / "a.h5", "/entry/M_t/spin_mean").values,
              ElementsAre(scanned.values[0], scanned.values[1]));
  EXPECT_THAT(read(folder / "a.h5", "/entry/M_t/spin__mean").values, ElementsAre(0.1, 0.2));
  EXPECT_THAT(read(folder / "a.h5", "/entry/M_t/spin___deviation_errors").values, ElementsAre(0.5, 0.5));
  EXPECT_THAT(read(folder / "a.h5", "/entry/M_t/level").values, ElementsAre(-0.5, 0.5));
  EXPECT_THAT(read(folder / "a.h5", "/entry/M_t/outside").values, ElementsAre(7, 8));
  EXPECT_THAT(read(folder / "a.h5", "/entry/M/passed_covariance").shape, ElementsAre(2, 2));
}

TEST(ResultsFile, LeavesScanDimensionsOutWhereNothingIsScanned) {
  const Folder folder;
  write_results(samples::result({}, {"screen"}), folder / "a.h5");
  EXPECT_THAT(read(folder / "a.h5", "/entry/scan/detected").shape, ElementsAre(1));
  EXPECT_THAT(read(folder / "a.h5", "/entry/screen/counts").shape, ElementsAre(4, 3));
  EXPECT_THAT(read(folder / "a.h5", "/entry/screen_levels/levels").shape, ElementsAre(2));
}

TEST(ResultsFile, PutsSeveralDetectorsInALeadingDimension) {
  const Folder folder;
  const Result result = samples::result({samples::frequency_axis(5)}, {"left", "right"});
  write_results(result, folder / "a.h5");
  const Dataset detected = read(folder / "a.h5", "/entry/scan/detected");
  EXPECT_THAT(detected.shape, ElementsAre(2, 5));
  EXPECT_EQ(std::vector(detected.values.begin() + 5, detected.values.end()), result.detectors[1].detected);
  EXPECT_THAT(read(folder / "a.h5", "/entry/scan/detected_covariance").shape, ElementsAre(2, 5, 5));
}

TEST(ResultsFile, WritesBinCentresAndKeepsTheEdges) {
  const Folder folder;
  write_results(samples::result({}, {"screen"}), folder / "a.h5");
  EXPECT_THAT(read(folder / "a.h5", "/entry/screen/x").values, ElementsAre(-1.5e-3, -0.5e-3, 0.5e-3, 1.5e-3));
  EXPECT_THAT(read(folder / "a.h5", "/entry/screen/x_edges").values,
              ElementsAre(-2e-3, -1e-3, 0, 1e-3, 2e-3));
}

TEST(ResultsFile, LosesNoDetectorThatIsCalledLikeAnotherGroup) {
  const Folder folder;
  const Result result = samples::result({samples::frequency_axis(3)}, {"scan", "a", "a_x"});
  write_results(result, folder / "a.h5");
  EXPECT_EQ(read(folder / "a.h5", "/entry/scan_/counts").values, result.detectors[0].counts);
  EXPECT_EQ(read(folder / "a.h5", "/entry/a_x/counts").values, result.detectors[1].counts_x);
  EXPECT_EQ(read(folder / "a.h5", "/entry/a_x_/counts").values, result.detectors[2].counts);
  EXPECT_EQ(read(folder / "a.h5", "/entry/instrument/a_x/data").values, result.detectors[2].counts);
}

TEST(ResultsFile, HasTheSameBytesForTheSameResultButForItsTime) {
  const Folder folder, other;
  const Result result = samples::result({samples::frequency_axis(5), samples::law_axis()}, {"left", "right"});
  write_results(result, folder / "a.h5");
  write_results(result, other / "a.h5");
  EXPECT_EQ(timeless(folder / "a.h5"), timeless(other / "a.h5"));
}

TEST(ResultsFile, RefusesAResultWhoseSizesContradictEachOther) {
  const Folder folder;
  Result result = samples::result({samples::frequency_axis(5)}, {"screen"});
  result.detectors.front().counts.pop_back();
  try {
    write_results(result, folder / "a.h5");
    FAIL() << "it was written";
  } catch (const StorageError& error) {
    EXPECT_THAT(error.what(), HasSubstr("a.h5: /entry/screen/counts: 59 values where 60 belong"));
  }
  EXPECT_TRUE(folder.names().empty());
}

TEST(ResultsFile, KeepsAnEarlierFileWhenItCannotBeWritten) {
  const Folder folder;
  write_results(samples::result({}, {"screen"}), folder / "a.h5");
  const std::string earlier = samples::bytes_of(folder / "a.h5");
  EXPECT_THAT(failure_in_child([&] {
                std::signal(SIGXFSZ, SIG_IGN);
                const rlimit limit{8192, 8192};
                ::setrlimit(RLIMIT_FSIZE, &limit);
                write_results(samples::result({samples::frequency_axis(101)}, {"screen"}), folder / "a.h5");
              }),
              HasSubstr("a.h5: cannot be written (File too large)"));
  EXPECT_EQ(samples::bytes_of(folder / "a.h5"), earlier);
  EXPECT_THAT(folder.names(), ElementsAre("a.h5"));
}

TEST(ResultsFile, HasASealThatEveryChangeOfItBreaks) {
  const Folder folder;
  write_results(samples::result({}, {"screen"}), folder / "a.h5");
  EXPECT_EQ(verified_digest(folder / "a.h5").size(), 64U);
  const std::string whole = samples::bytes_of(folder / "a.h5");
  std::mt19937 random(1938);
  for (int trial = 0; trial < 1000; ++trial) {
    std::string flipped = whole;
    flipped[random() % whole.size()] ^= static_cast<char>(1 << random() % 8);
    samples::put_bytes(folder / "b.h5", flipped);
    ASSERT_THROW(verified_digest(folder / "b.h5"), StorageError);
  }
  for (const std::size_t size : {std::size_t{0}, std::size_t{50}, whole.size() / 2, whole.size() - 1}) {
    samples::put_bytes(folder / "b.h5", whole.substr(0, size));
    EXPECT_THROW(verified_digest(folder / "b.h5"), StorageError) << size;
  }
}

TEST(ResultsFile, IsComparedInAllButWhereItComesFrom) {
  const Folder folder;
  Result result = samples::result({samples::frequency_axis(3), samples::law_axis()}, {"screen"});
  write_results(result, folder / "a.h5");
  const auto differs = [&] { return differing(folder / "a.h5", image_of(result)); };
  result.provenance.host = "another";
  result.provenance.version = "0.0.0";
  result.provenance.seconds += 1;
  result.provenance.warnings = {"another"};
  EXPECT_THAT(differs(), IsEmpty());
  result.seed += 1;
  EXPECT_THAT(differs(), ElementsAre("/entry/simulation/seed"));
  result.seed -= 1;
  DetectorResult& screen = result.detectors.front();
  screen.counts[0] = std::nextafter(screen.counts[0], 1e9);
  EXPECT_THAT(differs(), ElementsAre("/entry/instrument/screen/data", "/entry/screen/counts"));
  screen.counts[0] = std::nextafter(screen.counts[0], 0);
  screen.label = "another";
  EXPECT_THAT(differs(), Contains("/entry/scan/detected"));  // its attribute `long_name`
}

/// By another program, which counts the digest in the last line anew.
TEST(ResultsFile, IsFoundOutWhereItWasForged) {
  const Folder folder;
  const Result result = samples::result({samples::frequency_axis(3)}, {"screen"});
  write_results(result, folder / "a.h5");
  const auto forged = [&](auto change) {
    std::string bytes = samples::bytes_of(folder / "a.h5");
    bytes.erase(bytes.rfind('\n', bytes.size() - 2));
    samples::put_bytes(folder / "b.h5", bytes);
    const hid_t file = H5Fopen((folder / "b.h5").c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
    change(file);
    H5Fclose(file);
    bytes = samples::bytes_of(folder / "b.h5");
    samples::put_bytes(folder / "b.h5", bytes + seal_of(std::as_bytes(std::span(bytes))));
    return differing(folder / "b.h5", image_of(result));
  };
  EXPECT_THAT(forged([](hid_t) {}), IsEmpty());
  EXPECT_THAT(forged([](hid_t file) { H5Adelete(file, "format_version"); }), ElementsAre("/"));
  EXPECT_THAT(forged([](hid_t file) {
                const hid_t dataset = H5Dopen2(file, "entry/scan/detected", H5P_DEFAULT);
                const double values[3] = {0.1, 0.2, 0.3};
                H5Dwrite(dataset, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values);
                H5Dclose(dataset);
              }),
              ElementsAre("/entry/scan/detected"));
  EXPECT_THAT(forged([](hid_t file) {
                const hid_t dataset = H5Dopen2(file, "entry/screen/counts", H5P_DEFAULT);
                H5Adelete(dataset, "units");
                H5Dclose(dataset);
              }),
              ElementsAre("/entry/instrument/screen/data", "/entry/screen/counts"));
  EXPECT_THAT(forged([](hid_t file) { H5Ldelete(file, "entry/fates/where", H5P_DEFAULT); }),
              ElementsAre("/entry/fates/where"));
  EXPECT_THAT(
      forged([](hid_t file) { H5Gclose(H5Gcreate2(file, "more", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT)); }),
      ElementsAre("/more"));
}

TEST(TracksFile, KeepsEveryTrackEvenOfTheSameParticle) {
  const Folder folder;
  const std::vector<Track> tracks = samples::tracks();
  write_tracks({"Bench", {}, {}, tracks}, folder / "t.h5");
  EXPECT_EQ(read(folder / "t.h5", "/entry/particle_7/x").values, tracks[0].x);
  EXPECT_EQ(read(folder / "t.h5", "/entry/particle_11/y").values, tracks[1].y);
  EXPECT_EQ(read(folder / "t.h5", "/entry/particle_7_/sz").values, tracks[2].sz);
}

}  // namespace
}  // namespace rabiline::results_file_test
