#include "storage/lock.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <string>
#include <system_error>

#include "storage/safe_file.hpp"

namespace rabiline {
namespace {

/// Whether the name still is that of the open file: its last owner may have removed it.
bool is_name_of(const std::filesystem::path& path, int descriptor) {
  struct stat named {
  }, open{};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(descriptor, &open) == 0 &&
         named.st_ino == open.st_ino && named.st_dev == open.st_dev;
}

std::string owner_in(int descriptor) {
  std::array<char, 300> text{};
  const ssize_t size = ::pread(descriptor, text.data(), text.size(), 0);
  return size > 0 ? std::string(text.data(), static_cast<std::size_t>(size)) : "another process";
}

}  // namespace

Lock::Lock(const std::filesystem::path& output) {
  const std::filesystem::path target = resolved(output);
  path_ = target.parent_path() / fmt::format(".{}.lock", target.filename().string());
  for (;;) {
    constexpr int ours_alone = O_NOFOLLOW | O_CLOEXEC;
    descriptor_ = ::open(path_.c_str(), O_RDWR | O_CREAT | ours_alone, 0666);
    if (descriptor_ < 0 && errno == EACCES) descriptor_ = ::open(path_.c_str(), O_RDONLY | ours_alone);
    if (descriptor_ < 0 && (errno == EACCES || errno == EISDIR || errno == ELOOP))
      throw StorageError(fmt::format(
          "{}: cannot be locked, since {} is in the way ({})\n  help: remove that, or write to another file",
          output.string(), path_.string(), std::generic_category().message(errno)));
    if (descriptor_ < 0) return;  // whoever writes the output tells why
    if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
      const std::string owner = owner_in(descriptor_);
      ::close(descriptor_);
      throw StorageError(
          fmt::format("{}: is being written by {}\n  help: let it finish, or write to another file",
                      output.string(), owner));
    }
    if (is_name_of(path_, descriptor_)) break;
    ::close(descriptor_);
  }
  passing_.emplace(path_);
  std::array<char, 256> host{};
  ::gethostname(host.data(), host.size() - 1);
  const std::string owner = fmt::format("process {} on {}", ::getpid(), host.data());
  // What is written here only makes the message of others better.
  if (::ftruncate(descriptor_, 0) != 0 || ::write(descriptor_, owner.data(), owner.size()) < 0) return;
}

Lock::~Lock() {
  if (descriptor_ < 0) return;
  ::unlink(path_.c_str());
  ::close(descriptor_);
}

}  // namespace rabiline
