#pragma once
// Files that are at every moment either what they were before or wholly the new one, even through kill -9.
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include "storage/storage_error.hpp"

namespace rabiline {

/// Called before a run: throws StorageError if no file could be written there. Leaves what is there
/// untouched, but for temporary files of processes that died an hour ago or earlier.
void require_writable(const std::filesystem::path&);

/// Where the bytes go: links are followed, so that they stay links, even to what is not there yet.
std::filesystem::path resolved(const std::filesystem::path&);

/// result.3.h5 for result.h5, in the same folder.
std::filesystem::path numbered(const std::filesystem::path&, int number);
/// Gives what is there a second name, result.1.h5 for result.h5, or the first number that is free. Empty
/// where nothing is there.
std::filesystem::path back_up(const std::filesystem::path&);

/// A file that is there for as long as something is under way.
class PassingFile {
 public:
  explicit PassingFile(const std::filesystem::path&);
  PassingFile(const PassingFile&) = delete;
  PassingFile& operator=(const PassingFile&) = delete;
  ~PassingFile();

  /// Where the process ends at once, from any thread.
  static void remove_all() noexcept;

 private:
  std::string path_;
};

/// A new file beside `target`, removed again unless it becomes the target; locked while it is written. Throws
/// StorageError; what was there is then intact.
class NewFile {
 public:
  explicit NewFile(const std::filesystem::path& target);
  NewFile(const NewFile&) = delete;
  NewFile& operator=(const NewFile&) = delete;
  ~NewFile();

  const std::filesystem::path& path() const { return path_; }
  void append(std::span<const std::byte>);
  /// At any place; returns what went wrong as `errno` has it, or 0.
  int put(std::size_t offset, std::span<const std::byte>) noexcept;
  /// Zeros where nothing is.
  void get(std::size_t offset, std::span<std::byte>) const noexcept;
  /// It ends there, and is appended to there.
  void cut(std::size_t size);
  [[noreturn]] void refuse_for(int error) const;

  /// Brings everything to the disk and forgets the cached pages, so that reading back asks the disk.
  void finish();
  /// Finishes it, lets `verify` read it back and throw where it finds a fault, and only then renames it.
  void become_target(const std::function<void(const std::filesystem::path& temporary)>& verify);

 private:
  void keep_mode_of_target();

  std::filesystem::path target_, path_;
  std::optional<PassingFile> passing_{};
  int descriptor_ = -1;
};

/// Writes a new file beside `target`, lets `verify` read it back from the disk and throw where it finds
/// a fault, and only then renames it to `target`. Throws StorageError; the earlier file is then intact.
void replace_file(const std::filesystem::path& target, std::span<const std::byte> content,
                  const std::function<void(const std::filesystem::path& temporary)>& verify);

}  // namespace rabiline
