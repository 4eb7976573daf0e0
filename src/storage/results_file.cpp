#include "storage/results_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/units.hpp"
#include "particle/batch.hpp"
#include "storage/detector_groups.hpp"
#include "storage/flight_file.hpp"
#include "storage/nexus.hpp"
#include "storage/parameters_group.hpp"
#include "storage/provenance.hpp"
#include "storage/tally_groups.hpp"

namespace rabiline {
namespace {

using hdf5::GroupWriter;
using hdf5::OverPoints;
using nexus::Axis;

std::vector<Axis> scan_axes(const Result& result) {
  nexus::Names names({"detected",
                      "detected_errors",
                      "detected_covariance",
                      "detected_of_all",
                      "detected_of_all_errors",
                      "count_rate",
                      "count_rate_errors",
                      "detector_index",
                      "detector_names",
                      "title",
                      "counts",
                      "counts_errors",
                      "x",
                      "x_edges",
                      "z",
                      "z_edges",
                      "level_index",
                      "level_index_labels",
                      "levels",
                      "levels_errors",
                      "offset_x",
                      "offset_z",
                      "transit"});
  std::vector<Axis> axes;
  for (const ScanAxis& scanned : result.axes) {
    std::string name = scanned.parameter.substr(0, scanned.parameter.find(','));  // of several, the first
    std::replace(name.begin(), name.end(), '.', '_');
    name = names.claim(name, {"", "_labels"});
    if (!scanned.dimension) {
      axes.push_back(nexus::index_axis(name, scanned.parameter, scanned.labels));
      axes.back().values = scanned.values;
    } else {
      const std::string_view si_unit = si_unit_of(*scanned.dimension);
      const std::string units(si_unit.empty() ? "1" : si_unit);
      axes.push_back({name, units, nexus::long_name(scanned.parameter, units), scanned.values, {}, ""});
    }
    axes.back().parameter = scanned.parameter;
  }
  return axes;
}

/// Parts may be called like our own groups.
nexus::Names names_of_entry() {
  return nexus::Names({"title", "program_name", "law", "species", "particles", "solid_angle",
                       "aimed_fraction", "rate", "scan", "instrument", "fates", "flight", "field_check",
                       "parameters", "simulation"});
}

constexpr const char* per_point = " at each scan point (row-major)";

void write_summary(const GroupWriter& entry, const Result& result, std::size_t points) {
  entry.number("particles", result.particles,
               {{"units", "1"}, {"long_name", "particles emitted per scan point"}});
  if (result.solid_angle > 0) {
    entry.number("solid_angle", result.solid_angle,
                 {{"units", "sr"}, {"long_name", "solid angle that the source is aimed at (sr)"}});
  }
  if (!result.aimed_fraction.empty()) {
    entry.over_points("aimed_fraction", {{}, {points}, {}}, result.aimed_fraction,
                      {{"units", "1"},
                       {"long_name", std::string("share of all particles leaving the source that one aimed "
                                                 "particle of weight 1 stands for") +
                                         per_point}});
  }
  if (result.rate > 0) {
    entry.number("rate", result.rate,
                 {{"units", "1/s"}, {"long_name", "particles leaving the source (1/s)"}});
  }
}

/// Texts are as wide as the longest of all points, so that they wait for the last one.
void write_texts(const GroupWriter& entry, const Result& result, std::size_t points) {
  const auto write = [&](const char* name, const char* meaning, std::vector<std::string> texts) {
    if (texts.size() == 1) texts.resize(points, texts.front());
    entry.dataset(name, {points}, texts, {{"long_name", std::string(meaning) + per_point}});
  };
  write("law", "law of motion", result.laws);
  write("species", "species", result.species);
}

void write_fates(const GroupWriter& entry, const Result& result, std::size_t points) {
  const std::size_t lines = result.fates.size();
  std::vector<std::string> fate, where;
  std::vector<std::uint64_t> high, low;
  std::vector<double> particles;
  for (const FateResult& line : result.fates) {
    fate.push_back(line.fate);
    where.push_back(line.where);
    high.insert(high.end(), line.quanta_high.begin(), line.quanta_high.end());
    low.insert(low.end(), line.quanta_low.begin(), line.quanta_low.end());
    particles.insert(particles.end(), line.particles.begin(), line.particles.end());
  }
  const GroupWriter fates = entry.group("fates", "NXcollection");
  fates.attribute("quanta_per_particle", quanta_per_particle);
  fates.attribute("meaning",
                  "particles by fate (rows) and scan point (columns, row-major); the rows add up to emitted; "
                  "quanta = high * 2^64 + low");
  fates.dataset("fate", {lines}, fate, {{"long_name", "what became of the particles"}});
  fates.dataset("where", {lines}, where, {{"long_name", "the part where it happened"}});
  const OverPoints rows{{lines}, {points}, {}}, row{{}, {points}, {}};
  fates.over_points("particles", rows, particles, {{"units", "1"}, {"long_name", "particles"}});
  fates.over_points("quanta_high", rows, high, {{"units", "1"}, {"long_name", "quanta, upper 64 bits"}});
  fates.over_points("quanta_low", rows, low, {{"units", "1"}, {"long_name", "quanta, lower 64 bits"}});
  if (const std::size_t levels = result.ledger_levels.size(); levels > 0) {
    std::vector<double> by_level;
    for (const FateResult& line : result.fates)
      by_level.insert(by_level.end(), line.by_level.begin(), line.by_level.end());
    fates.dataset("level", {levels}, result.ledger_levels,
                  {{"long_name", "level that particles were prepared in"}});
    fates.over_points("particles_by_level", {{lines}, {points}, {levels}}, by_level,
                      {{"units", "1"}, {"long_name", "particles by the level that they were prepared in"}});
    fates.over_points(
        "emitted_by_level", {{}, {points}, {levels}}, result.emitted_by_level,
        {{"units", "1"}, {"long_name", "particles emitted by the level that they were prepared in"}});
  }
  fates.over_points("emitted", row, result.emitted, {{"units", "1"}, {"long_name", "particles emitted"}});
  fates.over_points("emitted_quanta_high", row, result.emitted_quanta_high,
                    {{"units", "1"}, {"long_name", "quanta emitted, upper 64 bits"}});
  fates.over_points("emitted_quanta_low", row, result.emitted_quanta_low,
                    {{"units", "1"}, {"long_name", "quanta emitted, lower 64 bits"}});
}

void write_simulation(const GroupWriter& entry, const Result& result) {
  const GroupWriter simulation = nexus::write_provenance(entry, result.provenance);
  simulation.dataset("transit", {1}, std::vector{static_cast<std::uint64_t>(result.provenance.transit)},
                     {{"long_name", "kept of the slowness: 0 totals if small, 1 none, 2 totals, 3 images"}});
  simulation.dataset("max_memory", {1}, std::vector{result.provenance.max_memory},
                     {{"units", "byte"}, {"long_name", "memory that the run was given; 0: none was stated"}});
  simulation.dataset("slabs", {1}, std::vector{result.provenance.slabs},
                     {{"long_name", "of scan points, worked out one behind the other from one flight"}});
  if (result.provenance.rescanned)
    simulation.dataset("rescanned", {1}, std::vector{std::uint64_t{1}},
                       {{"long_name", "1: worked out from a flight that was kept"}});
  simulation.number("seed", result.seed, {{"units", "1"}});
  for (const auto& choice : choices<ScanParticles>) {
    if (choice.value != result.particles_mode) continue;
    simulation.text("particles", std::string(choice.word), {{"long_name", std::string(choice.meaning)}});
  }
}

/// How far flights in steps are from an independent integration.
void write_field_check(const GroupWriter& entry, const FieldCheck& check) {
  const GroupWriter group = entry.group("field_check", "NXcollection");
  group.number("particles", check.particles,
               {{"units", "1"}, {"long_name", "particles integrated both ways; 0: none could be"}});
  const auto put = [&](const char* name, double value, const char* meaning) {
    group.number(name, value, {{"units", "1"}, {"long_name", meaning}});
  };
  put("place", check.place, "largest deviation of the place, over the length of the stretch");
  put("direction", check.direction, "largest deviation of the direction (rad)");
  put("spin", check.spin, "largest deviation of the spin, a unit vector");
  put("levels", check.levels, "largest deviation of the probability of a level of an atom");
  put("tolerance", check.tolerance, "what steps were chosen for");
  group.number(
      "approximated", std::uint64_t{check.approximated},
      {{"units", "1"},
       {"long_name", "1: levels that are driven in the rotating-wave approximation are not among them"}});
}

/// What nobody asked for is kept where it is a fifth of the file at most, or small anyway.
bool is_worth_its_room(const FlightRecord& flight, std::size_t file) {
  constexpr std::size_t small = 512 << 10;
  return flight.asked_for || size_in_file(flight) <= std::max(file / 4, small);
}

}  // namespace

struct ResultsFile::Contents {
  explicit Contents(std::filesystem::path where) : path(std::move(where)) {}

