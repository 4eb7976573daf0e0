#include "rabiline.hpp"

#include <algorithm>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "core/isa.hpp"
#include "core/processors.hpp"
#include "core/version.hpp"
#include "face/cost.hpp"
#include "face/machine.hpp"
#include "face/memory.hpp"
#include "face/models.hpp"
#include "face/order.hpp"
#include "face/part_names.hpp"
#include "face/points.hpp"
#include "face/probe.hpp"
#include "face/record.hpp"
#include "face/warnings.hpp"
#include "plan/explain.hpp"
#include "rules/blind_screens.hpp"
#include "rules/field_lint.hpp"
#include "rules/part_effects.hpp"
#include "rules/warnings.hpp"
#include "scan/parameter_value.hpp"
#include "scan/resolved.hpp"
#include "simulation/append.hpp"
#include "simulation/field_check.hpp"
#include "simulation/form_flight.hpp"
#include "simulation/overflow.hpp"
#include "simulation/precision.hpp"
#include "simulation/rescan.hpp"
#include "simulation/run.hpp"
#include "simulation/trace.hpp"
#include "simulation/work.hpp"
#include "storage/checkpoint_file.hpp"
#include "storage/contents.hpp"
#include "storage/digest.hpp"
#include "storage/flight_file.hpp"
#include "storage/motion_file.hpp"
#include "storage/origin.hpp"
#include "storage/results_file.hpp"
#include "storage/tracks_file.hpp"

