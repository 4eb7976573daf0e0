#include "storage/checkpoint_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <new>

#include "storage/hdf5_reader.hpp"
#include "storage/hdf5_writer.hpp"

namespace rabiline {
namespace {

using Path = std::filesystem::path;

constexpr std::uint64_t checkpoint_version = 6;
// The most that a checkpoint may hold: far above what runs need, and what a machine can still read. Of the
// places of sums only those are listed that are not zero: long scans in slabs have many more.
constexpr std::uint64_t longest_row = std::uint64_t{1} << 44;
constexpr std::size_t most_sums = std::size_t{1} << 29, most_intervals = std::size_t{1} << 24,
                      most_texts = std::size_t{1} << 28;

[[noreturn]] void refuse(const Path& path, std::string_view why) {
  throw StorageError(
      fmt::format("{}: is neither a checkpoint nor a shard that can be used ({})", path.string(), why));
}

std::size_t total_size(const std::vector<std::string>& texts) {
  std::size_t longest = 0;
  for (const std::string& text : texts) longest = std::max(longest, text.size());
  return longest * texts.size();
}

/// The promises of Snapshot; checked before writing too, so that no checkpoint is written that cannot be
/// read.
void require_valid(const Snapshot& snapshot, const Path& path) {
  const KeptSums& sums = snapshot.sums;
  if (sums.high.size() != sums.at.size() || sums.low.size() != sums.at.size())
    refuse(path, "its sums are incomplete");
  if (std::ranges::adjacent_find(sums.at, std::ranges::greater_equal()) != sums.at.end() ||
      (!sums.at.empty() && sums.at.back() >= sums.size))
    refuse(path, "its sums are not in order");
  if (sums.size > longest_row || snapshot.finished.size() > most_intervals) refuse(path, "it is too large");
  if (!snapshot.shard.exists()) refuse(path, "it is of no shard");
  std::uint64_t free_from = 0;
  for (const auto& [begin, end] : snapshot.finished) {
    if (begin < free_from || end <= begin) refuse(path, "its particles are not in order");
    free_from = end;
  }
  if (!(snapshot.seconds >= 0 && snapshot.seconds < 1e12)) refuse(path, "it has not flown for any time");
  if (free_from > snapshot.particles) refuse(path, "it has more particles than its run");
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

void build(hdf5::FileWriter& file, const Snapshot& snapshot, const Path& path) {
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
  const hdf5::GroupWriter root = file.root();
  const auto write_texts = [&](const std::string& name, const std::vector<std::string>& texts) {
    if (total_size(texts) > most_texts) refuse(path, "its texts are too large");
    root.dataset(name, {texts.size()}, texts);
  };
  const std::vector<std::uint64_t> numbers{checkpoint_version,
                                           snapshot.particles,
                                           snapshot.shard.number,
                                           snapshot.shard.of,
                                           static_cast<std::uint64_t>(snapshot.transit),
                                           snapshot.max_memory,
                                           snapshot.sums.size};
  root.dataset("numbers", {numbers.size()}, numbers,
               {{"long_name",
                 "version, particles in all, shard, of how many, what is kept of the slowness, bytes that "
                 "may be used, "
                 "sums"}});
  root.dataset("seconds", {1}, std::vector<double>{snapshot.seconds}, {{"units", "s"}});
  root.dataset("finished_begin", {begins.size()}, begins);
  root.dataset("finished_end", {ends.size()}, ends);
  const KeptSums& sums = snapshot.sums;
  root.dataset("sums_at", {sums.at.size()}, sums.at);
  root.dataset("sums_high", {sums.high.size()}, sums.high);
  root.dataset("sums_low", {sums.low.size()}, sums.low);
  root.dataset("straggler_trees", {straggler_trees.size()}, straggler_trees);
  root.dataset("straggler_particles", {straggler_particles.size()}, straggler_particles);
  write_texts("fingerprint", {snapshot.fingerprint});
  write_texts("begun", {snapshot.begun});
  write_texts("changes", snapshot.changes);
  write_texts("arguments", snapshot.arguments);
  write_texts("input_paths", inputs.paths);
  write_texts("input_texts", inputs.texts);
}

Snapshot read_contents(const Path& path) {
  const hdf5::FileReader file(path);
  if (!file.contains("numbers")) refuse(path, "it holds something else");
  const auto numbers = file.numbers("numbers", 7);
  if (numbers.size() != 7 || numbers[0] != checkpoint_version || numbers[4] > 3)
    refuse(path, "it is of another version");
  const auto seconds = file.reals("seconds", 1);
  const auto begun = file.texts("begun", most_texts);
  const auto begins = file.numbers("finished_begin", most_intervals),
             ends = file.numbers("finished_end", most_intervals);
  const auto fingerprints = file.texts("fingerprint", most_texts),
             paths = file.texts("input_paths", most_texts), texts = file.texts("input_texts", most_texts);
  if (begins.size() != ends.size()) refuse(path, "its particles are incomplete");
  if (fingerprints.size() != 1 || begun.size() != 1 || seconds.size() != 1 || paths.size() != texts.size())
    refuse(path, "its texts are incomplete");
  Snapshot snapshot;
  snapshot.fingerprint = fingerprints.front();
  snapshot.particles = numbers[1];
  snapshot.shard = {numbers[2], numbers[3]};
  snapshot.transit = static_cast<KeptTransit>(numbers[4]);
  snapshot.max_memory = numbers[5];
  snapshot.seconds = seconds.front();
  snapshot.begun = begun.front();
  for (std::size_t i = 0; i < begins.size(); ++i) snapshot.finished.emplace_back(begins[i], ends[i]);
  snapshot.sums = {numbers[6], file.numbers("sums_at", most_sums), file.numbers("sums_high", most_sums),
                   file.numbers("sums_low", most_sums)};
  const auto trees = file.numbers("straggler_trees", most_intervals),
             particles = file.numbers("straggler_particles", most_intervals);
  if (trees.size() != particles.size()) refuse(path, "its list of stragglers is incomplete");
  for (std::size_t i = 0; i < trees.size(); ++i) snapshot.stragglers.push_back({trees[i], particles[i]});
  snapshot.changes = file.texts("changes", most_texts);
  snapshot.arguments = file.texts("arguments", most_texts);
  for (std::size_t i = 0; i < paths.size(); ++i) snapshot.inputs.push_back({paths[i], texts[i]});
  require_valid(snapshot, path);
  return snapshot;
}

}  // namespace

void write_checkpoint(const Snapshot& snapshot, const Path& path) {
  require_valid(snapshot, path);
  hdf5::FileWriter file(path);
  build(file, snapshot, path);
  file.save();
}

Snapshot read_checkpoint(const Path& path) {
  try {
    return read_contents(path);
  } catch (const std::bad_alloc&) {
    refuse(path, "it does not fit into memory");
  }
}

}  // namespace rabiline
