#include "storage/checkpoint_file.hpp"

#include <fmt/format.h>

#include <cstring>
#include <fstream>
#include <new>
#include <span>

#include "storage/digest.hpp"
#include "storage/hdf5_reader.hpp"
#include "storage/hdf5_writer.hpp"
#include "storage/safe_file.hpp"

namespace rabiline {
namespace {

using Path = std::filesystem::path;

constexpr std::size_t header_size = 512;  // the smallest user block that HDF5 skips
// The most that a checkpoint may hold: far above what runs need, and what a machine can still read.
constexpr std::size_t most_sums = std::size_t{1} << 29, most_intervals = std::size_t{1} << 24,
                      most_trees = std::size_t{1} << 24, most_text = std::size_t{1} << 28;
constexpr std::uintmax_t most_bytes_on_disk = std::uintmax_t{1} << 34;

[[noreturn]] void refuse(const Path& path, std::string_view why) {
  throw StorageError(
      fmt::format("{}: is no usable checkpoint ({}); start the run again without it", path.string(), why));
}

std::string header_for(std::uint64_t size, std::uint64_t checksum) {
  std::string header = fmt::format("rabiline checkpoint 3\nHDF5 of {} bytes from byte {}\nFNV-1a {:016x}\n",
                                   size, header_size, checksum);
  header.resize(header_size, '\n');
  return header;
}

/// Reads the file once from end to end, so that HDF5 never sees a damaged one.
void require_intact(const Path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw StorageError(fmt::format("{}: cannot be read (there is no such file)", path.string()));
  }
  if (std::filesystem::file_size(path, error) > most_bytes_on_disk) refuse(path, "it is too large");
  std::ifstream file(path, std::ios::binary);
  if (!file) throw StorageError(fmt::format("{}: cannot be read ({})", path.string(), std::strerror(errno)));
  std::string header(header_size, '\0');
  if (!file.read(header.data(), header_size) || !header.starts_with("rabiline checkpoint ")) {
    refuse(path, "it was not written by rabiline");
  }
  std::vector<char> block(1 << 20);
  std::uint64_t size = 0, checksum = digest_of_nothing;
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0) {
    const std::span read(block.data(), static_cast<std::size_t>(file.gcount()));
    checksum = digest(std::as_bytes(read), checksum);
    size += read.size();
  }
  if (header != header_for(size, checksum)) refuse(path, "it is damaged or cut short, or of another version");
}

std::size_t total_size(const std::vector<std::string>& texts) {
  std::size_t longest = 0;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  return longest * texts.size();
}

/// The promises of Snapshot; checked before writing too, so that no checkpoint is written that cannot be
/// read.
void require_valid(const Snapshot& snapshot, const Path& path) {
  if (snapshot.sums_high.size() != snapshot.sums_low.size()) refuse(path, "its sums are incomplete");
  if (snapshot.sums_high.size() > most_sums || snapshot.finished.size() > most_intervals ||
      snapshot.block_sizes.size() > most_trees)
    refuse(path, "it is too large");
  std::uint64_t free_from = 0;
  for (const auto& [begin, end] : snapshot.finished) {
    if (begin < free_from || end <= begin) refuse(path, "its units are not in order");
    free_from = end;
  }
}

/// The inputs' paths and texts as one list each.
struct InputColumns {
  std::vector<std::string> paths, texts;
};
InputColumns columns_of(const std::vector<InputText>& inputs) {
  InputColumns columns;
  for (const InputText& input : inputs) {
    columns.paths.push_back(input.path);
    columns.texts.push_back(input.text);
  }
  return columns;
}

hdf5::FileWriter build(const Snapshot& snapshot, const Path& path) {
  std::vector<std::uint64_t> begins, ends;
  for (const auto& [begin, end] : snapshot.finished) {
    begins.push_back(begin);
    ends.push_back(end);
  }
  std::vector<std::uint64_t> straggler_trees, straggler_particles;
  for (const Straggler& straggler : snapshot.stragglers) {
    straggler_trees.push_back(straggler.tree);
    straggler_particles.push_back(straggler.particle);
  }
  const InputColumns inputs = columns_of(snapshot.inputs);
  hdf5::FileWriter file(path);
  const hdf5::GroupWriter root = file.root();
  const auto write_texts = [&](const std::string& name, const std::vector<std::string>& texts) {
    if (total_size(texts) > most_text) refuse(path, "its texts are too large");
    root.dataset(name, {texts.size()}, texts);
  };
  root.dataset("block_sizes", {snapshot.block_sizes.size()}, snapshot.block_sizes);
  root.dataset("finished_begin", {begins.size()}, begins);
  root.dataset("finished_end", {ends.size()}, ends);
  root.dataset("sums_high", {snapshot.sums_high.size()}, snapshot.sums_high);
  root.dataset("sums_low", {snapshot.sums_low.size()}, snapshot.sums_low);
  root.dataset("straggler_trees", {straggler_trees.size()}, straggler_trees);
  root.dataset("straggler_particles", {straggler_particles.size()}, straggler_particles);
  write_texts("fingerprint", {snapshot.fingerprint});
  write_texts("arguments", snapshot.arguments);
  write_texts("input_paths", inputs.paths);
  write_texts("input_texts", inputs.texts);
  return file;
}

Snapshot read_contents(const Path& path) {
  const hdf5::FileReader file(path);
  const auto begins = file.numbers("finished_begin", most_intervals),
             ends = file.numbers("finished_end", most_intervals);
  const auto fingerprints = file.texts("fingerprint", most_text),
             paths = file.texts("input_paths", most_text), texts = file.texts("input_texts", most_text);
  if (begins.size() != ends.size()) refuse(path, "its units are incomplete");
  if (fingerprints.size() != 1 || paths.size() != texts.size()) refuse(path, "its texts are incomplete");
  Snapshot snapshot;
  snapshot.fingerprint = fingerprints.front();
  snapshot.block_sizes = file.numbers("block_sizes", most_trees);
  for (std::size_t i = 0; i < begins.size(); ++i) snapshot.finished.emplace_back(begins[i], ends[i]);
  snapshot.sums_high = file.numbers("sums_high", most_sums);
  snapshot.sums_low = file.numbers("sums_low", most_sums);
  const auto trees = file.numbers("straggler_trees", most_intervals),
             particles = file.numbers("straggler_particles", most_intervals);
  if (trees.size() != particles.size()) refuse(path, "its list of stragglers is incomplete");
  for (std::size_t i = 0; i < trees.size(); ++i) snapshot.stragglers.push_back({trees[i], particles[i]});
  snapshot.arguments = file.texts("arguments", most_text);
  for (std::size_t i = 0; i < paths.size(); ++i) snapshot.inputs.push_back({paths[i], texts[i]});
  require_valid(snapshot, path);
  return snapshot;
}

}  // namespace

void write_checkpoint(const Snapshot& snapshot, const Path& path) {
  require_valid(snapshot, path);
  const hdf5::FileWriter file = build(snapshot, path);
  std::vector<std::byte> bytes = file.image(header_size);
  const auto contents = std::span(bytes).subspan(header_size);
  std::memcpy(bytes.data(), header_for(contents.size(), digest(contents)).data(), header_size);
  replace_file(path, bytes, [&file](const Path& temporary) { file.verify(temporary); });
}

Snapshot read_checkpoint(const Path& path) {
  require_intact(path);
  try {
    return read_contents(path);
  } catch (const std::bad_alloc&) {
    refuse(path, "it does not fit into memory");
  }
}

}  // namespace rabiline