namespace rabiline {

struct Setup::Contents {
  Loaded loaded;
  Changes changes;
  std::string fingerprint;
  bool is_of_result = false;  // whose scan gives way to another
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

Setup setup_of(Loaded loaded, const Changes& changes, bool is_of_result = false) {
  std::string fingerprint = fingerprint_of(inputs_of(loaded), changes);
  return Setup(std::make_shared<const Setup::Contents>(
      Setup::Contents{std::move(loaded), changes, std::move(fingerprint), is_of_result}));
}

const LoadedExperiment& experiment_of(const Setup& setup) {
  if (setup.is_model())
    throw std::invalid_argument(
        fmt::format("{} is a model: it is solved, not flown", setup.inputs().front().path));
  return std::get<LoadedExperiment>(setup.contents().loaded);
}

/// What a run goes on from is its own beginning.
void require_same_run(const Snapshot& start, const Setup& setup, const RunSettings& settings) {
  const auto refuse = [&](std::string_view why) {
    throw std::invalid_argument(fmt::format("the checkpoint is of another run: {}", why));
  };
  if (start.fingerprint != setup.fingerprint())
    refuse(setup.inputs().front().path + " or the program has changed since it was written");
  if (!(start.shard == settings.shard)) refuse("of another shard");
  if (start.transit != settings.transit) refuse("other moments of the slowness are kept");
  if (start.max_memory != settings.max_memory) refuse("other memory may be used");
}

/// The changes of a result come first; its scan stays unless there is another.
Changes after(const Changes& before, const Changes& changes) {
  Changes all = joined(before, changes);
  if (changes.scan.empty() && !changes.without_scan) {
    all.scan = before.scan;
    all.without_scan = before.without_scan;
  }
  return all;
}
std::pair<LoadedFile, Changes> text_of(const std::filesystem::path& file, const Changes& changes) {
  if (!is_hdf5(file)) return {load_file(file), changes};
  Origin origin = read_origin(file);
  const Changes before = changes_of(origin.changes);
  return {file_of_stored(std::move(origin.inputs)), after(before, changes)};
}

Tracks tracks_of(const std::vector<Track>& paths, const Setup& setup) {
  return {setup.title(), parts_of(setup), resolved_parameters({experiment_of(setup).base}), paths};
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
  auto [text, all] = text_of(file, changes);
  const bool is_of_result = text.stored != nullptr;
  return setup_of(load_any(std::move(text), all), all, is_of_result);
}
Setup load_beamline(const std::filesystem::path& file, const Changes& changes) {
  auto [text, all] = text_of(file, changes);
  return setup_of(load_experiment(std::move(text), all), all);
}
Setup load(const Snapshot& snapshot) {
  const Changes changes = changes_of(snapshot.changes);
  return setup_of(load_any(file_of_stored(snapshot.inputs), changes), changes);
}
Setup load(const Setup& setup, const Changes& changes) {
  const auto& [loaded, before, fingerprint, is_of_result] = setup.contents();
  const Changes all = is_of_result ? after(before, changes) : changes;
  return setup_of(load_any(file_of_stored(inputs_of(loaded)), all), all, is_of_result);
}
Setup load_text(const std::string& text, const std::filesystem::path& folder, const Changes& changes) {
  return setup_of(load_any(file_of_text(text, folder), changes), changes);
}

std::optional<ParameterValue> value_of(const Setup& setup, const std::string& name) {
  const auto* loaded = std::get_if<LoadedExperiment>(&setup.contents().loaded);
  if (loaded == nullptr) return std::nullopt;
  if (name == "particles") return ParameterValue{static_cast<double>(loaded->base.particles), ""};
  const std::optional<ParsedQuantity> found = number_called(name, loaded->base);
  if (!found) return std::nullopt;
  return ParameterValue{found->value, std::string(si_unit_of(found->dimension))};
}

std::vector<PartName> parts_of(const Setup& setup) {
  const auto* loaded = std::get_if<LoadedExperiment>(&setup.contents().loaded);
  return loaded == nullptr ? std::vector<PartName>() : names_of(loaded->base.parts);
}

Report check(const Setup& setup, std::uint64_t max_memory) {
  if (const auto* model = std::get_if<LoadedModel>(&setup.contents().loaded)) return {explain(*model), {}};
  const LoadedExperiment& loaded = experiment_of(setup);
  const double begin = processor_time();
  const Form form = form_of(loaded.experiment, max_memory, false, 0);
  const Cost cost = cost_of(loaded.experiment, form, processor_time() - begin);
  return {explain(loaded.experiment, form.plan) + told(cost, loaded.experiment, form) +
              told_refusal(loaded.experiment, form, processors(), max_memory) +
              note_on_blind_screens(loaded.experiment) + report_of_parts(loaded.base) +
              report_of_fields(loaded.base),
          warnings_before(loaded, loaded.experiment, form.plan), cost};
}

std::string note_of(const Setup& setup) {
  return setup.is_model() ? std::string() : note_on_blind_screens(experiment_of(setup).experiment);
}

Probed probe(const Setup& setup, const std::array<double, 3>& place, double time) {
  return probe_of(experiment_of(setup).base, {place[0], place[1], place[2]}, time);
}

std::optional<Result> run(const Setup& setup, const RunSettings& settings) {
  const LoadedExperiment& loaded = experiment_of(setup);
  if (settings.start != nullptr) require_same_run(*settings.start, setup, settings);
  if (!settings.shard.exists())
    throw std::invalid_argument(
        fmt::format("there is no shard {} of {}", settings.shard.number, settings.shard.of));
  if (!settings.shard.is_whole() && loaded.base.until)
    throw std::invalid_argument(
        "a shard cannot know whether all of them are precise enough\n  help: fly without `until`, or in one "
        "piece");
  RunOptions options;
  options.shard = settings.shard;
  options.isa = isa_called(settings.isa);
  options.threads = threads_of(settings);
  options.batch = batch_of(settings);
  options.stop = settings.stop;
  options.snapshot_seconds = settings.snapshot_seconds;
  options.start = settings.start;
  options.ranks = settings.ranks;
  const bool leads = settings.ranks == nullptr || settings.ranks->leads();
  Record record(setup.inputs(), options_of(setup.contents().changes), settings.arguments);
  if (settings.start != nullptr) record.continue_from(*settings.start);
  const auto described = [&](Snapshot snapshot) {
    snapshot.fingerprint = setup.fingerprint();
    snapshot.arguments = settings.arguments;
    snapshot.inputs = setup.inputs();
    snapshot.changes = record->changes;
    snapshot.transit = settings.transit;
    snapshot.max_memory = settings.max_memory;
    snapshot.begun = record->start_time;
    snapshot.seconds = record.seconds();
    return snapshot;
  };
  if (settings.snapshot)
    options.snapshot = [&](Snapshot snapshot) { settings.snapshot(described(std::move(snapshot))); };

  record->instruction_set = name_of(options.isa);
  record->threads = options.threads;
  record->ranks = settings.ranks == nullptr ? 1 : settings.ranks->size();
  record->transit = settings.transit;
  record->max_memory = settings.max_memory;
  const bool keep_moments =
      settings.transit == KeptTransit::totals || settings.transit == KeptTransit::images;
  const Form form = form_of(loaded.experiment, settings.max_memory, keep_moments, options.threads);
  const Plan& plan = form.plan;
  record->slabs = form.slabs;
  Precision precision(loaded.experiment);
  options.halvings = precision.halvings();
  options.enough = [&](const Sums& sums, const std::vector<Straggler>& stragglers, int halvings) {
    return precision.is_enough(finish(form, loaded.experiment, sums, stragglers, halvings, options.isa,
                                      options.threads, keep_totals));
  };
  if (settings.progress)
    options.progress = [&](Progress progress) {
      progress.error = precision.reached().detected_error;
      progress.centre_error = precision.reached().centre_error;
      settings.progress(progress);
    };
  require_memory(
      loaded.experiment, form, settings.points ? points_at_once(loaded.experiment, form) : setup.points(),
      options.threads * (settings.ranks == nullptr ? 1 : settings.ranks->neighbours()), settings.max_memory);
  const FormFlight in_form(form, loaded.experiment, options.threads);
  if (settings.start != nullptr && !in_form.fits(*settings.start))
    throw std::invalid_argument("the checkpoint does not fit the plan");
  std::vector<Diagnostic> warnings;
  if (leads) {
    if (!settings.silent) warnings = warnings_before(loaded, loaded.experiment, plan);
    if (settings.planned) settings.planned(warnings);
    if (settings.ranks != nullptr) {
      Snapshot beginning = in_form.beginning();
      if (settings.start != nullptr) beginning.finished = settings.start->finished;
      give_order(described(std::move(beginning)), settings);
    }
  }

  RunOutcome outcome = in_form.run(options);
  Provenance provenance = record.finish();
  if (!leads || !outcome.finished || !settings.shard.is_whole()) return std::nullopt;
  std::optional<FlightRecord> flight;
  std::string_view why_not_kept;
  const int halvings = outcome.halvings;
  if (form.flies_in_slabs())
    why_not_kept = "scan points fly in slabs, since they do not follow from one flight";
  else if (settings.transit != KeptTransit::none)
    flight = record_of(form.flown, plan, outcome,
                       settings.transit == KeptTransit::images ? KeptBins::images : KeptBins::totals,
                       why_not_kept);
  if (flight) flight->asked_for = keep_moments;
  Effects effects;
  Result result = in_form.finish(std::move(outcome), options.isa, take_points(settings, effects));
  require_emission(result);
  result.flight = std::move(flight);
  result.field_check = check_fields(plan, options.isa);
  result.parameters = resolved_parameters(loaded.experiment.points);
  // What was told before the flight comes first: the command tells what is behind it.
  for (const Diagnostic& warning : warnings) provenance.warnings.push_back(text_of(warning));
  if (precision.is_wanted() && halvings == 0)
    warn_unless_precise(loaded.experiment.points.front(), result, provenance);
  for (const std::string& warning : effects.warnings(result)) provenance.warnings.push_back(warning);
  if (std::string warning = warning_of_overflow(form.flown, plan, result, options.isa); !warning.empty())
    provenance.warnings.push_back(std::move(warning));
  if (keep_moments && !result.flight)
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
  Record record(wanted.inputs, options_of(now), settings.arguments);
  record->instruction_set = name_of(isa);
  record->max_memory = settings.max_memory;
  const std::vector<Diagnostic> warnings =
      located(warnings_of(wanted.experiment, form_of(wanted.experiment, settings.max_memory, true, 0).plan),
              wanted.places);
  if (settings.planned) settings.planned(warnings);
  Effects effects;
  Result result = rescan(flown.experiment, kept.record, wanted.experiment,
                         settings.max_memory == 0 ? default_memory : settings.max_memory, isa,
                         threads_of(settings), take_points(settings, effects));
  result.parameters = resolved_parameters(wanted.experiment.points);
  Provenance provenance = record.finish();
  provenance.slabs = result.provenance.slabs;
  provenance.rescanned = true;
  for (const Diagnostic& warning : warnings) provenance.warnings.push_back(text_of(warning));
  for (const std::string& warning : effects.warnings(result)) provenance.warnings.push_back(warning);
  result.provenance = std::move(provenance);
  return result;
}

std::vector<Track> trace(const Setup& setup, std::uint64_t first, std::uint64_t count,
                         const RunSettings& settings) {
  const LoadedExperiment& loaded = experiment_of(setup);
  if (settings.planned) {
    Experiment alone;
    alone.points = {loaded.base};
    settings.planned(warnings_before(loaded, alone, make_plan(alone)));
  }
  const std::uint64_t all = loaded.base.particles;
  if (first >= all)
    throw std::invalid_argument(
        fmt::format("there is no particle {}; the run has {}, counted from 0", first, all));
  const Plan plan = plan_of_tracks(loaded.base);
  std::vector<Track> tracks(std::min(count, all - first));
  for (Track& track : tracks) {
    if (settings.stop != nullptr && *settings.stop) throw Stopped();
    track = trace(loaded.base, plan, first++, isa_called(settings.isa));
  }
  return tracks;
}

SolvedModel solve(const Setup& setup, const std::vector<std::string>& arguments,
                  const std::atomic<bool>* stop) {
  const auto* model = std::get_if<LoadedModel>(&setup.contents().loaded);
  if (model == nullptr)
    throw std::invalid_argument(
        fmt::format("{} is not a model: it is flown, not solved", setup.inputs().front().path));
  Record record(setup.inputs(), options_of(setup.contents().changes), arguments);
  SolvedModel solved = solve_all(*model, [stop] {
    if (stop != nullptr && *stop) throw Stopped();
  });
  solved.provenance = record.finish();
  return solved;
}

void write(const Result& result, const std::filesystem::path& path) { write_results(result, path); }
void write(const SolvedModel& solved, const std::filesystem::path& path) { write_motions(solved, path); }
void write(const std::vector<Track>& paths, const Setup& setup, const std::filesystem::path& path) {
  write_tracks(tracks_of(paths, setup), path);
}
std::vector<std::byte> image_of(const std::vector<Track>& paths, const Setup& setup) {
  return image_of(tracks_of(paths, setup));
}
void write(const Snapshot& snapshot, const std::filesystem::path& path) { write_checkpoint(snapshot, path); }
Snapshot read_snapshot(const std::filesystem::path& path) { return read_checkpoint(path); }

std::string verify(const std::filesystem::path& path) { return verified_digest(path); }

Reproduced reproduce(const std::filesystem::path& path, RunSettings settings) {
  const Origin origin = read_origin(path);
  const Setup setup = load(path);
  settings.transit = origin.transit;
  settings.max_memory = origin.rescanned ? 0 : origin.max_memory;  // which no run was given
  const auto compared = [&](auto result) {
    std::vector<std::string> paths = differing(path, image_of(result));
    if (origin.rescanned && !paths.empty())
      throw std::invalid_argument(fmt::format(
          "{}: `rabiline rescan` worked it out from a flight for another scan, whose bits a run of "
          "its own scan does not have\n  help: reproduce the file that it was made of, and rescan "
          "that again",
          path.string()));
    return Reproduced{std::move(result), std::move(paths)};
  };
  if (setup.is_model()) return compared(solve(setup, settings.arguments, settings.stop));
  std::optional<Result> result = run(setup, settings);
  if (!result) throw Stopped();
  return compared(std::move(*result));
}

}  // namespace rabiline
