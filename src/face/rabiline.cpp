#include "rabiline.hpp"

#include <algorithm>
#include <chrono>
#include <ctime>
#include <span>
#include <stdexcept>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <omp.h>
#include <sys/utsname.h>
#include <unistd.h>

#include "core/isa.hpp"
#include "core/version.hpp"
#include "face/models.hpp"
#include "face/probe.hpp"
#include "plan/explain.hpp"
#include "rules/field_lint.hpp"
#include "rules/warnings.hpp"
#include "simulation/blocks.hpp"
#include "simulation/effects.hpp"
#include "simulation/field_check.hpp"
#include "simulation/finish.hpp"
#include "simulation/precision.hpp"
#include "simulation/rescan.hpp"
#include "simulation/run.hpp"
#include "simulation/trace.hpp"
#include "storage/checkpoint_file.hpp"
#include "storage/digest.hpp"
#include "storage/flight_file.hpp"
#include "storage/motion_file.hpp"
#include "storage/results_file.hpp"
#include "storage/tracks_file.hpp"

namespace rabiline {

struct Setup::Contents {
  Loaded loaded;
  Changes changes;
  std::string fingerprint;
};

namespace {

std::string fingerprint_of(const std::vector<InputText>& inputs, const Changes& changes) {
  std::uint64_t hash = digest_of_nothing;
  const auto mix = [&](const std::string& text) {
    hash = digest(std::as_bytes(std::span(text.c_str(), text.size() + 1)), hash);
  };
  mix(version);
  for (const InputText& input : inputs) mix(input.text);
  for (const std::string& change : changes.set) mix(change);
  for (const std::string& scan : changes.scan) mix(scan);
  mix(changes.without_scan ? "without scan" : "");
  mix(changes.particles.value_or(""));
  mix(changes.seed.value_or(""));
  return fmt::format("{:016x}", hash);
}

const std::vector<InputText>& inputs_of(const Loaded& loaded) {
  return std::visit([](const auto& any) -> const std::vector<InputText>& { return any.inputs; }, loaded);
}

Setup setup_of(Loaded loaded, const Changes& changes) {
  std::string fingerprint = fingerprint_of(inputs_of(loaded), changes);
  return Setup(std::make_shared<const Setup::Contents>(
      Setup::Contents{std::move(loaded), changes, std::move(fingerprint)}));
}

const LoadedExperiment& experiment_of(const Setup& setup) {
  if (setup.is_model())
    throw std::invalid_argument(
        fmt::format("{} is a model: it is solved, not flown", setup.inputs().front().path));
  return std::get<LoadedExperiment>(setup.contents().loaded);
}

std::vector<Diagnostic> located(const std::vector<Fault>& faults, const Places& places) {
  std::vector<Diagnostic> out;
  out.reserve(faults.size());
  for (const Fault& fault : faults) out.push_back(places.locate(fault));
  return out;
}

std::string text_of(const Diagnostic& warning) {
  return warning.suggestion.empty() ? warning.message
                                    : fmt::format("{}\n  help: {}", warning.message, warning.suggestion);
}

/// This moment as ISO 8601 with offset.
std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%S%z}", fmt::localtime(std::time(nullptr))); }

/// Program, machine, command line and inputs; the times of its life are those of the work.
class Record {
 public:
  Record(const Setup& setup, const std::vector<std::string>& arguments) {
    kept_.arguments = arguments;
    kept_.inputs = setup.inputs();
    kept_.version = version;
    kept_.compiler = compiler;
    utsname machine{};
    if (uname(&machine) == 0) kept_.host = machine.nodename;
    kept_.start_time = now();
  }
  Provenance* operator->() { return &kept_; }
  Provenance finish() {
    kept_.seconds = std::chrono::duration<double>(Clock::now() - begin_).count();
    kept_.end_time = now();
    return std::move(kept_);
  }

