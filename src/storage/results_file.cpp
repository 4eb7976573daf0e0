#include "storage/results_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/units.hpp"
#include "particle/batch.hpp"
#include "storage/flight_file.hpp"
#include "storage/nexus.hpp"
#include "storage/parameters_group.hpp"
#include "storage/provenance.hpp"
#include "storage/tally_groups.hpp"

namespace rabiline {
namespace {

using hdf5::GroupWriter;
using hdf5::Shape;
using nexus::Axis;
using nexus::Signal;

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

std::size_t count_of_points(const Result& result) {
  std::size_t points = 1;
  for (const ScanAxis& axis : result.axes) points *= axis.values.size();
  return points;
}

std::vector<Axis> behind(std::vector<Axis> axes, const std::vector<Axis>& more) {
  axes.insert(axes.end(), more.begin(), more.end());
  return axes;
}

/// Names under which each detector's groups stand in /entry; parts may be called like our own groups.
nexus::Names names_of_entry() {
  return nexus::Names({"title", "program_name", "law", "species", "particles", "solid_angle",
                       "aimed_fraction", "rate", "scan", "instrument", "fates", "flight", "field_check",
                       "parameters", "simulation"});
}
std::vector<std::string> group_names(const Result& result, nexus::Names& names) {
  std::vector<std::string> claimed;
  for (const DetectorResult& detector : result.detectors) {
    claimed.push_back(names.claim(detector.name, {"", "_x", "_z", "_levels"}));
  }
  return claimed;
}

const std::string& label_of(const DetectorResult& detector) {
  return detector.label.empty() ? detector.name : detector.label;
}

void write_summary(const GroupWriter& entry, const Result& result) {
  const std::size_t points = count_of_points(result);
  const std::string per_point = " at each scan point (row-major)";
  entry.dataset("law", {points}, result.laws, {{"long_name", "law of motion" + per_point}});
  entry.dataset("species", {points}, result.species, {{"long_name", "species" + per_point}});
  entry.number("particles", result.particles,
               {{"units", "1"}, {"long_name", "particles emitted per scan point"}});
  if (result.solid_angle > 0) {
    entry.number("solid_angle", result.solid_angle,
                 {{"units", "sr"}, {"long_name", "solid angle that the source is aimed at (sr)"}});
  }
  if (!result.aimed_fraction.empty()) {
    entry.dataset("aimed_fraction", {points}, result.aimed_fraction,
                  {{"units", "1"},
                   {"long_name",
                    "share of all particles leaving the source that one aimed particle of weight 1 "
                    "stands for" +
                        per_point}});
  }
  if (result.rate > 0) {
    entry.number("rate", result.rate,
                 {{"units", "1/s"}, {"long_name", "particles leaving the source (1/s)"}});
  }
}

/// One quantity of all detectors, one behind the other.
std::vector<double> joined(const Result& result, std::vector<double> DetectorResult::*quantity) {
  std::vector<double> all;
  for (const DetectorResult& detector : result.detectors) {
    all.insert(all.end(), (detector.*quantity).begin(), (detector.*quantity).end());
  }
  return all;
}

void write_covariance(const GroupWriter& scan, const Result& result) {
  const std::vector<double> covariance = joined(result, &DetectorResult::detected_covariance);
  if (covariance.empty()) return;
  const std::size_t points = count_of_points(result);
  Shape shape{points, points};
  if (result.detectors.size() > 1) shape.insert(shape.begin(), result.detectors.size());
  scan.dataset("detected_covariance", shape, covariance,
               {{"units", "1"}, {"long_name", "covariance of detected between scan points (row-major)"}});
}

/// What an aimed source hides: the fraction of all particles that leave it.
void write_detected_of_all(const GroupWriter& scan, const Result& result, const std::vector<Axis>& axes) {
  const std::vector<double> share = joined(result, &DetectorResult::detected_of_all),
                            errors = joined(result, &DetectorResult::detected_of_all_errors);
  if (share.empty()) return;
  Shape shape;
  for (const Axis& axis : axes) shape.push_back(axis.values.size());
  scan.dataset("detected_of_all", shape, share,
               {{"units", "1"}, {"long_name", "fraction detected of all particles leaving the source"}});
  scan.dataset("detected_of_all_errors", shape, errors,
               {{"units", "1"}, {"long_name", "standard errors of detected_of_all"}});
}

/// Counts per second, where the source's rate is stated.
void write_count_rate(const GroupWriter& scan, const Result& result, const std::vector<Axis>& axes) {
  const std::vector<double> rate = joined(result, &DetectorResult::count_rate),
                            errors = joined(result, &DetectorResult::count_rate_errors);
  if (rate.empty()) return;
  Shape shape;
  for (const Axis& axis : axes) shape.push_back(axis.values.size());
  scan.dataset("count_rate", shape, rate,
               {{"units", "1/s"}, {"long_name", "counts per second, with the background (1/s)"}});
  scan.dataset("count_rate_errors", shape, errors,
               {{"units", "1/s"}, {"long_name", "standard errors of count_rate (1/s)"}});
}

void write_scan(const GroupWriter& entry, const Result& result) {
  std::vector<Axis> axes = scan_axes(result);
  std::string interpretation, of_detector;
  if (result.detectors.size() > 1) {
    std::vector<std::string> labels;
    for (const DetectorResult& detector : result.detectors) labels.push_back(label_of(detector));
    axes.insert(axes.begin(), nexus::index_axis("detector_index", "detector", labels));
    axes.front().labels.clear();  // they stand in detector_names
    interpretation = axes.size() > 2 ? "image" : "spectrum";
  } else {
    of_detector = " by " + label_of(result.detectors.front());
  }
  const std::vector<double> detected = joined(result, &DetectorResult::detected),
                            errors = joined(result, &DetectorResult::detected_errors);
  const GroupWriter scan =
      nexus::write_data(entry, "scan", result.title,
                        {"detected", "1", "fraction of emitted particles detected" + of_detector, detected,
                         errors, interpretation},
                        axes);
  std::vector<std::string> names;
  for (const DetectorResult& detector : result.detectors) names.push_back(detector.name);
  scan.dataset("detector_names", {names.size()}, names, {{"long_name", "names of the detectors"}});
  write_covariance(scan, result);
  write_detected_of_all(scan, result, axes);
  write_count_rate(scan, result, axes);
  entry.attribute("default", "scan");
}

Axis centres_of(const BinAxis& bins, const DetectorResult& detector) {
  const std::string name = detector.offset_x.empty() ? bins.name : bins.name + " from the detector's centre";
  return {bins.name, "m", nexus::long_name(name, "m"), nexus::centres_of(bins.edges), {}, ""};
}

void write_edges(const GroupWriter& data, const BinAxis& bins) {
  data.dataset(bins.name + "_edges", {bins.edges.size()}, bins.edges,
               {{"units", "m"}, {"long_name", fmt::format("edges of the bins along {} (m)", bins.name)}});
}

/// The slowness of what it catches, one group for each species.
void write_transits(const GroupWriter& image, const std::string& title, const DetectorResult& detector) {
  for (std::size_t k = 0; k < detector.transits.size(); ++k) {
    const TransitResult& transit = detector.transits[k];
    const Axis slowness{
        "slowness", "s/m", nexus::long_name("slowness", "s/m"), nexus::centres_of(transit.edges), {}, ""};
    std::vector<Axis> axes{nexus::index_axis("path", "levels before and behind the fields", transit.paths),
                           slowness};
    const bool one_path = transit.paths.size() == 1;  // viewers take an axis of length 1 for a mistake
    if (one_path) axes.erase(axes.begin());
    const GroupWriter data =
        nexus::write_data(image, k == 0 ? "transit" : fmt::format("transit_{}", k + 1),
                          transit.species.empty() ? title : fmt::format("{}, {}", title, transit.species),
                          {"caught", "1", "particles caught if their levels are those of the path",
                           transit.caught, transit.errors, "spectrum"},
                          axes);
    if (one_path)
      data.dataset("path_labels", {1}, transit.paths, {{"long_name", "levels before and behind the fields"}});
    data.dataset("slowness_edges", {transit.edges.size()}, transit.edges,
                 {{"units", "s/m"}, {"long_name", "edges of the cells of the slowness 1/v (s/m)"}});
    data.number(
        "distance", detector.y,
        {{"units", "m"}, {"long_name", "distance from the source (m): times slowness, the time of flight"}});
  }
}

void write_detector(const GroupWriter& entry, const std::string& name, const Result& result,
                    const DetectorResult& detector) {
  const std::vector<Axis> scan = scan_axes(result);
  const Axis x = centres_of(detector.x, detector), z = centres_of(detector.z, detector);
  const std::string title = fmt::format("{}: {}", result.title, label_of(detector));

  const GroupWriter image = nexus::write_data(
      entry, name, title,
      {"counts", "1", "particles per bin", detector.counts, detector.counts_errors, "image"},
      behind(scan, {x, z}));
  write_edges(image, detector.x);
  write_edges(image, detector.z);
  image.number("background", detector.background,
               {{"units", "1/s"}, {"long_name", "counts per second without a beam (1/s)"}});

  for (const auto& [axis, offsets] :
       {std::pair{"offset_x", detector.offset_x}, {"offset_z", detector.offset_z}})
    if (!offsets.empty())
      image.dataset(
          axis, {offsets.size()}, offsets,
          {{"units", "m"}, {"long_name", "the detector's centre at each scan point (row-major) (m)"}});
  write_transits(image, title, detector);
  const auto write_histogram = [&](const BinAxis& bins, const Axis& axis, const std::vector<double>& counts,
                                   const std::vector<double>& errors) {
    const GroupWriter histogram =
        nexus::write_data(entry, fmt::format("{}_{}", name, bins.name), title,
                          {"counts", "1", "particles per bin", counts, errors, ""}, behind(scan, {axis}));
    write_edges(histogram, bins);
  };
  write_histogram(detector.x, x, detector.counts_x, detector.counts_x_errors);
  write_histogram(detector.z, z, detector.counts_z, detector.counts_z_errors);

  nexus::write_data(entry, name + "_levels", title,
                    {"levels", "1", "fraction of detected particles in the level", detector.levels,
                     detector.levels_errors, ""},
                    behind(scan, {nexus::index_axis("level_index", "level", detector.level_labels)}));
}

void write_instrument(const GroupWriter& entry, const std::vector<std::string>& names, const Result& result) {
  const GroupWriter instrument = entry.group("instrument", "NXinstrument");
  for (std::size_t i = 0; i < names.size(); ++i) {
    const DetectorResult& detector = result.detectors[i];
    const GroupWriter group = instrument.group(detector.name, "NXdetector");
    group.number("distance", detector.y, {{"units", "m"}, {"long_name", "distance from the source (m)"}});
    group.text("local_name", label_of(detector));
    group.link("data", fmt::format("/entry/{}/counts", names[i]));
    group.link("data_errors", fmt::format("/entry/{}/counts_errors", names[i]));
  }
}

void write_fates(const GroupWriter& entry, const Result& result) {
  const std::size_t points = count_of_points(result), lines = result.fates.size();
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
  fates.dataset("particles", {lines, points}, particles, {{"units", "1"}, {"long_name", "particles"}});
  fates.dataset("quanta_high", {lines, points}, high,
                {{"units", "1"}, {"long_name", "quanta, upper 64 bits"}});
  fates.dataset("quanta_low", {lines, points}, low, {{"units", "1"}, {"long_name", "quanta, lower 64 bits"}});
  if (const std::size_t levels = result.ledger_levels.size(); levels > 0) {
    std::vector<double> by_level;
    for (const FateResult& line : result.fates)
      by_level.insert(by_level.end(), line.by_level.begin(), line.by_level.end());
    fates.dataset("level", {levels}, result.ledger_levels,
                  {{"long_name", "level that particles were prepared in"}});
    fates.dataset("particles_by_level", {lines, points, levels}, by_level,
                  {{"units", "1"}, {"long_name", "particles by the level that they were prepared in"}});
    fates.dataset(
        "emitted_by_level", {points, levels}, result.emitted_by_level,
        {{"units", "1"}, {"long_name", "particles emitted by the level that they were prepared in"}});
  }
  fates.dataset("emitted", {points}, result.emitted, {{"units", "1"}, {"long_name", "particles emitted"}});
  fates.dataset("emitted_quanta_high", {points}, result.emitted_quanta_high,
                {{"units", "1"}, {"long_name", "quanta emitted, upper 64 bits"}});
  fates.dataset("emitted_quanta_low", {points}, result.emitted_quanta_low,
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
}

/// What nobody asked for is kept where it is a fifth of the file at most, or small anyway.
bool is_worth_its_room(const FlightRecord& flight, std::size_t file) {
  constexpr std::size_t small = 512 << 10;
  return flight.asked_for || size_in_file(flight) <= std::max(file / 4, small);
}

/// All but where it comes from.
void write_content(const GroupWriter& entry, const Result& result) {
  write_summary(entry, result);
  if (!result.detectors.empty()) write_scan(entry, result);
  nexus::Names taken = names_of_entry();
  const std::vector<std::string> names = group_names(result, taken);
  for (std::size_t i = 0; i < names.size(); ++i) write_detector(entry, names[i], result, result.detectors[i]);
  nexus::write_monitors_and_tallies(entry, result, scan_axes(result), taken);
  write_instrument(entry, names, result);
  write_fates(entry, result);
  if (result.field_check) write_field_check(entry, *result.field_check);
  nexus::write_parameters(entry, result.parameters);
}

GroupWriter entry_of(hdf5::FileWriter& file, const Result& result, const std::filesystem::path& path) {
  return nexus::write_entry(file, path.filename().string(), result.title, result.provenance.version);
}

hdf5::FileWriter file_of(const Result& result, const std::filesystem::path& path) {
  hdf5::FileWriter file(path);
  {
    const GroupWriter entry = entry_of(file, result, path);
    write_content(entry, result);
    write_simulation(entry, result);
    if (result.flight && is_worth_its_room(*result.flight, file.size()))
      nexus::write_flight(entry, *result.flight);
  }
  return file;
}

}  // namespace

void write_results(const Result& result, const std::filesystem::path& path) { file_of(result, path).save(); }
std::vector<std::byte> image_of(const Result& result) { return file_of(result, hdf5::in_memory).image(); }

}  // namespace rabiline
