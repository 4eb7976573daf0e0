#include "storage/checkpoint_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "samples.hpp"

namespace rabiline::checkpoint_file_test {
namespace {

using samples::Folder;
using testing::HasSubstr;

std::string refusal_of(const std::filesystem::path& path) {
  try {
    read_checkpoint(path);
  } catch (const StorageError& error) {
    return error.what();
  }
  return "";
}

TEST(CheckpointFile, GivesBackWhatWasWritten) {
  const Folder folder;
  const Snapshot written = samples::snapshot(3, 300000);
  write_checkpoint(written, folder / "a.checkpoint");
  EXPECT_TRUE(samples::same(read_checkpoint(folder / "a.checkpoint"), written));
}

TEST(CheckpointFile, GivesBackAnEmptySnapshot) {
  const Folder folder;
  write_checkpoint({}, folder / "a.checkpoint");
  EXPECT_TRUE(samples::same(read_checkpoint(folder / "a.checkpoint"), {}));
}

TEST(CheckpointFile, HoldsALongRowOfSumsOfWhichFewAreNotZero) {
  const Folder folder;
  Snapshot written = samples::snapshot(3, 10);
  written.sums = {std::uint64_t{1} << 33, {5, (std::uint64_t{1} << 33) - 1}, {0, 1}, {7, 8}};
  write_checkpoint(written, folder / "a.checkpoint");
  EXPECT_TRUE(samples::same(read_checkpoint(folder / "a.checkpoint"), written));
}

TEST(CheckpointFile, HasTheSameBytesForTheSameSnapshot) {
  const Folder folder;
  write_checkpoint(samples::snapshot(3, 1000), folder / "a");
  write_checkpoint(samples::snapshot(3, 1000), folder / "b");
  EXPECT_EQ(samples::bytes_of(folder / "a"), samples::bytes_of(folder / "b"));
}

TEST(CheckpointFile, IsNotWrittenWhereItCouldNotBeRead) {
  const Folder folder;
  Snapshot incomplete = samples::snapshot(3, 10);
  incomplete.sums.low.pop_back();
  EXPECT_THROW(write_checkpoint(incomplete, folder / "a"), StorageError);
  Snapshot disordered = samples::snapshot(3, 10);
  disordered.finished = {{5, 9}, {8, 12}};
  EXPECT_THROW(write_checkpoint(disordered, folder / "a"), StorageError);
  disordered.finished = {{5, 5}};
  EXPECT_THROW(write_checkpoint(disordered, folder / "a"), StorageError);
  EXPECT_TRUE(folder.names().empty());
}

TEST(CheckpointFile, SaysThatAMissingFileIsMissing) {
  EXPECT_EQ(refusal_of("/nowhere/a.checkpoint"),
            "/nowhere/a.checkpoint: cannot be read (there is no such file)");
}

TEST(CheckpointFile, NoticesEveryFlippedBit) {
  const Folder folder;
  write_checkpoint(samples::snapshot(3, 50), folder / "a");
  const std::string whole = samples::bytes_of(folder / "a");
  std::mt19937 random(1938);
  for (int trial = 0; trial < 2000; ++trial) {
    std::string flipped = whole;
    flipped[random() % whole.size()] ^= static_cast<char>(1 << random() % 8);
    samples::put_bytes(folder / "b", flipped);
    ASSERT_THAT(refusal_of(folder / "b"), HasSubstr("cannot be read ("));
  }
}

TEST(CheckpointFile, NoticesAFileCutShort) {
  const Folder folder;
  write_checkpoint(samples::snapshot(3, 50), folder / "a");
  const std::string whole = samples::bytes_of(folder / "a");
  for (const std::size_t size : {std::size_t{0}, std::size_t{100}, std::size_t{110}, whole.size() - 1}) {
    samples::put_bytes(folder / "b", whole.substr(0, size));
    EXPECT_THAT(refusal_of(folder / "b"), HasSubstr("no seal of rabiline is at its end")) << size;
  }
}

}  // namespace
}  // namespace rabiline::checkpoint_file_test
