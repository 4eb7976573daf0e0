#include "storage/detector_groups.hpp"

#include <fmt/format.h>

#include "storage/tally_groups.hpp"

namespace rabiline::nexus {
namespace {

using hdf5::GroupWriter;
using hdf5::OverPoints;
using hdf5::Shape;

const std::string& label_of(const DetectorResult& detector) {
  return detector.label.empty() ? detector.name : detector.label;
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
  const std::size_t points = result.emitted.size();
  Shape shape{points, points};
  if (result.detectors.size() > 1) shape.insert(shape.begin(), result.detectors.size());
  scan.dataset("detected_covariance", shape, covariance,
               {{"units", "1"}, {"long_name", "covariance of detected between scan points (row-major)"}});
}

/// What an aimed source hides: the fraction of all particles that leave it.
void write_detected_of_all(const GroupWriter& scan, const Result& result, const OverPoints& shape) {
  const std::vector<double> share = joined(result, &DetectorResult::detected_of_all),
                            errors = joined(result, &DetectorResult::detected_of_all_errors);
  if (share.empty()) return;
  scan.over_points("detected_of_all", shape, share,
                   {{"units", "1"}, {"long_name", "fraction detected of all particles leaving the source"}});
  scan.over_points("detected_of_all_errors", shape, errors,
                   {{"units", "1"}, {"long_name", "standard errors of detected_of_all"}});
}

/// Counts per second, where the source's rate is stated.
void write_count_rate(const GroupWriter& scan, const Result& result, const OverPoints& shape) {
  const std::vector<double> rate = joined(result, &DetectorResult::count_rate),
                            errors = joined(result, &DetectorResult::count_rate_errors);
  if (rate.empty()) return;
  scan.over_points("count_rate", shape, rate,
                   {{"units", "1/s"}, {"long_name", "counts per second, with the background (1/s)"}});
  scan.over_points("count_rate_errors", shape, errors,
                   {{"units", "1/s"}, {"long_name", "standard errors of count_rate (1/s)"}});
}

void write_scan(const GroupWriter& entry, const Result& result, const std::vector<Axis>& scanned) {
  Axes axes{{}, scanned, {}};
  std::string interpretation, of_detector;
  if (result.detectors.size() > 1) {
    std::vector<std::string> labels;
    for (const DetectorResult& detector : result.detectors) labels.push_back(label_of(detector));
    axes.before = {index_axis("detector_index", "detector", labels)};
    axes.before.front().labels.clear();  // they stand in detector_names
    interpretation = scanned.size() > 1 ? "image" : "spectrum";
  } else {
    of_detector = " by " + label_of(result.detectors.front());
  }
  const std::vector<double> detected = joined(result, &DetectorResult::detected),
                            errors = joined(result, &DetectorResult::detected_errors);
  const GroupWriter scan =
      write_data(entry, "scan", result.title,
                 {"detected", "1", "fraction of emitted particles detected" + of_detector, detected, errors,
                  interpretation},
                 axes);
  std::vector<std::string> names;
  for (const DetectorResult& detector : result.detectors) names.push_back(detector.name);
  scan.dataset("detector_names", {names.size()}, names, {{"long_name", "names of the detectors"}});
  write_covariance(scan, result);
  write_detected_of_all(scan, result, shape_of(axes));
  write_count_rate(scan, result, shape_of(axes));
  entry.attribute("default", "scan");
}

Axis axis_of(const BinAxis& bins, const DetectorResult& detector) {
  const std::string name = detector.offset_x.empty() ? bins.name : bins.name + " from the detector's centre";
  return {bins.name, "m", long_name(name, "m"), centres_of(bins.edges), {}, ""};
}

void write_edges(const GroupWriter& data, const BinAxis& bins) {
  data.dataset(bins.name + "_edges", {bins.edges.size()}, bins.edges,
               {{"units", "m"}, {"long_name", fmt::format("edges of the bins along {} (m)", bins.name)}});
}

/// The slowness of what it catches, one group for each species.
void write_transits(const GroupWriter& image, const std::string& title, const DetectorResult& detector) {
  for (std::size_t k = 0; k < detector.transits.size(); ++k) {
    const TransitResult& transit = detector.transits[k];
    const Axis slowness{"slowness", "s/m", long_name("slowness", "s/m"), centres_of(transit.edges), {}, ""};
    std::vector<Axis> axes{index_axis("path", "levels before and behind the fields", transit.paths),
                           slowness};
    const bool one_path = transit.paths.size() == 1;  // viewers take an axis of length 1 for a mistake
    if (one_path) axes.erase(axes.begin());
    const GroupWriter data =
        write_data(image, k == 0 ? "transit" : fmt::format("transit_{}", k + 1),
                   transit.species.empty() ? title : fmt::format("{}, {}", title, transit.species),
                   {"caught", "1", "particles caught if their levels are those of the path", transit.caught,
                    transit.errors, "spectrum"},
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
                    const DetectorResult& detector, const std::vector<Axis>& scan) {
  const Axis x = axis_of(detector.x, detector), z = axis_of(detector.z, detector);
  const std::string title = fmt::format("{}: {}", result.title, label_of(detector));

  const GroupWriter image =
      write_data(entry, name, title,
                 {"counts", "1", "particles per bin", detector.counts, detector.counts_errors, "image"},
                 Axes{{}, scan, {x, z}});
  write_edges(image, detector.x);
  write_edges(image, detector.z);
  image.number("background", detector.background,
               {{"units", "1/s"}, {"long_name", "counts per second without a beam (1/s)"}});

  for (const auto& [axis, offsets] :
       {std::pair{"offset_x", detector.offset_x}, {"offset_z", detector.offset_z}})
    if (!offsets.empty())
      image.over_points(
          axis, {{}, {count_of_points(scan)}, {}}, offsets,
          {{"units", "m"}, {"long_name", "the detector's centre at each scan point (row-major) (m)"}});
  if (!image.goes_on()) write_transits(image, title, detector);
  const auto write_histogram = [&](const BinAxis& bins, const Axis& axis, const std::vector<double>& counts,
                                   const std::vector<double>& errors) {
    const GroupWriter histogram =
        write_data(entry, fmt::format("{}_{}", name, bins.name), title,
                   {"counts", "1", "particles per bin", counts, errors, ""}, Axes{{}, scan, {axis}});
    write_edges(histogram, bins);
  };
  write_histogram(detector.x, x, detector.counts_x, detector.counts_x_errors);
  write_histogram(detector.z, z, detector.counts_z, detector.counts_z_errors);

  write_data(entry, name + "_levels", title,
             {"levels", "1", "fraction of detected particles in the level", detector.levels,
              detector.levels_errors, ""},
             Axes{{}, scan, {index_axis("level_index", "level", detector.level_labels)}});
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

/// Names under which each detector's groups stand in /entry; parts may be called like our own groups.
std::vector<std::string> group_names(const Result& result, Names& names) {
  std::vector<std::string> claimed;
  for (const DetectorResult& detector : result.detectors)
    claimed.push_back(names.claim(detector.name, {"", "_x", "_z", "_levels"}));
  return claimed;
}

}  // namespace

void write_detectors(const GroupWriter& entry, const Result& result, const std::vector<Axis>& scan,
                     Names& names) {
  if (!result.detectors.empty()) write_scan(entry, result, scan);
  const std::vector<std::string> claimed = group_names(result, names);
  for (std::size_t i = 0; i < claimed.size(); ++i)
    write_detector(entry, claimed[i], result, result.detectors[i], scan);
  write_instrument(entry, claimed, result);
}

}  // namespace rabiline::nexus
