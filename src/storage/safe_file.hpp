#pragma once
// Files that are at every moment either what they were before or wholly the new one, even through kill -9.
#include <cstddef>
#include <filesystem>
#include <functional>
#include <span>

#include "storage/storage_error.hpp"

namespace rabiline {

/// Called before a run: throws StorageError if no file could be written there. Leaves what is there
/// untouched.
void require_writable(const std::filesystem::path&);

/// Writes a temporary file beside `target`, lets `verify` read it back from the disk and throw where it finds
/// a fault, and only then renames it to `target`. Throws StorageError; the earlier file is then intact.
void replace_file(const std::filesystem::path& target, std::span<const std::byte> content,
                  const std::function<void(const std::filesystem::path& temporary)>& verify);

}  // namespace rabiline
