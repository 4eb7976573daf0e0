#pragma once
// What is wrong with the words of a command line before CLI11 reads them, in our words. Each throws
// ArgumentError.
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

namespace rabiline {

/// CLI11 would only say that a subcommand is missing.
void require_known_verb(const CLI::App&, const std::vector<std::string>& arguments);
/// Of a command that there is: options that it has, each once, and with its value.
void require_known_arguments(const CLI::App&, const std::vector<std::string>& arguments);

}  // namespace rabiline