  void begin(const Result& points) {
    scan = scan_axes(points);
    slab.all = nexus::count_of_points(scan);
    const bool in_one = points.emitted.size() == slab.all;
    file.emplace(path, in_one ? hdf5::FileWriter::Place::memory : hdf5::FileWriter::Place::disk);
    entry.emplace(
        nexus::write_entry(*file, path.filename().string(), points.title, points.provenance.version));
  }

  void add(const Result& points) {
    if (!file) begin(points);
    slab.count = points.emitted.size();
    file->turn_to(slab);
    write_summary(*entry, points, slab.all);
    nexus::Names names = names_of_entry();
    nexus::write_detectors(*entry, points, scan, names);
    nexus::write_monitors_and_tallies(*entry, points, scan, names);
    write_fates(*entry, points, slab.all);
    slab.first += slab.count;
    file->require_written();
  }

  void end(const Result& rest) {
    file->end_slabs();
    write_texts(*entry, rest, slab.all);
    if (rest.field_check) write_field_check(*entry, *rest.field_check);
    nexus::write_parameters(*entry, rest.parameters);
    write_simulation(*entry, rest);
    if (rest.flight && is_worth_its_room(*rest.flight, file->size()))
      nexus::write_flight(*entry, *rest.flight);
    entry.reset();
  }

  std::filesystem::path path;
  hdf5::Slab slab{0, 0, 0};
  std::vector<Axis> scan{};
  std::optional<hdf5::FileWriter> file{};
  std::optional<GroupWriter> entry{};
};

ResultsFile::ResultsFile(std::filesystem::path path)
    : contents_(std::make_unique<Contents>(std::move(path))) {}
ResultsFile::~ResultsFile() = default;
void ResultsFile::add(const Result& points) { contents_->add(points); }
void ResultsFile::save(const Result& rest) {
  contents_->end(rest);
  contents_->file->save();
}

void write_results(const Result& result, const std::filesystem::path& path) {
  ResultsFile file(path);
  file.add(result);
  file.save(result);
}

std::vector<std::byte> image_of(const Result& result) {
  ResultsFile::Contents contents(hdf5::in_memory);
  contents.add(result);
  contents.end(result);
  return contents.file->image();
}

}  // namespace rabiline
