#pragma once
// The text of a file that a user names, which may be a pipe or a device just as well.
#include <filesystem>
#include <optional>
#include <string>

namespace rabiline {

/// Why a file cannot be read, and what helps.
struct FileProblem {
  std::string what, help;
};
/// Of one that is not there, or is a folder; a map is a file on a disk, no pipe and no device.
std::optional<FileProblem> problem_of(const std::filesystem::path&, bool on_a_disk = false);

struct TextFile {
  std::string text;           // one byte more than is allowed where there is more
  std::string problem, help;  // why it cannot be read; empty where it can
};
/// Waits five seconds for a pipe that nobody writes to, then gives up.
TextFile read_text_file(const std::filesystem::path&);

}  // namespace rabiline
