#pragma once
// Files that are at every moment either what they were before or wholly the new one, even through kill -9.
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "storage/storage_error.hpp"

namespace rabiline {

/// Called before a run: throws StorageError if no file could be written there. Leaves what is there
/// untouched, but for temporary files of processes that died an hour ago or earlier.
void require_writable(const std::filesystem::path&);

/// Where the bytes go: links are followed, so that they stay links, even to what is not there yet.
std::filesystem::path resolved(const std::filesystem::path&);

/// Gives what is there a second name, result.1.h5 for result.h5, or the first number that is free. Empty
/// where nothing is there.
std::filesystem::path back_up(const std::filesystem::path&);

/// Writes a temporary file beside `target`, lets `verify` read it back from the disk and throw where it finds
/// a fault, and only then renames it to `target`. Throws StorageError; the earlier file is then intact.
void replace_file(const std::filesystem::path& target, std::span<const std::byte> content,
                  const std::function<void(const std::filesystem::path& temporary)>& verify);

}  // namespace rabiline
