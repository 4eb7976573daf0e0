#pragma once
// The face of the library: an experiment or a model is loaded, checked, flown or solved, and its result
// written.
//
//   const rabiline::Setup setup = rabiline::load("beamline/ramsey.yaml", {.set = {"B.field=9 mT"}});
//   const std::optional<rabiline::Result> result = rabiline::run(setup);
//   if (result) rabiline::write(*result, "ramsey.h5");
//
// Numbers are in SI; texts have their units. What is wrong is thrown:
//   InputError             everything that is wrong in a file, a text or a change, each with its place
//   StorageError           a file that could not be written or read, with the reason
//   std::invalid_argument  settings that do not fit the machine or the setup
#include <array>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "input/changes.hpp"
#include "models/solved_model.hpp"
#include "simulation/result.hpp"
#include "simulation/snapshot.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {

/// An experiment or a model over its scan, read and without a fault. Copies share it.
class Setup {
 public:
  bool is_model() const;
  const std::string& title() const;
  std::size_t points() const;  // of its scan; 1 where nothing is scanned
  /// What it was read from, each with its whole text.
  const std::vector<InputText>& inputs() const;
  /// Identifies its texts, its changes and the version of the program: a snapshot of another one is refused.
  const std::string& fingerprint() const;

  struct Contents;  // known to the library alone
  explicit Setup(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}
  const Contents& contents() const { return *contents_; }

 private:
  std::shared_ptr<const Contents> contents_;
};

/// Reads a file. Throws InputError.
Setup load(const std::filesystem::path& file, const Changes& = {});
/// The same where only a beamline will do: a model is refused before anything else in it is judged.
Setup load_beamline(const std::filesystem::path& file, const Changes& = {});
/// As `load`, of a text, which messages call `text`; paths in it begin in `folder`.
Setup load_text(const std::string& text, const std::filesystem::path& folder, const Changes& = {});

/// What is known before anything is flown or solved.
struct Report {
  std::string text;  // the plan with its derived numbers, or the numbers of a model, to be read by people
  std::vector<Diagnostic> warnings;  // what deserves a word although nothing is wrong, with its place
};
Report check(const Setup&);

/// Moments of the slowness that a result keeps, from which other scans follow without another flight: where
/// they are a fifth of the file at most; none; of each detector as a whole; of each of its bins.
enum class KeptTransit { if_small, none, totals, images };

/// How to compute, which never changes a bit of the result, and what is told meanwhile.
struct RunSettings {
  int threads = 0;                          // 0: as many as the process may use; at most 1024
  std::string isa{};                        // "x86-64", "avx2" or "avx512"; empty: the best one here
  int batch = 0;                            // particles in the loops together, a multiple of 8; 0: the most
  const std::atomic<bool>* stop = nullptr;  // looked at every few hundredths of a second
  /// Called before the flight with what deserves a word; what it throws ends the run.
  std::function<void(const std::vector<Diagnostic>& warnings)> planned{};
  std::function<void(const Progress&)> progress{};  // by one thread at a time, a few times a second
  std::function<void(const Snapshot&)> snapshot{};  // likewise, every snapshot_seconds and when stopped
  double snapshot_seconds = 60;                     // [s]
  const Snapshot* start = nullptr;                  // goes on from here
  std::vector<std::string> arguments{};             // noted in the result as the command line
  KeptTransit transit = KeptTransit::if_small;
};

/// Flies an experiment; nothing where it was stopped. Throws std::invalid_argument where the settings or the
/// snapshot do not fit, the machine has not the memory, or it is a model.
std::optional<Result> run(const Setup&, const RunSettings& = {});

/// Another scan of the flight that a result kept: of what turns spins between two places that ask for their
/// level. `changes` come on top of those of the flight; particles and seed are its own. Of the settings,
/// `isa`, `planned` and `arguments` apply. Throws StorageError where nothing was kept, InputError, and
/// std::invalid_argument where the scan does not follow from the flight.
Result rescan(const std::filesystem::path& result, const Changes& changes, const RunSettings& = {});

/// The paths of `count` particles from number `first`, fewer where the run has fewer, at the values of the
/// file without its scan. Of the settings, `isa` and `planned` apply. Throws as run does.
std::vector<Track> trace(const Setup&, std::uint64_t first, std::uint64_t count, const RunSettings& = {});

/// The magnetic field at a place, at the values of the file without its scan.
struct Probed {
  struct Contribution {
    std::string part;
    std::array<double, 3> field;  // [T]
  };
  std::array<double, 3> place{};  // [m] x across, y along the beam, z up
  std::array<double, 3> field{};  // [T]
  std::array<double, 9> slope{};  // [T/m] dB_i/dx_k at [3 i + k]
  std::vector<Contribution> contributions;
};
/// Fields with a clock are taken at `time` [s], random phases as zero.
Probed probe(const Setup&, const std::array<double, 3>& place, double time = 0);

/// Solves a model at each point of its scan. Throws std::runtime_error where a motion cannot be integrated,
/// and std::invalid_argument for an experiment.
SolvedModel solve(const Setup&, const std::vector<std::string>& arguments = {});

/// Writes one HDF5 file, whole and verified or not at all; an earlier one is then intact. Throws
/// StorageError.
void write(const Result&, const std::filesystem::path&);
void write(const SolvedModel&, const std::filesystem::path&);
void write(const std::vector<Track>&, const std::string& title, const std::filesystem::path&);
/// Snapshots on disk, likewise.
void write(const Snapshot&, const std::filesystem::path&);
Snapshot read_snapshot(const std::filesystem::path&);

}  // namespace rabiline