 private:
  using Clock = std::chrono::steady_clock;
  Provenance kept_;
  Clock::time_point begin_ = Clock::now();
};

int threads_of(const RunSettings& settings) {
  if (settings.threads < 0 || settings.threads > 1024)
    throw std::invalid_argument("`threads` must be from 1 to 1024, or 0 for as many as the process may use");
  return settings.threads == 0 ? omp_get_num_procs() : settings.threads;
}

int batch_of(const RunSettings& settings) {
  if (settings.batch < 0 || settings.batch > Batch::capacity || settings.batch % 8 != 0)
    throw std::invalid_argument(
        fmt::format("`batch` must be a multiple of 8 up to {}, or 0 for the most", Batch::capacity));
  return settings.batch == 0 ? Batch::capacity : settings.batch;
}

/// Histograms of all points in a result, and what is packed of them when it is written [bytes].
double bytes_of_histograms(const Experiment& experiment) {
  double bins = 0;
  for (const PlacedPart& part : experiment.points.front().parts)
    if (const Detector* detector = detector_in(part.part))
      bins += static_cast<double>(detector->bins.x) * static_cast<double>(detector->bins.z);
  return 2.5 * sizeof(double) * bins * static_cast<double>(experiment.points.size());
}

/// Sums of every thread and of the whole, what threads keep at planes, and what follows from all that must
/// fit into the machine.
void require_memory(const Experiment& experiment, const Plan& plan, int threads) {
  const double needed = static_cast<double>(plan.sums) * sizeof(Sum) * (threads + 2) +
                        static_cast<double>(bytes_of_stages(plan)) * threads +
                        bytes_of_histograms(experiment);
  const double there =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (needed > 0.7 * there)
    throw std::invalid_argument(fmt::format(
        "the histograms of {} scan points need {:.1f} GiB on {} threads, and this machine has {:.1f} GiB\n"
        "  help: use fewer bins, fewer scan points or fewer threads",
        plan.points, needed / 1073741824, threads, there / 1073741824));
}

/// All particles may have been too few.
void warn_unless_precise(const Beamline& beamline, const Result& result, Provenance& provenance) {
  const double largest = largest_error(result), wanted = beamline.until->detected_error;
  if (largest <= wanted) return;
  const double needed = static_cast<double>(beamline.particles) * (largest / wanted) * (largest / wanted);
  provenance.warnings.push_back(
      fmt::format("all {} particles have flown, and the largest error of `detected` is {:.2g}, not {:.2g} as "
                  "`until` wants\n  help: `particles` of {:.2g} may be enough",
                  beamline.particles, largest, wanted, needed));
}

void require_same_setup(const Snapshot* start, const Setup& setup) {
  if (start != nullptr && start->fingerprint != setup.fingerprint())
    throw std::invalid_argument("the checkpoint does not match: " + setup.inputs().front().path +
                                " or the program has changed since it was written");
}

}  // namespace

bool Setup::is_model() const { return std::holds_alternative<LoadedModel>(contents_->loaded); }
const std::string& Setup::title() const {
  if (const auto* model = std::get_if<LoadedModel>(&contents_->loaded)) return model->points.front().title;
  return std::get<LoadedExperiment>(contents_->loaded).base.title;
}
std::size_t Setup::points() const {
  if (const auto* model = std::get_if<LoadedModel>(&contents_->loaded)) return model->points.size();
  return std::get<LoadedExperiment>(contents_->loaded).experiment.points.size();
}
const std::vector<InputText>& Setup::inputs() const { return inputs_of(contents_->loaded); }
const std::string& Setup::fingerprint() const { return contents_->fingerprint; }

Setup load(const std::filesystem::path& file, const Changes& changes) {
  return setup_of(load_any(load_file(file), changes), changes);
}
Setup load_beamline(const std::filesystem::path& file, const Changes& changes) {
  return setup_of(load_experiment(load_file(file), changes), changes);
}
Setup load_text(const std::string& text, const std::filesystem::path& folder, const Changes& changes) {
  return setup_of(load_any(file_of_text(text, folder), changes), changes);
}

Report check(const Setup& setup) {
  if (const auto* model = std::get_if<LoadedModel>(&setup.contents().loaded)) return {explain(*model), {}};
  const LoadedExperiment& loaded = experiment_of(setup);
  const Plan plan = make_plan(loaded.experiment);
  return {explain(loaded.experiment, plan) + report_of_fields(loaded.base),
          located(warnings_of(loaded.experiment, plan), loaded.places)};
}

Probed probe(const Setup& setup, const std::array<double, 3>& place, double time) {
  return probe_of(experiment_of(setup).base, {place[0], place[1], place[2]}, time);
}

