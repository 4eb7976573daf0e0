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
};

}  // namespace rabiline
