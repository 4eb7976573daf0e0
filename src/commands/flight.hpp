#pragma once
// What the commands that fly an experiment share: where the result goes, its checkpoints, progress, stops.
#include <optional>

#include "commands/common.hpp"

namespace rabiline {

/// How to fly, which never changes a result.
struct FlightOptions {
  MachineOptions machine;
  std::string batch;  // empty: the largest
  std::string progress = "auto";
  std::string checkpoint_every, max_time;  // empty: 60 s, none
  bool keep = false;
  bool strict = false;
  void add_to(CLI::App&);
  /// Throws ArgumentError and InputError.
  RunSettings settings() const;
};

/// As a shell reads it back.
std::string quoted(const std::filesystem::path&);

/// "OUT.h5.checkpoint", where a run that was stopped is kept.
std::filesystem::path checkpoint_of(const std::filesystem::path& output);

/// For what writes no checkpoints of its own: the sums of another run may lie there, which `rabiline resume`
/// would write over this. Throws ArgumentError.
void require_no_checkpoint(const std::filesystem::path& output);

/// Flies, and writes the result, or the sums of a shard; or a checkpoint where it is stopped or the result
/// cannot be written. Goes on from `start`, or from a checkpoint that lies there. Returns the exit code.
int fly(const Setup&, const std::filesystem::path& output, const FlightOptions&, RunSettings,
        std::optional<Snapshot> start);

}  // namespace rabiline
