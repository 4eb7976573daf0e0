#include "storage/safe_file.hpp"

#include <dirent.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <fstream>
#include <mutex>
#include <random>
#include <string>
#include <system_error>
#include <vector>

namespace rabiline {
namespace {

using Path = std::filesystem::path;

std::string words_for(int error) { return std::generic_category().message(error); }

std::string_view suggestion_for(int error) {
  switch (error) {
    case ENOSPC:
    case EDQUOT:
      return "free some space or choose another place";
    case EFBIG:
      return "raise the limit on file sizes (ulimit -f) or choose another place";
    case ENAMETOOLONG:
      return "choose a shorter name";
    default:
      return "choose another place";
  }
}

[[noreturn]] void refuse(const Path& path, std::string_view why, std::string_view suggestion) {
  throw StorageError(fmt::format("{}: cannot be written ({}); {}", path.string(), why, suggestion));
}

[[noreturn]] void refuse(const Path& path, int error) {
  refuse(path, words_for(error), suggestion_for(error));
}

Path folder_of(const Path& file) { return file.has_parent_path() ? file.parent_path() : Path("."); }

void require_folder(const Path& path) {
  const Path folder = folder_of(path);
  struct stat status {};
  if (::stat(folder.c_str(), &status) != 0) {
    if (errno != ENOENT) refuse(path, errno);
    refuse(path, fmt::format("the folder {} does not exist", folder.string()),
           fmt::format("create it with: mkdir -p {}", folder.string()));
  }
  if (!S_ISDIR(status.st_mode))
    refuse(path, fmt::format("{} is not a folder", folder.string()), "choose another place");
}

/// Results replace results; an empty file is nobody's.
bool is_none_of_ours(const Path& path, const struct stat& status) {
  constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
  std::ifstream file(path, std::ios::binary);
  std::array<char, signature.size()> head{};
  return status.st_size != 0 && file.is_open() &&
         !(file.read(head.data(), head.size()) && std::ranges::equal(head, signature));
}

/// Refuses what must not be replaced: folders, devices, pipes, write-protected files, and those that are no
/// HDF5.
void require_replaceable(const Path& path) {
  if (path.empty()) refuse("the output", "its name is empty", "name a file");
  if (!path.has_filename())
    refuse(path, "it names a folder", fmt::format("name a file in it, e.g. {}result.h5", path.string()));
  require_folder(path);
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) {
    if (errno != ENOENT) refuse(path, errno);
    return;
  }
  if (S_ISDIR(status.st_mode))
    refuse(path, "it is a folder", fmt::format("name a file in it, e.g. {}", (path / "result.h5").string()));
  if (!S_ISREG(status.st_mode)) refuse(path, "it is not a regular file", "choose another place");
  if (::access(path.c_str(), W_OK) != 0) refuse(path, errno);
  if (is_none_of_ours(path, status))
    refuse(path, "it is there already and is not an HDF5 file, and is not written over",
           "choose another name, or remove it");
}

std::mutex passing_lock;
std::vector<const std::string*> passing;

constexpr std::string_view temporary_begin = ".rabiline-", temporary_end = ".tmp";

/// Makes the rename itself survive a power cut. Some network file systems cannot, and say EINVAL.
void flush_folder_of(const Path& target) {
  const int folder = ::open(folder_of(target).c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  const int error = folder < 0 || ::fsync(folder) != 0 ? errno : 0;
  if (folder >= 0) ::close(folder);
  if (error == 0 || error == EINVAL || error == EACCES) return;
  throw StorageError(fmt::format("{}: was written, but might not survive a power cut ({})", target.string(),
                                 words_for(error)));
}

/// Removes temporary files that nobody writes any more: a process that was killed left them.
void sweep(const Path& folder) {
  constexpr std::time_t old_enough = 3600;  // [s]
  DIR* const entries = ::opendir(folder.c_str());
  if (entries == nullptr) return;
  while (const dirent* entry = ::readdir(entries)) {
    const std::string_view name = entry->d_name;
    if (!name.starts_with(temporary_begin) || !name.ends_with(temporary_end)) continue;
    const int descriptor =
        ::openat(::dirfd(entries), entry->d_name, O_RDONLY | O_CLOEXEC | O_NOFOLLOW | O_NONBLOCK);
    if (descriptor < 0) continue;
    struct stat status {};
    if (::fstat(descriptor, &status) == 0 && status.st_mtime + old_enough < std::time(nullptr) &&
        ::flock(descriptor, LOCK_EX | LOCK_NB) == 0)
      ::unlinkat(::dirfd(entries), entry->d_name, 0);
    ::close(descriptor);
  }
  ::closedir(entries);
}

}  // namespace

Path resolved(const Path& path) {
  std::error_code error;
  Path target = path;
  for (int links = 0; std::filesystem::is_symlink(target, error); ++links) {
    if (links == 40) refuse(path, ELOOP);
    const Path next = std::filesystem::read_symlink(target, error);
    if (error) refuse(path, error.value());
    target = target.parent_path() / next;  // `next` alone where it is absolute
  }
  return target;
}

Path numbered(const Path& path, int number) {
  return path.parent_path() / fmt::format("{}.{}{}", path.stem().string(), number, path.extension().string());
}

Path back_up(const Path& path) {
  const Path target = resolved(path);
  for (int number = 1; std::filesystem::exists(target); ++number) {
    Path second = numbered(target, number);
    std::error_code error;
    std::filesystem::create_hard_link(target, second, error);
    if (!error) return second;
    if (error == std::errc::file_exists) continue;
    std::filesystem::copy_file(target, second, error);  // some file systems have no second names
    if (!error) return second;
    if (error != std::errc::file_exists) refuse(second, error.value());
  }
  return {};
}

PassingFile::PassingFile(const Path& path) : path_(path.string()) {
  const std::lock_guard guard(passing_lock);
  passing.push_back(&path_);
}
PassingFile::~PassingFile() {
  const std::lock_guard guard(passing_lock);
  std::erase(passing, &path_);
}
void PassingFile::remove_all() noexcept {
  const std::lock_guard guard(passing_lock);
  for (const std::string* path : passing) ::unlink(path->c_str());
}

NewFile::NewFile(const Path& path) : target_(resolved(path)) {
  require_replaceable(target_);
  std::random_device random;
  do {
    path_ = folder_of(target_) /
            fmt::format("{}{:08x}{:08x}{}", temporary_begin, random(), random(), temporary_end);
    descriptor_ = ::open(path_.c_str(), O_CREAT | O_EXCL | O_RDWR | O_CLOEXEC, 0666);
  } while (descriptor_ < 0 && (errno == EEXIST || errno == EINTR));
  if (descriptor_ < 0) {
    refuse(target_,
           fmt::format("no file can be created in {}: {}", folder_of(target_).string(), words_for(errno)),
           suggestion_for(errno));
  }
  passing_.emplace(path_);
  ::flock(descriptor_, LOCK_EX | LOCK_NB);  // where there are no locks, age alone tells
}

NewFile::~NewFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (passing_) ::unlink(path_.c_str());
}

