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
//   Stopped                where nothing is returned as it was asked to stop
//   std::invalid_argument  settings that do not fit the machine or the setup
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/diagnostics.hpp"
#include "models/solved_model.hpp"
#include "scan/changes.hpp"
#include "simulation/ranks.hpp"
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

/// Reads a file: a text, or a result, of which what it was made from is read. Throws InputError and
/// StorageError.
Setup load(const std::filesystem::path& file, const Changes& = {});
/// The same where only a beamline will do: a model is refused before anything else in it is judged.
Setup load_beamline(const std::filesystem::path& file, const Changes& = {});
/// As `load`, of what a snapshot was made from.
Setup load(const Snapshot&);
/// The same once more with these changes instead, behind those of a result; files are as they were when it
/// was loaded, and a map that is another one now is refused.
Setup load(const Setup&, const Changes&);
/// As `load`, of a text, which messages call `text`; paths in it begin in `folder`.
Setup load_text(const std::string& text, const std::filesystem::path& folder, const Changes& = {});

/// The number that a dotted name such as `B.field` stands for, without the scan. Nothing where it is none: a
/// word, a variable, a key that the file omits and that has no default, or anything in a model.
struct ParameterValue {
  double value = 0;  // [SI]
  std::string unit;  // "T"; empty for a plain number
};
std::optional<ParameterValue> value_of(const Setup&, const std::string& name);

/// The parts of an experiment by their place, without its scan; none of a model.
std::vector<PartName> parts_of(const Setup&);

/// About what a run takes here.
struct Cost {
  double seconds = 0;  // [s] on one core
  double memory = 0;   // [bytes] for each thread
};
/// What is known before anything is flown or solved.
struct Report {
  std::string text;  // the plan with its derived numbers, or the numbers of a model, to be read by people
  std::vector<Diagnostic> warnings;  // what deserves a word although nothing is wrong, with its place
  std::optional<Cost> cost{};        // none of a model
};
/// `max_memory`: as in RunSettings.
Report check(const Setup&, std::uint64_t max_memory = 0);

/// A line for people, or nothing: that the counts of an experiment do not depend on its scan, though levels
/// may. `check` has it in its text.
std::string note_of(const Setup&);

/// Thrown by what returns a whole or nothing where it was asked to stop.
struct Stopped : std::exception {
  const char* what() const noexcept override { return "stopped"; }
};

/// How to compute, which never changes a bit of the result, and what is told meanwhile.
struct RunSettings {
  int threads = 0;                          // 0: as many as the process may use; at most 1024
  std::string isa{};                        // "x86-64", "avx2" or "avx512"; empty: the best one here
  int batch = 0;                            // particles in the loops together, a multiple of 8; 0: the most
  const std::atomic<bool>* stop = nullptr;  // looked at every few hundredths of a second of a flight
  bool silent = false;  // looks for nothing that deserves a word, which takes as long as a small flight
  /// Called before the flight with what deserves a word; what it throws ends the run.
  std::function<void(const std::vector<Diagnostic>& warnings)> planned{};
  std::function<void(const Progress&)> progress{};  // by the calling thread, a few times a second
  std::function<void(Snapshot)> snapshot{};         // likewise, every snapshot_seconds and at the end
  double snapshot_seconds = 60;                     // [s]
  const Snapshot* start = nullptr;                  // goes on from here
  std::vector<std::string> arguments{};             // noted in the result as the command line
  KeptTransit transit = KeptTransit::if_small;
  /// That may be used [bytes]. A scan that needs more is worked out in slabs of its points, one behind the
  /// other, and refused where that does not do. 0: 2 GiB for the first question, seven tenths of the machine
  /// for the second one.
  std::uint64_t max_memory = 0;
  /// Called with the finished points, slab by slab, row-major; the axes are those of the whole scan. What is
  /// returned then has of each point what was emitted and what was detected, with errors, and no more: so a
  /// result need not be in memory as a whole (ResultsFile, storage/results_file.hpp).
  std::function<void(const Result& points)> points{};
  Shard shard{};           // of the work; the last snapshot then holds its sums
  Ranks* ranks = nullptr;  // processes that fly together; the others call `assist`
};

