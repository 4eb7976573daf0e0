#pragma once
// The text of a file that a user names, which may be a pipe or a device just as well.
#include <filesystem>
#include <string>

namespace rabiline {

struct TextFile {
  std::string text;           // one byte more than is allowed where there is more
  std::string problem, help;  // why it cannot be read; empty where it can
};
/// Waits five seconds for a pipe that nobody writes to, then gives up.
TextFile read_text_file(const std::filesystem::path&);

}  // namespace rabiline
