#pragma once
// A checksum against accidents: disks, cables, truncation. It does not stop a forger.
#include <cstddef>
#include <cstdint>
#include <span>

namespace rabiline {

inline constexpr std::uint64_t digest_of_nothing = 0xcbf29ce484222325;

/// FNV-1a, 64 bits (Fowler, Noll, Vo; draft-eastlake-fnv). Any change of a single byte changes it. Pass the
/// digest of what came before to go on with it.
inline std::uint64_t digest(std::span<const std::byte> bytes, std::uint64_t before = digest_of_nothing) {
  constexpr std::uint64_t prime = 0x100000001b3;
  for (const std::byte byte : bytes) before = (before ^ static_cast<std::uint64_t>(byte)) * prime;
  return before;
}

}  // namespace rabiline