std::optional<Result> run(const Setup& setup, const RunSettings& settings) {
  const LoadedExperiment& loaded = experiment_of(setup);
  require_same_setup(settings.start, setup);
  RunOptions options;
  options.isa = isa_called(settings.isa);
  options.threads = threads_of(settings);
  options.batch = batch_of(settings);
  options.stop = settings.stop;
  options.snapshot_seconds = settings.snapshot_seconds;
  options.start = settings.start;
  if (settings.snapshot)
    options.snapshot = [&](Snapshot snapshot) {
      snapshot.fingerprint = setup.fingerprint();
      snapshot.arguments = settings.arguments;
      snapshot.inputs = setup.inputs();
      settings.snapshot(snapshot);
    };

  Record record(setup, settings.arguments);
  record->instruction_set = name_of(options.isa);
  record->threads = options.threads;
  record->changes = options_of(setup.contents().changes);
  MomentsWanted moments;
  moments.everywhere = settings.transit == KeptTransit::totals || settings.transit == KeptTransit::images;
  const Plan plan = make_plan(loaded.experiment, options.threads, most_tree_cost, moments);
  Precision precision(loaded.experiment, plan);
  options.halvings = precision.halvings();
  options.enough = [&](const Sums& sums, int halvings) { return precision.is_enough(sums, halvings); };
  if (settings.progress)
    options.progress = [&](Progress progress) {
      progress.error = precision.error();
      settings.progress(progress);
    };
  require_memory(loaded.experiment, plan, options.threads);
  if (settings.start != nullptr && !fits(*settings.start, plan, options.halvings))
    throw std::invalid_argument("the checkpoint does not fit the plan");
  const std::vector<Diagnostic> warnings = located(warnings_of(loaded.experiment, plan), loaded.places);
  if (settings.planned) settings.planned(warnings);

  RunOutcome outcome = run(plan, options);
  Provenance provenance = record.finish();
  if (!outcome.finished) return std::nullopt;
  std::optional<FlightRecord> flight;
  std::string_view why_not_kept;
  const int halvings = outcome.halvings;
  if (settings.transit != KeptTransit::none)
    flight = record_of(loaded.experiment, plan, outcome,
                       settings.transit == KeptTransit::images ? KeptBins::images : KeptBins::totals,
                       why_not_kept);
  if (flight) flight->asked_for = moments.everywhere;
  Result result =
      finish(part_of(loaded.experiment, plan, halvings), part_of(plan, halvings), std::move(outcome.sums));
  if (precision.is_wanted() && halvings == 0)
    warn_unless_precise(loaded.experiment.points.front(), result, provenance);
  result.flight = std::move(flight);
  result.field_check = check_fields(plan, options.isa);
  for (const Diagnostic& warning : warnings) provenance.warnings.push_back(text_of(warning));
  for (const std::string& warning : warnings_of(result)) provenance.warnings.push_back(warning);
  if (moments.everywhere && !result.flight)
    provenance.warnings.push_back(fmt::format(
        "nothing is kept for `rabiline rescan`: {}\n  help: omit --transit, or change that", why_not_kept));
  result.provenance = std::move(provenance);
  return result;
}

Result rescan(const std::filesystem::path& path, const Changes& changes, const RunSettings& settings) {
  const KeptFlight kept = read_kept_flight(path);
  const Isa isa = isa_called(settings.isa);
  const Changes before = changes_of(kept.changes), now = joined(before, changes);
  const LoadedExperiment flown = load_experiment(file_of_stored(kept.inputs), before),
                         wanted = load_experiment(file_of_stored(kept.inputs), now);
  const Beamline &then = flown.experiment.points.front(), &later = wanted.experiment.points.front();
  if (then.particles != later.particles || then.seed != later.seed || then.until != later.until)
    throw std::invalid_argument("a rescan has the `particles`, the `seed` and the `until` of its flight");
  Record record(setup_of(wanted, now), settings.arguments);
  record->instruction_set = name_of(isa);
  record->changes = options_of(now);
  const std::vector<Diagnostic> warnings =
      located(warnings_of(wanted.experiment, make_plan(wanted.experiment)), wanted.places);
  if (settings.planned) settings.planned(warnings);
  Result result = rescan(flown.experiment, kept.record, wanted.experiment, isa);
  Provenance provenance = record.finish();
  for (const Diagnostic& warning : warnings) provenance.warnings.push_back(text_of(warning));
  for (const std::string& warning : warnings_of(result)) provenance.warnings.push_back(warning);
  result.provenance = std::move(provenance);
  return result;
}

std::vector<Track> trace(const Setup& setup, std::uint64_t first, std::uint64_t count,
                         const RunSettings& settings) {
  const LoadedExperiment& loaded = experiment_of(setup);
  const Isa isa = isa_called(settings.isa);
  if (settings.planned) {
    Experiment alone;
    alone.points = {loaded.base};
    settings.planned(located(warnings_of(alone, make_plan(alone)), loaded.places));
  }
  const std::uint64_t all = loaded.base.particles;
  if (first >= all)
    throw std::invalid_argument(
        fmt::format("there is no particle {}; the run has {}, counted from 0", first, all));
  std::vector<Track> tracks;
  for (std::uint64_t particle = first; particle < all && tracks.size() < count; ++particle)
    tracks.push_back(trace(loaded.base, particle, isa));
  return tracks;
}

SolvedModel solve(const Setup& setup, const std::vector<std::string>& arguments) {
  const auto* model = std::get_if<LoadedModel>(&setup.contents().loaded);
  if (model == nullptr)
    throw std::invalid_argument(
        fmt::format("{} is no model: it is flown, not solved", setup.inputs().front().path));
  Record record(setup, arguments);
  SolvedModel solved = solve_all(*model);
  solved.provenance = record.finish();
  return solved;
}

void write(const Result& result, const std::filesystem::path& path) { write_results(result, path); }
void write(const SolvedModel& solved, const std::filesystem::path& path) { write_motions(solved, path); }
void write(const std::vector<Track>& tracks, const std::string& title, const std::filesystem::path& path) {
  write_tracks(title, tracks, path);
}
void write(const Snapshot& snapshot, const std::filesystem::path& path) { write_checkpoint(snapshot, path); }
Snapshot read_snapshot(const std::filesystem::path& path) { return read_checkpoint(path); }

}  // namespace rabiline
