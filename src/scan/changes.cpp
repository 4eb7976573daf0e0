#include "scan/changes.hpp"

#include <algorithm>
#include <stdexcept>

namespace rabiline {
namespace {

std::string name_in(const std::string& setting) { return setting.substr(0, setting.find('=')); }

/// Whether a scan, whose names stand before its `=` with commas between, takes a parameter.
bool takes(const std::string& scan, const std::string& name) {
  return ("," + name_in(scan) + ",").find("," + name + ",") != std::string::npos;
}

}  // namespace

std::vector<std::string> options_of(const Changes& changes) {
  std::vector<std::string> options;
  const auto add = [&](const char* option, const std::string& value) {
    options.insert(options.end(), {option, value});
  };
  for (const std::string& change : changes.set) add("--set", change);
  for (const std::string& scan : changes.scan) add("--scan", scan);
  if (changes.without_scan) options.emplace_back("--no-scan");
  if (changes.particles) add("--particles", *changes.particles);
  if (changes.seed) add("--seed", *changes.seed);
  return options;
}

Changes changes_of(const std::vector<std::string>& options) {
  Changes changes;
  for (std::size_t i = 0; i < options.size(); ++i) {
    if (options[i] == "--no-scan") {
      changes.without_scan = true;
      continue;
    }
    if (i + 1 == options.size()) throw std::invalid_argument("an option lacks its value");
    const std::string& option = options[i];
    const std::string& value = options[++i];
    if (option == "--set")
      changes.set.push_back(value);
    else if (option == "--scan")
      changes.scan.push_back(value);
    else if (option == "--particles")
      changes.particles = value;
    else if (option == "--seed")
      changes.seed = value;
    else
      throw std::invalid_argument("there is no option " + option);
  }
  return changes;
}

Changes joined(Changes earlier, const Changes& later) {
  const auto gives = [&](const std::string& name) {
    return std::any_of(later.set.begin(), later.set.end(),
                       [&](const auto& s) { return name_in(s) == name; }) ||
           std::any_of(later.scan.begin(), later.scan.end(), [&](const auto& s) { return takes(s, name); });
  };
  std::erase_if(earlier.set, [&](const std::string& before) {
    const std::string name = name_in(before);
    return (name == "particles" && later.particles) || (name == "seed" && later.seed) || gives(name);
  });
  earlier.set.insert(earlier.set.end(), later.set.begin(), later.set.end());
  earlier.scan = later.scan;
  if (later.particles || gives("particles")) earlier.particles = later.particles;
  if (later.seed || gives("seed")) earlier.seed = later.seed;
  earlier.without_scan = later.without_scan || !later.scan.empty();
  return earlier;
}

}  // namespace rabiline