void NewFile::append(std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(descriptor_, bytes.data(), bytes.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) refuse(target_, errno);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
}

int NewFile::put(std::size_t offset, std::span<const std::byte> bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t written = ::pwrite(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    offset += static_cast<std::size_t>(written);
    bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

void NewFile::get(std::size_t offset, std::span<std::byte> bytes) const noexcept {
  std::ranges::fill(bytes, std::byte{0});
  while (!bytes.empty()) {
    const ssize_t read = ::pread(descriptor_, bytes.data(), bytes.size(), static_cast<off_t>(offset));
    if (read < 0 && errno == EINTR) continue;
    if (read <= 0) return;
    offset += static_cast<std::size_t>(read);
    bytes = bytes.subspan(static_cast<std::size_t>(read));
  }
}

void NewFile::cut(std::size_t size) {
  if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0 || ::lseek(descriptor_, 0, SEEK_END) < 0)
    refuse(target_, errno);
}

void NewFile::refuse_for(int error) const { refuse(target_, error); }

void NewFile::finish() {
  keep_mode_of_target();
  if (::fsync(descriptor_) != 0) refuse(target_, errno);
  ::posix_fadvise(descriptor_, 0, 0, POSIX_FADV_DONTNEED);
  const int closed = ::close(descriptor_);
  descriptor_ = -1;
  if (closed != 0) refuse(target_, errno);
}

void NewFile::become_target(const std::function<void(const Path& temporary)>& verify) {
  finish();
  verify(path_);
  if (::rename(path_.c_str(), target_.c_str()) != 0) refuse(target_, errno);
  passing_.reset();
  flush_folder_of(target_);
}

void NewFile::keep_mode_of_target() {
  struct stat status {};
  if (::stat(target_.c_str(), &status) != 0) return;
  if (::fchmod(descriptor_, status.st_mode & 07777) != 0) refuse(target_, errno);
}

void require_writable(const Path& path) {
  const Path target = resolved(path);
  require_replaceable(target);
  sweep(folder_of(target));
  NewFile probe(target);
  // A full disk still creates empty files, so the probe holds a page.
  probe.append(std::array<std::byte, 4096>{});
  probe.finish();
}

void replace_file(const Path& path, std::span<const std::byte> content,
                  const std::function<void(const Path& temporary)>& verify) {
  NewFile file(path);
  file.append(content);
  file.become_target(verify);
}

}  // namespace rabiline
