#pragma once
// The library's face: a beamline or a model is loaded, checked, flown or solved, and its result written.
//
//   const rabiline::Setup setup = rabiline::load("beamline.yaml", {{"law=quantum"}});
//   const std::optional<rabiline::Result> result = rabiline::run(setup);
//   rabiline::write(*result, "results.h5");
#include <atomic>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/diagnostics.hpp"
#include "simulation/result.hpp"
#include "simulation/snapshot.hpp"
#include "storage/motion_file.hpp"

namespace rabiline {

/// What is changed in a file for this time, as on the command line.
struct Changes {
  std::vector<std::string> set{};   // "B.field=9 mT"
  std::vector<std::string> scan{};  // "H0.frequency=280 kHz:300 kHz:21" or "law=quantum,dorado"
  std::optional<std::string> particles{}, seed{};
  bool without_scan = false;  // the file's scan is omitted
};

/// An experiment or a model over its scan, read and without a fault.
class Setup {
 public:
  bool is_model() const;
  const std::string& title() const;
  std::size_t points() const;
  /// The files that it was read from, with their texts.
  const std::vector<InputText>& inputs() const;
  /// Identifies the setup with its changes and this version of the program.
  const std::string& fingerprint() const;

  struct Contents;
  const Contents& contents() const { return *contents_; }
  explicit Setup(std::shared_ptr<const Contents> contents) : contents_(std::move(contents)) {}

 private:
  std::shared_ptr<const Contents> contents_;
};

/// Reads a file. Throws InputError with everything that is wrong, each with its place.
Setup load(const std::filesystem::path& file, const Changes& = {});
/// The same of a text; paths in it begin in `folder`.
Setup load_text(const std::string& text, const std::filesystem::path& folder, const Changes& = {});

/// The plan with its derived numbers, or the numbers of a model, to be read by people.
std::string check(const Setup&);

struct RunSettings {
  int threads = 0;      // 0: as many as the process may use
  std::string isa{};    // "x86-64", "avx2" or "avx512"; empty: the best one here
  int batch = 0;        // particles that go through the loops together, a multiple of 8; 0: the usual number
  const std::atomic<bool>* stop = nullptr;          // looked at now and then
  std::function<void(const Progress&)> progress{};  // by one thread at a time, a few times a second
  std::function<void(const Snapshot&)> snapshot{};  // likewise, each minute and when stopped
  const Snapshot* start = nullptr;                  // goes on from here
  std::vector<std::string> arguments{};             // noted in the result
};

/// Flies an experiment; nothing where it was stopped. The result is the same bits for any settings. Throws
/// std::invalid_argument where the settings do not fit the machine or the setup.
std::optional<Result> run(const Setup&, const RunSettings& = {});
/// Solves a model.
SolvedModel solve(const Setup&, const std::vector<std::string>& arguments = {});

/// Writes one HDF5 file, whole or not at all. Throws StorageError.
void write(const Result&, const std::filesystem::path&);
void write(const SolvedModel&, const std::filesystem::path&);

}  // namespace rabiline
