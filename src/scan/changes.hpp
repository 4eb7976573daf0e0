#pragma once
// What is changed in a file for one time, as on the command line.
#include <optional>
#include <string>
#include <vector>

namespace rabiline {

struct Changes {
  std::vector<std::string> set{};   // "B.field=9 mT"
  std::vector<std::string> scan{};  // "H0.frequency=280 kHz:300 kHz:21" or "law=quantum,dorado"
  std::optional<std::string> particles{}, seed{};  // "1e6"
  bool without_scan = false;                       // the file's scan is omitted
  std::string dashes =
      "--";  // before `set` and `scan` where a mistake stands in one; none for a caller without options
};

/// As options of the command line, "--set", "B.field=9 mT", and back. Throws std::invalid_argument.
std::vector<std::string> options_of(const Changes&);
Changes changes_of(const std::vector<std::string>& options);
/// What was changed before, and then `later`; a scan in it replaces every other, that of the file too.
Changes joined(Changes earlier, const Changes& later);

}  // namespace rabiline
