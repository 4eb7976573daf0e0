// Results that go into their file slab by slab, against the same results in one piece.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <cstdlib>

#include "forked.hpp"
#include "samples.hpp"
#include "storage/contents.hpp"
#include "storage/disk_file.hpp"
#include "storage/origin.hpp"
#include "storage/results_file.hpp"

namespace rabiline::slab_file_test {
namespace {

using samples::Folder;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// Points [begin, end) of a row.
template <class T>
void cut(std::vector<T>& numbers, std::size_t points, std::size_t begin, std::size_t end) {
  const std::size_t each = numbers.size() / points;
  numbers = {numbers.begin() + static_cast<std::ptrdiff_t>(begin * each),
             numbers.begin() + static_cast<std::ptrdiff_t>(end * each)};
}

/// Two detectors, a monitor of two planes with a tally, and a ledger over levels; no covariances, which slabs
/// have not.
Result whole(std::vector<ScanAxis> axes) {
  Result made = samples::result(std::move(axes), {"left", "right"});
  const std::size_t points = made.emitted.size();
  for (DetectorResult& detector : made.detectors) detector.detected_covariance.clear();
  auto numbers = [next = 0.5](std::size_t count) mutable {
    std::vector<double> out;
    while (out.size() < count) out.push_back(next += 1);
    return out;
  };
  made.monitors = {
      {"M", "M", 0.5, numbers(2 * points), numbers(2 * points), {}, std::vector<double>{0.5, 0.6}}};
  TallyAxisResult spin{"spin", Dimension::number, {-1, 0, 1}, {}, {1, 0, 0}, {}, {}, {}, {}};
  for (auto column : {&TallyAxisResult::mean, &TallyAxisResult::mean_errors, &TallyAxisResult::deviation,
                      &TallyAxisResult::deviation_errors})
    spin.*column = numbers(points);
  made.tallies = {{"M",
                   "M",
                   "t",
                   true,
                   true,
                   {spin},
                   numbers(2 * points),
                   numbers(2 * points),
                   numbers(points),
                   numbers(points)}};
  made.ledger_levels = {"up", "down", "else"};
  made.emitted_by_level = numbers(3 * points);
  for (FateResult& line : made.fates) line.by_level = numbers(3 * points);
  return made;
}

Result slab_of(Result result, std::size_t begin, std::size_t end) {
  const std::size_t points = result.emitted.size();
  const auto cut_all = [&](auto&... columns) { (cut(columns, points, begin, end), ...); };
  cut_all(result.aimed_fraction, result.emitted, result.emitted_quanta_high, result.emitted_quanta_low,
          result.emitted_by_level);
  for (DetectorResult& d : result.detectors)
    cut_all(d.offset_x, d.offset_z, d.counts, d.counts_errors, d.counts_x, d.counts_x_errors, d.counts_z,
            d.counts_z_errors, d.detected, d.detected_errors, d.detected_of_all, d.detected_of_all_errors,
            d.levels, d.levels_errors, d.count_rate, d.count_rate_errors);
  for (MonitorResult& m : result.monitors) cut_all(m.passed, m.passed_errors);
  for (TallyResult& t : result.tallies) {
    cut_all(t.counts, t.counts_errors, t.outside, t.outside_errors);
    for (TallyAxisResult& a : t.axes) cut_all(a.mean, a.mean_errors, a.deviation, a.deviation_errors);
  }
  for (FateResult& f : result.fates) cut_all(f.quanta_high, f.quanta_low, f.particles, f.by_level);
  return result;
}

void write_in_slabs(const Result& result, const std::filesystem::path& path, std::size_t each) {
  const std::size_t points = result.emitted.size();
  ResultsFile file(path);
  for (std::size_t begin = 0; begin < points; begin += each)
    file.add(slab_of(result, begin, std::min(begin + each, points)));
  file.save(result);
}

TEST(SlabFile, HasTheBitsOfTheResultInOnePieceWhereverItIsCut) {
  const Folder folder;
  ScanAxis deep = samples::field_axis(4);
  deep.parameter = "C.field";
  for (const std::vector<ScanAxis>& axes : {std::vector{samples::frequency_axis(23)},
                                            {samples::frequency_axis(5), samples::field_axis(3)},
                                            {samples::frequency_axis(3), samples::field_axis(2), deep}}) {
    const Result result = whole(axes);
    const std::size_t points = result.emitted.size();
    for (const std::size_t each :
         {std::size_t{1}, std::size_t{3}, std::size_t{5}, std::size_t{7}, points - 1}) {
      write_in_slabs(result, folder / "a.h5", each);
      EXPECT_THAT(differing(folder / "a.h5", image_of(result)), IsEmpty()) << each << " of " << points;
      EXPECT_EQ(verified_digest(folder / "a.h5").size(), 64U);
      EXPECT_THAT(folder.names(), ElementsAre("a.h5"));
    }
  }
}

TEST(SlabFile, HasChunksThatSeveralSlabsFill) {
  const Folder folder;
  const Result result = whole({samples::frequency_axis(150'000)});
  write_in_slabs(result, folder / "a.h5", 40'000);
  EXPECT_THAT(differing(folder / "a.h5", image_of(result)), IsEmpty());
  write_results(result, folder / "b.h5");
  const auto size = [&](const char* name) { return static_cast<double>(file_size(folder / name)); };
  EXPECT_NEAR(size("a.h5") / size("b.h5"), 1, 1e-3);  // no chunk was packed twice
}

TEST(SlabFile, HasTextsThatDifferFromSlabToSlab) {
  const Folder folder;
  Result result = whole({samples::frequency_axis(6)});
  result.laws[4] = "quantum, at greater length than all others are";
  write_in_slabs(result, folder / "a.h5", 4);
  EXPECT_THAT(differing(folder / "a.h5", image_of(result)), IsEmpty());
  Result agreeing = whole({samples::frequency_axis(6)});
  write_in_slabs(agreeing, folder / "a.h5", 4);
  agreeing.laws.resize(1);
  EXPECT_THAT(differing(folder / "a.h5", image_of(agreeing)), IsEmpty());
}

/// To the very end of the process: there HDF5 closes what is open.
TEST(SlabFile, KeepsAnEarlierFileWhenTheDiskFillsUpBetweenSlabs) {
  const Folder folder;
  write_results(whole({samples::frequency_axis(5)}), folder / "a.h5");
  const std::string earlier = samples::bytes_of(folder / "a.h5");
  const Result result = whole({samples::frequency_axis(40'000)});
  for (const rlim_t most : {1'000UL, 10'000UL, 100'000UL, 300'000UL, 1'000'000UL}) {
    const auto write = [&] {
      std::signal(SIGXFSZ, SIG_IGN);
      const rlimit limit{most, most};
      ::setrlimit(RLIMIT_FSIZE, &limit);
      try {
        write_in_slabs(result, folder / "a.h5", 12'000);
      } catch (const StorageError& error) {
        std::exit(std::string(error.what()).find("a.h5: cannot be written (File too large)") ==
                  std::string::npos);
      }
      std::exit(2);
    };
    EXPECT_EXIT(write(), testing::ExitedWithCode(0), "") << most;
    EXPECT_TRUE(samples::bytes_of(folder / "a.h5") == earlier);
    EXPECT_THAT(folder.names(), ElementsAre("a.h5"));
  }
}

TEST(SlabFile, IsNotThereUntilItIsSaved) {
  const Folder folder;
  const Result result = whole({samples::frequency_axis(6)});
  {
    ResultsFile file(folder / "a.h5");
    file.add(slab_of(result, 0, 4));
    EXPECT_FALSE(exists(folder / "a.h5"));
  }
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(DiskFile, ReadsBackWhatItCouldNotWrite) {
  const Folder folder;
  EXPECT_EQ(failure_in_child([&] {
              std::signal(SIGXFSZ, SIG_IGN);
              const rlimit limit{100, 100};
              ::setrlimit(RLIMIT_FSIZE, &limit);
              hdf5::DiskFile file(folder / "a.h5");
              const auto put = [&](std::size_t at, std::size_t size, char c) {
                file.write(at, std::vector(size, std::byte(c)));
              };
              put(0, 60, 'a');
              file.require_written();
              put(90, 20, 'b');  // ten of them go
              put(50, 20, 'c');
              put(105, 10, 'd');
              std::string bytes(120, '?');
              file.read(0, std::as_writable_bytes(std::span(bytes)));
              if (bytes != std::string(50, 'a') + std::string(20, 'c') + std::string(20, '\0') +
                               std::string(15, 'b') + std::string(10, 'd') + std::string(5, '\0'))
                throw std::runtime_error("other bytes");
              try {
                file.require_written();
              } catch (const StorageError&) {
                return;
              }
              throw std::runtime_error("nothing was told");
            }),
            "");
  EXPECT_THAT(folder.names(), IsEmpty());
}

}  // namespace
}  // namespace rabiline::slab_file_test
