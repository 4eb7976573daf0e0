#include "storage/tally_groups.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/units.hpp"
#include "tally/quantity.hpp"

namespace rabiline::nexus {
namespace {

using hdf5::GroupWriter;
using hdf5::OverPoints;
using hdf5::Shape;

std::string unit_of(const TallyAxisResult& axis) {
  const std::string_view unit = si_unit_of(axis.dimension);
  return unit.empty() ? "1" : std::string(unit);
}

const QuantityRow& row_of(const TallyAxisResult& axis) {
  return *std::ranges::find(quantity_rows, axis.quantity, &QuantityRow::word);
}

/// What plots write along the axis.
std::string title_of(const TallyAxisResult& axis) {
  const QuantityRow& row = row_of(axis);
  std::string words = row.title != nullptr ? row.title : row.word;
  for (char& c : words)
    if (c == '_') c = ' ';
  if (!axis.direction.empty())
    words = fmt::format("spin along ({:g}, {:g}, {:g}) over I", axis.direction[0], axis.direction[1],
                        axis.direction[2]);
  return long_name(words, unit_of(axis));
}

/// A number at each scan point and plane.
OverPoints shape_of(const std::vector<Axis>& scan, std::size_t planes) {
  OverPoints over = shape_of(Axes{{}, scan, {}});
  if (planes > 1) over.behind = {planes};
  return over;
}

void write_numbers(const GroupWriter& data, const std::string& name, const OverPoints& shape,
                   const std::vector<double>& values, const std::vector<double>& errors,
                   const std::string& units, const std::string& meaning) {
  data.over_points(name, shape, values, {{"units", units}, {"long_name", meaning}});
  data.over_points(name + "_errors", shape, errors,
                   {{"units", units}, {"long_name", "standard error of " + meaning}});
}

bool is_circle(const TallyAxisResult& axis) { return row_of(axis).circular; }

void write_moments(const GroupWriter& data, const OverPoints& shape, const std::string& name,
                   const TallyAxisResult& axis) {
  if (axis.mean.empty()) return;
  write_numbers(data, name + "_mean", shape, axis.mean, axis.mean_errors, unit_of(axis),
                "mean of " + name + (is_circle(axis) ? " as a direction," : "") + " inside the axes");
  write_numbers(data, name + "_deviation", shape, axis.deviation, axis.deviation_errors, unit_of(axis),
                (is_circle(axis) ? "circular standard deviation of " : "standard deviation of ") + name +
                    " inside the axes");
}

void write_tally(const GroupWriter& entry, const std::string& name, const Result& result,
                 const TallyResult& tally, const std::vector<Axis>& scan) {
  Names names({"counts", "counts_errors", "title", "outside", "outside_errors"});
  for (const Axis& axis : scan) names.claim(axis.name, {"", "_labels"});
  std::vector<Axis> axes;
  for (const TallyAxisResult& axis : tally.axes) {
    const std::string own = names.claim(
        axis.quantity, {"", "_labels", "_edges", "_mean", "_mean_errors", "_deviation", "_deviation_errors"});
    axes.push_back({own, unit_of(axis), title_of(axis), centres_of(axis.edges), axis.labels, ""});
  }
  const GroupWriter data =
      write_data(entry, name, fmt::format("{}: {} of {}", result.title, tally.name, tally.part_label),
                 {"counts", "1", "particles per bin", tally.counts, tally.counts_errors,
                  tally.axes.size() == 2                   ? "image"
                  : tally.axes.size() == 1 && scan.empty() ? "spectrum"
                                                           : ""},
                 Axes{{}, scan, axes});
  data.attribute("part", tally.part);
  data.attribute("tally", tally.name);
  data.attribute("counted", tally.of_monitor ? "what passed the monitor" : "what the detector counted");
  if (tally.asks_for_spin)
    data.attribute(
        "spin_outcomes",
        "expectation: under the law quantum the weight of each particle is split over the outcomes "
        "by their probabilities");
  for (std::size_t i = 0; i < tally.axes.size(); ++i) {
    const Axis& axis = axes[i];
    data.dataset(axis.name + "_edges", {tally.axes[i].edges.size()}, tally.axes[i].edges,
                 {{"units", axis.units}, {"long_name", "edges of the bins along " + axis.name}});
    write_moments(data, shape_of(scan, tally.planes), axis.name, tally.axes[i]);
  }
  write_numbers(data, "outside", shape_of(scan, tally.planes), tally.outside, tally.outside_errors, "1",
                "particles that crossed the plane outside of the axes");
}

void write_monitor(const GroupWriter& entry, const std::string& name, const Result& result,
                   const MonitorResult& monitor, const std::vector<Axis>& scan) {
  std::vector<Axis> axes;
  if (!monitor.planes.empty()) axes.push_back({"y", "m", long_name("y", "m"), monitor.planes, {}, ""});
  const GroupWriter data =
      write_data(entry, name, fmt::format("{}: {}", result.title, monitor.label),
                 {"passed", "1", "fraction of emitted particles that passed " + monitor.label, monitor.passed,
                  monitor.passed_errors, ""},
                 Axes{{}, scan, axes});
  data.attribute("monitor", monitor.name);
  data.number("distance", monitor.y, {{"units", "m"}, {"long_name", "distance from the source (m)"}});
  if (monitor.passed_covariance.empty()) return;
  const std::size_t planes = std::max<std::size_t>(1, monitor.planes.size()),
                    points = monitor.passed.size() / planes;
  data.dataset("passed_covariance", planes > 1 ? Shape{planes, points, points} : Shape{points, points},
               monitor.passed_covariance,
               {{"units", "1"}, {"long_name", "covariance of passed between scan points (row-major)"}});
}

}  // namespace

std::vector<double> centres_of(const std::vector<double>& edges) {
  std::vector<double> centres;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) centres.push_back(0.5 * (edges[i] + edges[i + 1]));
  return centres;
}

void write_monitors_and_tallies(const GroupWriter& entry, const Result& result, const std::vector<Axis>& scan,
                                Names& names) {
  for (const MonitorResult& monitor : result.monitors)
    write_monitor(entry, names.claim(monitor.name, {""}), result, monitor, scan);
  for (const TallyResult& tally : result.tallies)
    write_tally(entry, names.claim(tally.part + "_" + tally.name, {""}), result, tally, scan);
}

}  // namespace rabiline::nexus
