#include "storage/contents.hpp"

#include <algorithm>
#include <array>
#include <iterator>
#include <string_view>

#include "storage/hdf5_reader.hpp"

namespace rabiline {
namespace {

/// How, where, when and by which version of the program.
constexpr std::array<std::string_view, 17> circumstances{
    "version", "compiler",  "commit",   "libraries", "processor",  "instruction_set",
    "host",    "threads",   "ranks",    "seconds",   "start_time", "end_time",
    "date",    "arguments", "warnings", "slabs",     "rescanned"};

constexpr std::array<std::string_view, 4> circumstances_of_file{"HDF5_Version", "creator_version",
                                                                "file_name", "file_time"};

bool is_compared(std::string_view name, bool with_flight) {
  constexpr std::string_view simulation = "entry/simulation/";
  if (name == "entry/program_name") return false;  // which has its version
  if (name == "entry/flight" || name.starts_with("entry/flight/")) return with_flight;
  return !name.starts_with(simulation) ||
         std::ranges::find(circumstances, name.substr(simulation.size())) == circumstances.end();
}

}  // namespace

std::vector<std::string> differing(const std::filesystem::path& path, std::span<const std::byte> image) {
  const hdf5::FileReader file(path), other(image);
  const bool with_flight = file.contains("entry/flight") && other.contains("entry/flight");
  std::vector<std::string> names, out;
  if (file.everything("/", circumstances_of_file) != other.everything("/", circumstances_of_file))
    out.emplace_back("/");
  std::ranges::set_union(file.names(), other.names(), std::back_inserter(names));
  for (const std::string& name : names)
    if (is_compared(name, with_flight) &&
        (!file.contains(name) || !other.contains(name) || file.everything(name) != other.everything(name)))
      out.push_back("/" + name);
  return out;
}

}  // namespace rabiline
