#include "commands/flight.hpp"

#include <algorithm>
#include <chrono>
#include <fstream>
#include <span>

#include "commands/progress_line.hpp"
#include "commands/stop.hpp"
#include "core/processors.hpp"
#include "particle/batch.hpp"
#include "scan/settings.hpp"
#include "storage/lock.hpp"
#include "storage/results_file.hpp"
#include "storage/safe_file.hpp"

namespace rabiline {
namespace {

using Path = std::filesystem::path;

/// One that cannot be written is worth a warning, not the run.
bool write_or_warn(const Snapshot& snapshot, const Path& path) {
  try {
    write(snapshot, path);
    return true;
  } catch (const StorageError& error) {
    say(stderr, "\nwarning: {}\n", error.what());
    return false;
  }
}

/// [s] Less than that is worked out and written in a moment, or lost without regret.
constexpr double short_flight = 5;
constexpr std::size_t few_points = 1000;

std::string told_of_stop(const Path& kept, const std::string& how) {
  return fmt::format("stopped; what is finished is in {}{}\n  help: continue with: rabiline resume {}\n",
                     checkpoint_of(kept).string(), how, quoted(kept));
}

/// Another name in that folder, `a.1.h5` for `a.h5`, where that has a result or a checkpoint already.
Path untaken(const Path& place) {
  std::error_code error;
  Path name = place;
  for (int n = 1; std::filesystem::exists(name, error) || std::filesystem::exists(checkpoint_of(name), error);
       ++n)
    name = numbered(place, n);
  return name;
}

/// Keeps the sums somewhere: beside the output, in the current folder, in those for temporary files. Returns
/// the output whose checkpoint they are now. Throws StorageError where there is no place.
Path keep(const Snapshot& snapshot, const Path& output) {
  std::error_code error;
  const Path name = output.filename();
  std::string tried;
  for (const Path& place : {output, std::filesystem::current_path(error) / name,
                            std::filesystem::temp_directory_path(error) / name, Path("/tmp") / name}) {
    try {
      if (place != output && !place.has_parent_path()) continue;
      const Path kept = place == output ? output : untaken(place);
      return write(snapshot, checkpoint_of(kept)), kept;
    } catch (const StorageError& problem) {
      tried += (tried.empty() ? "" : "\n  nor: ") + std::string(problem.what());
    }
  }
  throw StorageError(tried);
}

/// One that takes longer than a moment to write is told with its size.
int keep_stopped(const Snapshot& snapshot, const Path& output, bool flew) {
  constexpr double moment = 0.5, mebibyte = 1048576;
  const auto begin = std::chrono::steady_clock::now();
  const Path kept = keep(snapshot, output);
  const std::chrono::duration<double> took = std::chrono::steady_clock::now() - begin;
  std::error_code unknown;
  const double size =
      static_cast<double>(std::filesystem::file_size(checkpoint_of(kept), unknown)) / mebibyte;
  const bool is_long = !unknown && took.count() > moment;
  say(stderr, "{}",
      told_of_stop(kept, is_long ? fmt::format(", {:.3g} MiB written in {:.1f} s", size, took.count()) : ""));
  if (!flew) say(stderr, "  note: no particle came to its end this time: leave the run more of it\n");
  return exit_code::stopped;
}

/// Of a result that could not be written.
int keep_unwritten(const Snapshot& snapshot, const Path& output, const StorageError& why) {
  say(stderr, "error: {}\n", why.what());
  const Path kept = keep(snapshot, output);
  say(stderr,
      "  help: nothing is lost: all that has flown is in {}; write the result with: rabiline resume {}\n",
      checkpoint_of(kept).string(), quoted(kept));
  return exit_code::not_written;
}

ArgumentError lost_by_writing(const Path& output) {
  return ArgumentError(
      fmt::format("{} is a checkpoint of another run, which would be lost\n  help: continue that one with "
                  "`rabiline resume {}`, or "
                  "remove it with `rm {}`, or write to another file",
                  checkpoint_of(output).string(), quoted(output), quoted(checkpoint_of(output))));
}

/// What lies there is gone on from where it is of this run.
std::optional<Snapshot> checkpoint_beside(const Path& output, const Setup& setup,
                                          const RunSettings& settings) {
  const Path path = checkpoint_of(output);
  if (!std::filesystem::exists(path)) return {};
  if (std::filesystem::is_directory(path))
    throw StorageError(fmt::format(
        "{} is a folder, and checkpoints of {} go there\n  help: give it another name, or write to "
        "another file",
        path.string(), output.string()));
  Snapshot found;
  try {
    found = read_snapshot(path);
  } catch (const StorageError& error) {
    // What cannot even be opened may be whole.
    const bool is_open = std::ifstream(path).is_open();
    throw StorageError(
        is_open ? fmt::format("{}\n  help: remove it to start anew: rm {}", error.what(), quoted(path))
                : fmt::format("{}\n  help: it may be whole: let it be read, and run again", error.what()));
  }
  if (found.fingerprint != setup.fingerprint() || !(found.shard == settings.shard) ||
      found.transit != settings.transit || found.max_memory != settings.max_memory)
    throw lost_by_writing(output);
  return found;
}

}  // namespace

void FlightOptions::add_to(CLI::App& app) {
  machine.add_to(app);
  app.add_option("--batch", batch, "particles per batch; the result is the same for any")->type_name("N");
  app.add_option("--progress", progress, "auto, lines, json or none")
      ->check(CLI::IsMember({"auto", "lines", "json", "none"}));
  app.add_option("--checkpoint-every", checkpoint_every,
                 "time between checkpoints, such as `10 min`; 60 s if omitted")
      ->type_name("TIME");
  app.add_option("--max-time", max_time,
                 "stop after this time of flight, such as `23.9 h`, with a checkpoint that `rabiline resume` "
                 "goes on from")
      ->type_name("TIME");
  app.add_flag("--keep", keep, "give an earlier OUT.h5 another name, OUT.1.h5 or the next that is free");
}

RunSettings FlightOptions::settings() const {
  RunSettings out = machine.settings();
  const Range positive{0, 1e9, false, true, "greater than zero and at most 1e9 s, some thirty years"};
  if (!checkpoint_every.empty())
    out.snapshot_seconds = read_time_argument("--checkpoint-every", checkpoint_every, positive);
  if (!max_time.empty()) read_time_argument("--max-time", max_time, positive);
  if (batch.empty()) return out;
  const std::string sizes = fmt::format("a multiple of 8 from 8 to {}", Batch::capacity);
  out.batch = static_cast<int>(read_argument("--batch", batch, {8, Batch::capacity, true, true, sizes}));
  if (out.batch % 8 != 0) throw ArgumentError(fmt::format("--batch must be {}, but is {}", sizes, out.batch));
  return out;
}

std::string quoted(const Path& path) {
  std::string out = "'";
  for (const char c : path.string()) out += c == '\'' ? std::string("'\\''") : std::string(1, c);
  const bool plain =
      path.string().find_first_not_of(
          "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789._/+-@%") == std::string::npos;
  return plain && !path.empty() ? path.string() : out + "'";
}

Path checkpoint_of(const Path& output) { return output.string() + ".checkpoint"; }

void require_no_checkpoint(const Path& output) {
  std::error_code none;
  if (std::filesystem::exists(checkpoint_of(output), none)) throw lost_by_writing(output);
}

int fly(const Setup& setup, const Path& output, const FlightOptions& options, RunSettings settings,
        std::optional<Snapshot> start) {
  const Lock lock(output);
  if (!start) {
    start = checkpoint_beside(output, setup, settings);
    if (start)
      say(stderr, "continues from {}: {:.1f} % have flown\n", checkpoint_of(output).string(),
          100 * start->done());
  }
  if (settings.ranks != nullptr && settings.threads > processors())
    say(stderr,
        "warning: the {} threads of a process share {} core{}\n  help: start them with `mpirun --bind-to "
        "none`, or "
        "`--map-by slot:PE={}`\n",
        settings.threads, processors(), processors() == 1 ? "" : "s", settings.threads);
  std::size_t told = 0;
  Snapshot last;
  ProgressLine progress(options.progress);
  settings.planned = [&](const std::vector<Diagnostic>& warnings) {
    tell(warnings, options.strict, stderr);
    told = warnings.size();
    watch_signals();
    if (!options.max_time.empty()) stop_after(read_time_argument("--max-time", options.max_time, range::any));
  };
  settings.progress = [&](const Progress& p) { progress(p); };
  std::optional<StoppedAtOnce> end;
  settings.snapshot = [&](Snapshot snapshot) {
    const bool is_last = snapshot.complete || stop_requested();
    if (!is_last) write_or_warn(snapshot, checkpoint_of(output));
    // What follows may take long, and then nobody has to wait for it.
    if (snapshot.complete && settings.ranks == nullptr &&
        (snapshot.seconds > short_flight || setup.points() > few_points) &&
        write_or_warn(snapshot, checkpoint_of(output)))
      end.emplace(told_of_stop(output, ""));
    // Where several fly, another one may have been asked to stop.
    if (is_last || settings.ranks != nullptr) last = std::move(snapshot);
  };
  settings.stop = &stop_requested();
  settings.start = start ? &*start : nullptr;
  std::optional<ResultsFile> file(output);
  std::size_t written = 0;
  settings.points = [&](const Result& points) {
    file->add(points);
    written += points.emitted.size();
    progress.writing(written, setup.points());
    if (written < setup.points() && stop_requested()) throw Stopped();
  };
  const auto flew = [&] { return last.done() > (start ? start->done() : 0); };
  std::optional<Result> result;
  try {
    progress.planning(setup.points());
    result = run(setup, settings);
    progress.clear();
    if (!last.complete) return keep_stopped(last, output, flew());
    if (options.keep) back_up(output);
    if (result)
      file->save(*result);
    else
      write(last, output);
  } catch (const Stopped&) {
    progress.clear();
    file.reset();  // which leaves room for the checkpoint
    return keep_stopped(last, output, flew());
  } catch (const StorageError& error) {
    if (!last.complete) throw;
    progress.clear();
    file.reset();
    return keep_unwritten(last, output, error);
  }
  end.reset();
  std::error_code ignored;
  std::filesystem::remove(checkpoint_of(output), ignored);
  if (!result) {
    say(stdout, "{}shard {} of {}, {:.2f} s\nwrote {}\n", headed(setup.title()), last.shard.number,
        last.shard.of, last.seconds, output.string());
    return exit_code::done;
  }
  const std::span ineffective = std::span(result->provenance.warnings).subspan(told);
  for (const std::string& warning : ineffective) say(stderr, "warning: {}\n", warning);
  print_summary(*result, output, note_of(setup));
  return options.strict && !ineffective.empty() ? exit_code::bad_input : exit_code::done;
}

}  // namespace rabiline
