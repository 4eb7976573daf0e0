#include "storage/origin.hpp"

#include <fstream>

#include <fmt/format.h>

#include "storage/hdf5_reader.hpp"

namespace rabiline {

bool is_hdf5(const std::filesystem::path& path) {
  std::error_code error;
  std::string begin(8, '\0');
  return std::filesystem::is_regular_file(path, error) &&
         std::filesystem::file_size(path, error) > begin.size() &&  // in /proc there are some that never end
         std::ifstream(path, std::ios::binary).read(begin.data(), 8) && begin == "\x89HDF\r\n\x1a\n";
}

Origin read_origin(const hdf5::FileReader& file, const std::filesystem::path& path) {
  constexpr std::size_t most_text = std::size_t{1} << 26, most_inputs = 16;
  if (!file.contains("entry/simulation/input_0/data"))
    throw StorageError(fmt::format("{}: is not a result of `rabiline run`", path.string()));
  Origin origin;
  for (std::size_t i = 0; i < most_inputs; ++i) {
    const std::string note = fmt::format("entry/simulation/input_{}", i);
    if (!file.contains(note)) break;
    origin.inputs.push_back(
        {file.text(note + "/file_name", most_text), file.text(note + "/data", most_text)});
  }
  if (file.contains("entry/simulation/changes"))
    origin.changes = file.texts("entry/simulation/changes", most_text);
  const auto number = [&](const std::string& name, std::uint64_t most) {
    const auto numbers = file.numbers("entry/simulation/" + name, 1);
    if (numbers.size() != 1 || numbers[0] > most)
      throw StorageError(fmt::format("{}: is damaged", path.string()));
    return numbers[0];
  };
  if (file.contains("entry/simulation/transit"))
    origin.transit = static_cast<KeptTransit>(number("transit", 3));
  if (file.contains("entry/simulation/max_memory"))
    origin.max_memory = number("max_memory", ~std::uint64_t{0});
  origin.rescanned = file.contains("entry/simulation/rescanned");
  return origin;
}

std::string verified_digest(const std::filesystem::path& path) { return hdf5::FileReader(path).digest(); }

Origin read_origin(const std::filesystem::path& path) { return read_origin(hdf5::FileReader(path), path); }

}  // namespace rabiline