/// Flies an experiment; nothing where it was stopped, or where it is one shard of several. Throws
/// std::invalid_argument where the settings or the snapshot do not fit, the machine has not the memory, or it
/// is a model.
std::optional<Result> run(const Setup&, const RunSettings& = {});

/// Of ranks that do not lead: flies along in every run of the leader, until it dismisses them. Returns the
/// exit code that came with that.
int assist(Ranks&, const std::atomic<bool>* stop = nullptr);
/// By the leader, once.
void dismiss(Ranks&, int exit_code);

/// Another scan of the flight that a result kept: of what turns spins between two places that ask for their
/// level. `changes` come on top of those of the flight; particles and seed are its own. Of the settings,
/// `isa`, `threads`, `max_memory`, `points`, `planned` and `arguments` apply. Throws StorageError where
/// nothing was kept, InputError, and std::invalid_argument where the scan does not follow from the flight.
Result rescan(const std::filesystem::path& result, const Changes& changes, const RunSettings& = {});

/// The paths of `count` particles from number `first`, fewer where the run has fewer, at the values of the
/// file without its scan. Of the settings, `isa`, `planned` and `stop` apply. Throws as run does.
std::vector<Track> trace(const Setup&, std::uint64_t first, std::uint64_t count, const RunSettings& = {});

/// The fields at a place, at the values of the file without its scan.
struct Probed {
  struct Contribution {
    std::string part;
    std::array<double, 3> field{};     // [T]
    std::array<double, 3> electric{};  // [V/m]
    /// [m] How far from its axis a fringe or a profile tells what the field is, where the place is farther; 0
    /// elsewhere.
    double good_up_to = 0;
  };
  std::array<double, 3> place{};     // [m] x across, y along the beam, z up
  std::array<double, 3> field{};     // [T]
  std::array<double, 9> slope{};     // [T/m] dB_i/dx_k at [3 i + k]
  std::array<double, 3> electric{};  // [V/m]
  std::vector<Contribution> contributions;
};
/// Fields with a clock are taken at `time` [s], random phases as zero.
Probed probe(const Setup&, const std::array<double, 3>& place, double time = 0);

/// Solves a model at each point of its scan. Throws std::runtime_error where a motion cannot be integrated,
/// and std::invalid_argument for an experiment.
/// Looks at `stop` between two points.
SolvedModel solve(const Setup&, const std::vector<std::string>& arguments = {},
                  const std::atomic<bool>* stop = nullptr);

/// Writes one HDF5 file, whole and verified or not at all; an earlier one is then intact. Throws
/// StorageError.
void write(const Result&, const std::filesystem::path&);
void write(const SolvedModel&, const std::filesystem::path&);
void write(const std::vector<Track>&, const Setup& which_they_flew_through, const std::filesystem::path&);
/// The bytes of these files, for who keeps them elsewhere.
std::vector<std::byte> image_of(const Result&);
std::vector<std::byte> image_of(const SolvedModel&);
std::vector<std::byte> image_of(const std::vector<Track>&, const Setup& which_they_flew_through);
/// Snapshots on disk, likewise.
void write(const Snapshot&, const std::filesystem::path&);
Snapshot read_snapshot(const std::filesystem::path&);

/// The digest in the last line of a file that this program wrote. Throws StorageError where the file is
/// damaged, was changed, or names other files.
std::string verify(const std::filesystem::path&);
/// Flies or solves again what a file was made from. Throws StorageError where it is no result, Stopped, and
/// as run and solve do.
struct Reproduced {
  std::variant<Result, SolvedModel> result;
  /// Paths in the file of what comes out otherwise, to the bit. How, where, when and by which version of the
  /// program it was computed is not compared.
  std::vector<std::string> differing;
};
Reproduced reproduce(const std::filesystem::path& result, RunSettings = {});

}  // namespace rabiline
