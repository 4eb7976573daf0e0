#include "storage/safe_file.hpp"

#include "samples.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/file.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/stat.h>

#include <chrono>
#include <csignal>
#include <random>
#include <thread>

#include "forked.hpp"
#include "storage/lock.hpp"

namespace rabiline::safe_file_test {
namespace {

using samples::bytes_of;
using samples::Folder;
using samples::put_bytes;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Path = std::filesystem::path;

/// What begins as such files do.
std::string hdf5(const std::string& rest) { return "\x89HDF\r\n\x1a\n" + rest; }

std::string refusal_of(const Path& path) {
  try {
    require_writable(path);
  } catch (const StorageError& error) {
    return error.what();
  }
  return "";
}

void replace(const Path& path, const std::string& bytes) {
  replace_file(path, std::as_bytes(std::span(bytes)), [](const Path&) {});
}

TEST(RequireWritable, AcceptsANewFileAndLeavesNothingBehind) {
  const Folder folder;
  EXPECT_EQ(refusal_of(folder / "result.h5"), "");
  EXPECT_THAT(folder.names(), IsEmpty());
}

TEST(RequireWritable, LeavesAnEarlierFileAlone) {
  const Folder folder;
  put_bytes(folder / "result.h5", hdf5("earlier"));
  EXPECT_EQ(refusal_of(folder / "result.h5"), "");
  EXPECT_EQ(bytes_of(folder / "result.h5"), hdf5("earlier"));
}

TEST(RequireWritable, RefusesAFileThatIsNoHdf5UnlessItIsEmpty) {
  const Folder folder;
  put_bytes(folder / "mine.yaml", "rabiline: 1");
  EXPECT_THAT(refusal_of(folder / "mine.yaml"), HasSubstr("and is not written over"));
  EXPECT_THROW(replace(folder / "mine.yaml", hdf5("new")), StorageError);
  EXPECT_EQ(bytes_of(folder / "mine.yaml"), "rabiline: 1");
  put_bytes(folder / "empty.h5", "");
  EXPECT_EQ(refusal_of(folder / "empty.h5"), "");
}

TEST(RequireWritable, AcceptsAFileInTheCurrentFolder) {
  const Folder folder;
  EXPECT_EQ(failure_in_child([&] {
              std::filesystem::current_path(folder.path());
              require_writable("result.h5");
            }),
            "");
}

TEST(RequireWritable, SaysHowToMakeAMissingFolder) {
  const Folder folder;
  const std::string missing = (folder / "missing").string();
  EXPECT_EQ(refusal_of(missing + "/result.h5"), missing + "/result.h5: cannot be written (the folder " +
                                                    missing + " does not exist); create it with: mkdir -p " +
                                                    missing);
}

TEST(RequireWritable, RefusesAFolderAndNamesAFileInIt) {
  const Folder folder;
  const std::string path = folder.path().string();
  EXPECT_EQ(refusal_of(path),
            path + ": cannot be written (it is a folder); name a file in it, e.g. " + path + "/result.h5");
  EXPECT_EQ(
      refusal_of(path + "/"),
      path + "/: cannot be written (it names a folder); name a file in it, e.g. " + path + "/result.h5");
}

TEST(RequireWritable, RefusesWhatIsNoPlaceForAFile) {
  const Folder folder;
  put_bytes(folder / "file", "");
  EXPECT_THAT(refusal_of(""), HasSubstr("its name is empty"));
  EXPECT_THAT(refusal_of("/proc/result.h5"), HasSubstr("no file can be created in /proc"));
  EXPECT_THAT(refusal_of("/dev/full"), HasSubstr("it is not a regular file"));
  EXPECT_THAT(refusal_of("/dev/null"), HasSubstr("it is not a regular file"));
  EXPECT_THAT(refusal_of(folder / "file/result.h5"), HasSubstr("file is not a folder"));
  EXPECT_THAT(refusal_of(folder / std::string(300, 'a')), HasSubstr("File name too long"));
}

/// Becomes a user without rights, if it is root.
void drop_rights() {
  constexpr unsigned nobody = 65534;
  if (::geteuid() == 0 && (::setgid(nobody) != 0 || ::setuid(nobody) != 0))
    throw std::runtime_error("still root");
}

TEST(RequireWritable, RefusesAFolderWithoutPermission) {
  const Folder folder;
  ::chmod(folder.path().c_str(), 0555);
  EXPECT_THAT(failure_in_child([&] {
                drop_rights();
                require_writable(folder / "result.h5");
              }),
              HasSubstr("Permission denied); choose another place"));
}

TEST(RequireWritable, RefusesAWriteProtectedFile) {
  const Folder folder;
  ::chmod(folder.path().c_str(), 0777);
  put_bytes(folder / "result.h5", hdf5("earlier"));
  ::chmod((folder / "result.h5").c_str(), 0444);
  EXPECT_THAT(failure_in_child([&] {
                drop_rights();
                require_writable(folder / "result.h5");
              }),
              HasSubstr("result.h5: cannot be written (Permission denied)"));
}

TEST(RequireWritable, NoticesAFullDiskBeforeTheRun) {
  const Folder folder;
  const std::string failure = failure_in_child([&] {
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=4k") != 0) {
      throw std::runtime_error("no tmpfs");
    }
    put_bytes(folder / "other", std::string(4096, 'a'));
    require_writable(folder / "result.h5");
  });
  if (failure == "no tmpfs") GTEST_SKIP() << "mounting is not allowed here";
  EXPECT_THAT(
      failure,
      HasSubstr("cannot be written (No space left on device); free some space or choose another place"));
}

TEST(ReplaceFile, ReplacesTheWholeFileAndKeepsItsMode) {
  const Folder folder;
  put_bytes(folder / "result.h5", hdf5("an earlier and longer file"));
  ::chmod((folder / "result.h5").c_str(), 0640);
  replace(folder / "result.h5", hdf5("new"));
  EXPECT_EQ(bytes_of(folder / "result.h5"), hdf5("new"));
  EXPECT_THAT(folder.names(), ElementsAre("result.h5"));
  struct stat status {};
  ASSERT_EQ(::stat((folder / "result.h5").c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777, 0640u);
}

TEST(ReplaceFile, FollowsALinkThatStaysALink) {
  const Folder folder;
  put_bytes(folder / "there.h5", hdf5("earlier"));
  std::filesystem::create_symlink("there.h5", folder / "here.h5");
  replace(folder / "here.h5", hdf5("new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "here.h5"));
  EXPECT_EQ(bytes_of(folder / "there.h5"), hdf5("new"));
}

TEST(ReplaceFile, FollowsALinkToWhatIsNotThereYet) {
  const Folder folder;
  std::filesystem::create_symlink("there.h5", folder / "here.h5");
  replace(folder / "here.h5", hdf5("new"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "here.h5"));
  EXPECT_EQ(bytes_of(folder / "there.h5"), hdf5("new"));
}

TEST(RequireWritable, SweepsOldTemporaryFilesThatNobodyWrites) {
  using namespace std::chrono_literals;
  const Folder folder;
  for (const std::string name :
       {".rabiline-old.tmp", ".rabiline-new.tmp", ".rabiline-locked.tmp", "other.tmp"}) {
    put_bytes(folder / name, "left");
    if (name != ".rabiline-new.tmp")
      std::filesystem::last_write_time(folder / name, std::filesystem::file_time_type::clock::now() - 2h);
  }
  const int locked = ::open((folder / ".rabiline-locked.tmp").c_str(), O_RDONLY);
  ASSERT_EQ(::flock(locked, LOCK_EX), 0);
  require_writable(folder / "result.h5");
  ::close(locked);
  EXPECT_THAT(folder.names(), ElementsAre(".rabiline-locked.tmp", ".rabiline-new.tmp", "other.tmp"));
}

TEST(BackUp, GivesTheFirstFreeNameAndLeavesTheFile) {
  const Folder folder;
  EXPECT_EQ(back_up(folder / "result.h5"), "");
  put_bytes(folder / "result.h5", hdf5("one"));
  EXPECT_EQ(back_up(folder / "result.h5"), folder / "result.1.h5");
  replace(folder / "result.h5", hdf5("two"));
  EXPECT_EQ(back_up(folder / "result.h5"), folder / "result.2.h5");
  EXPECT_EQ(bytes_of(folder / "result.1.h5"), hdf5("one"));
  EXPECT_EQ(bytes_of(folder / "result.2.h5"), hdf5("two"));
  EXPECT_EQ(bytes_of(folder / "result.h5"), hdf5("two"));
}

TEST(Lock, KeepsAnotherProcessFromTheSameOutputAndLeavesNothing) {
  const Folder folder;
  std::filesystem::create_symlink("there.h5", folder / "here.h5");
  const auto refusal = [&] { return failure_in_child([&] { const Lock lock(folder / "here.h5"); }); };
  {
    const Lock lock(folder / "there.h5");
    EXPECT_THAT(refusal(), HasSubstr(fmt::format("is being written by process {} on ", ::getpid())));
  }
  EXPECT_EQ(refusal(), "");
  EXPECT_THAT(folder.names(), ElementsAre("here.h5"));
}

TEST(Lock, IsNotPassedOverWhereSomethingIsInItsWayWhichStaysAsItIs) {
  const Folder folder;
  put_bytes(folder / "precious", "text");
  std::filesystem::create_symlink("precious", folder / ".linked.h5.lock");
  std::filesystem::create_directory(folder / ".folder.h5.lock");
  for (const char* name : {"linked.h5", "folder.h5"})
    EXPECT_THAT(failure_in_child([&] { const Lock lock(folder / name); }),
                HasSubstr(fmt::format(".{}.lock is in the way", name)));
  EXPECT_EQ(bytes_of(folder / "precious"), "text");
}

TEST(ReplaceFile, KeepsTheEarlierFileWhenVerificationFails) {
  const Folder folder;
  put_bytes(folder / "result.h5", hdf5("earlier"));
  std::string seen;
  const auto refuse = [&](const Path& temporary) {
    seen = bytes_of(temporary);
    throw StorageError("does not read back");
  };
  const std::string bytes = hdf5("new");
  EXPECT_THROW(replace_file(folder / "result.h5", std::as_bytes(std::span(bytes)), refuse), StorageError);
  EXPECT_EQ(seen, hdf5("new"));
  EXPECT_EQ(bytes_of(folder / "result.h5"), hdf5("earlier"));
  EXPECT_THAT(folder.names(), ElementsAre("result.h5"));
}

TEST(ReplaceFile, KeepsTheEarlierFileWhenAFileMayNotGrow) {
  const Folder folder;
  put_bytes(folder / "result.h5", hdf5("earlier"));
  EXPECT_THAT(failure_in_child([&] {
                std::signal(SIGXFSZ, SIG_IGN);
                const rlimit limit{10000, 10000};
                ::setrlimit(RLIMIT_FSIZE, &limit);
                replace(folder / "result.h5", std::string(20000, 'a'));
              }),
              HasSubstr("result.h5: cannot be written (File too large)"));
  EXPECT_EQ(bytes_of(folder / "result.h5"), hdf5("earlier"));
  EXPECT_THAT(folder.names(), ElementsAre("result.h5"));
}

TEST(ReplaceFile, KeepsTheEarlierFileWhenTheDiskFillsUp) {
  const Folder folder;
  const std::string failure = failure_in_child([&] {
    if (::unshare(CLONE_NEWNS) != 0 || ::mount("tmpfs", folder.path().c_str(), "tmpfs", 0, "size=64k") != 0) {
      throw std::runtime_error("no tmpfs");
    }
    put_bytes(folder / "result.h5", hdf5("earlier"));
    std::string message = "nothing failed";
    try {
      replace(folder / "result.h5", std::string(100000, 'a'));
    } catch (const StorageError& error) {
      message = error.what();
    }
    if (bytes_of(folder / "result.h5") != hdf5("earlier")) message = "the earlier file is gone";
    if (folder.names().size() != 1) message = "a temporary file stays";
    throw std::runtime_error(message);
  });
  if (failure == "no tmpfs") GTEST_SKIP() << "mounting is not allowed here";
  EXPECT_THAT(
      failure,
      HasSubstr("cannot be written (No space left on device); free some space or choose another place"));
}

void remove_all_but(const Folder& folder, const std::string& kept) {
  for (const std::string& name : folder.names()) {
    if (name != kept) std::filesystem::remove(folder / name);
  }
}

// The content is large, so that most kills fall into the write itself.
TEST(ReplaceFile, LeavesOneWholeFileWhenKilledAtAnyMoment) {
  const Folder folder;
  const std::string one = hdf5(std::string(16 << 20, '1')), other = hdf5(std::string(16 << 20, '2'));
  put_bytes(folder / "result.h5", one);
  std::mt19937 random(1938);
  for (int trial = 0; trial < 20; ++trial) {
    const pid_t child = ::fork();
    if (child == 0) {
      for (int number = 0;; ++number) replace(folder / "result.h5", number % 2 == 0 ? other : one);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 60));
    ::kill(child, SIGKILL);
    ::waitpid(child, nullptr, 0);
    const std::string read = bytes_of(folder / "result.h5");
    ASSERT_TRUE(read == one || read == other) << trial;
    remove_all_but(folder, "result.h5");
  }
}

TEST(ReplaceFile, LeavesTheEarlierFileWhenKilledJustBeforeTheRename) {
  const Folder folder;
  put_bytes(folder / "result.h5", hdf5("earlier"));
  EXPECT_EQ(failure_in_child([&] {
              const std::string bytes = hdf5("new");
              replace_file(folder / "result.h5", std::as_bytes(std::span(bytes)),
                           [](const Path&) { ::kill(::getpid(), SIGKILL); });
            }),
            "the child died");
  EXPECT_EQ(bytes_of(folder / "result.h5"), hdf5("earlier"));
}

}  // namespace
}  // namespace rabiline::safe_file_test
