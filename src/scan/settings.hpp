#pragma once
// What the command line changes in a file, and how everything that is wrong is told at once.
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "input/document.hpp"
#include "input/values.hpp"
#include "scan/changes.hpp"
#include "scan/scan.hpp"

namespace rabiline {

/// A whole number of the command line, read as the file reads one. Throws InputError.
std::uint64_t read_argument(const std::string& option, const std::string& text, const Range&);

/// A time of the command line, such as `10 h`, likewise [s].
double read_time_argument(const std::string& option, const std::string& text, const Range&);

/// A size of memory, such as `2 GiB` [bytes].
std::uint64_t read_memory_argument(const std::string& option, const std::string& text);

using Sources = std::vector<std::shared_ptr<const SourceText>>;

/// One NAME=VALUE of the command line; without a name where it could not be read.
struct Setting {
  std::string name{};
  Place place{};
  Node value{};
};

/// The settings of the command line, --particles and --seed among them.
std::vector<Setting> read_settings(const Changes&, Sources&, Reading&);
/// The texts of --scan.
Sources scan_arguments(const Changes&, Sources&);
void refuse_settings_of_scanned(const std::vector<Setting>&, const ScanPlan&, Reading&);

/// What the files name beside themselves belongs to the inputs.
void add_files(const Reading&, std::vector<InputText>& inputs, Sources&);
/// Throws what was found, each problem once, in the order of the texts.
void throw_if_wrong(Reading&, const Sources&);

}  // namespace rabiline
