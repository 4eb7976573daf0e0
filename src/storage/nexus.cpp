#include "storage/nexus.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <algorithm>
#include <ctime>

namespace rabiline::nexus {
namespace {

using hdf5::Attributes;
using hdf5::GroupWriter;
using hdf5::Shape;

std::string hdf5_version() {
  unsigned major = 0, minor = 0, release = 0;
  hdf5::check(H5get_libversion(&major, &minor, &release), "HDF5");
  return fmt::format("{}.{}.{}", major, minor, release);
}

void write_axis(const GroupWriter& data, const Axis& axis, std::size_t position) {
  Attributes attributes{{"units", axis.units}, {"long_name", axis.long_name}};
  if (!axis.parameter.empty()) attributes.emplace_back("parameter", axis.parameter);
  data.dataset(axis.name, {axis.values.size()}, axis.values, attributes);
  data.attribute(axis.name + "_indices", std::uint64_t{position});
  if (axis.labels.empty()) return;
  data.dataset(axis.name + "_labels", {axis.labels.size()}, axis.labels,
               {{"long_name", "what the values of " + axis.name + " stand for"}});
}

/// `put` writes numbers that have the shape of the signal.
template <class Put>
void write_signal(const Signal& signal, Put put) {
  Attributes attributes{{"units", signal.units}, {"long_name", signal.long_name}};
  if (!signal.interpretation.empty()) attributes.emplace_back("interpretation", signal.interpretation);
  put(signal.name, signal.values, attributes);
  if (signal.errors.empty()) return;
  put(signal.name + "_errors", signal.errors,
      Attributes{{"units", signal.units}, {"long_name", "standard error of " + signal.long_name}});
}

/// `put` writes numbers of the signal into the group.
template <class Put>
GroupWriter write_plot(const GroupWriter& parent, const std::string& name, const std::string& title,
                       const Signal& signal, const std::vector<const Axis*>& axes, Put put) {
  std::vector<std::string> axis_names(axes.size());
  std::ranges::transform(axes, axis_names.begin(), [](const Axis* axis) { return axis->name; });
  if (axes.empty()) axis_names = {"."};
  GroupWriter data = parent.group(name, "NXdata");
  data.attribute("signal", signal.name);
  data.attribute("axes", axis_names);
  data.text("title", title);
  write_signal(signal, [&](const std::string& what, std::span<const double> values, const Attributes& more) {
    put(data, what, values, more);
  });
  for (std::size_t i = 0; i < axes.size(); ++i) write_axis(data, *axes[i], i);
  return data;
}

std::vector<const Axis*> pointers_to(std::initializer_list<const std::vector<Axis>*> lists) {
  std::vector<const Axis*> all;
  for (const std::vector<Axis>* axes : lists)
    for (const Axis& axis : *axes) all.push_back(&axis);
  return all;
}

Shape lengths_of(const std::vector<Axis>& axes) {
  Shape shape;
  for (const Axis& axis : axes) shape.push_back(axis.values.size());
  return shape;
}

}  // namespace

Axis index_axis(const std::string& name, const std::string& meaning, const std::vector<std::string>& labels) {
  Axis axis{name, "1", meaning, {}, labels, ""};
  std::string legend;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    axis.values.push_back(static_cast<double>(i));
    legend += fmt::format("{}{}: {}", i == 0 ? "" : ", ", i, labels[i]);
  }
  // Viewers show the numbers, so the axis title carries the labels as long as they fit under a plot.
  constexpr std::size_t longest_legend = 80;
  axis.long_name += legend.size() <= longest_legend ? fmt::format(" ({})", legend)
                                                    : fmt::format(" (index into {}_labels)", name);
  return axis;
}

std::string long_name(const std::string& name, const std::string& units) {
  return units.empty() || units == "1" ? name : fmt::format("{} ({})", name, units);
}

hdf5::OverPoints shape_of(const Axes& axes) {
  hdf5::OverPoints over{lengths_of(axes.before), lengths_of(axes.scan), lengths_of(axes.behind)};
  if (over.before.empty() && over.grid.empty() && over.behind.empty()) over.behind = {1};
  return over;
}

std::size_t count_of_points(const std::vector<Axis>& scan) {
  std::size_t points = 1;
  for (const Axis& axis : scan) points *= axis.values.size();
  return points;
}

GroupWriter write_data(const GroupWriter& parent, const std::string& name, const std::string& title,
                       const Signal& signal, const Axes& axes) {
  return write_plot(
      parent, name, title, signal, pointers_to({&axes.before, &axes.scan, &axes.behind}),
      [&](const GroupWriter& data, const std::string& what, std::span<const double> values,
          const Attributes& attributes) { data.over_points(what, shape_of(axes), values, attributes); });
}

GroupWriter write_data(const GroupWriter& parent, const std::string& name, const std::string& title,
                       const Signal& signal, const std::vector<Axis>& axes) {
  return write_plot(parent, name, title, signal, pointers_to({&axes}),
                    [&](const GroupWriter& data, const std::string& what, std::span<const double> values,
                        const Attributes& attributes) {
                      data.dataset(what, axes.empty() ? Shape{1} : lengths_of(axes), values, attributes);
                    });
}

GroupWriter write_entry(hdf5::FileWriter& file, const std::string& file_name, const std::string& title,
                        const std::string& version) {
  const GroupWriter root = file.root();
  root.attribute("NX_class", "NXroot");
  root.attribute("default", "entry");
  root.attribute("creator", "rabiline");
  root.attribute("creator_version", version);
  root.attribute("format_version", format_version);
  root.attribute("file_name", file_name);
  root.attribute("file_time", fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr))));
  root.attribute("HDF5_Version", hdf5_version());
  GroupWriter entry = root.group("entry", "NXentry");
  entry.text("title", title);
  entry.text("program_name", "rabiline", {{"version", version}});
  return entry;
}

std::string Names::claim(std::string stem, const std::vector<std::string>& suffixes) {
  const auto is_taken = [&](const std::string& suffix) { return taken_.contains(stem + suffix); };
  while (std::any_of(suffixes.begin(), suffixes.end(), is_taken)) stem += '_';
  for (const std::string& suffix : suffixes) taken_.insert(stem + suffix);
  return stem;
}

}  // namespace rabiline::nexus
