#include "storage/motion_file.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/units.hpp"
#include "storage/nexus.hpp"
#include "storage/parameters_group.hpp"
#include "storage/provenance.hpp"

namespace rabiline {
namespace {

using hdf5::GroupWriter;

std::vector<double> component(const std::vector<Vector3>& vectors, double Vector3::*which) {
  std::vector<double> out;
  out.reserve(vectors.size());
  for (const Vector3& v : vectors) out.push_back(v.*which);
  return out;
}

std::vector<double> rows_of(const std::vector<Vector3>& vectors) {
  std::vector<double> out;
  out.reserve(3 * vectors.size());
  for (const Vector3& v : vectors) out.insert(out.end(), {v.x, v.y, v.z});
  return out;
}

/// Names that a motion's group has before its courses.
nexus::Names names_of_motion() { return nexus::Names({"title", "time", "x", "y", "z", "meaning"}); }

void write_motion(const GroupWriter& parent, const std::string& title, const Motion& motion) {
  const std::vector<double> x = component(motion.position, &Vector3::x),
                            y = component(motion.position, &Vector3::y),
                            z = component(motion.position, &Vector3::z);
  const GroupWriter data = nexus::write_data(parent, motion.name, fmt::format("{}: {}", title, motion.name),
                                             {"x", "m", "x (m)", x, {}, "spectrum"},
                                             {{"time", "s", "time (s)", motion.time, {}, ""}});
  data.attribute("auxiliary_signals", std::vector<std::string>{"y", "z"});
  data.dataset("y", {y.size()}, y, {{"units", "m"}, {"long_name", "y (m)"}});
  data.dataset("z", {z.size()}, z, {{"units", "m"}, {"long_name", "z (m)"}});
  data.text("meaning", motion.meaning);
  data.attribute("motion", motion.name);
  nexus::Names names = names_of_motion();
  std::vector<std::string> vectors, numbers;
  for (const VectorCourse& course : motion.vectors) {
    vectors.push_back(names.claim(course.name, {""}));
    data.dataset(vectors.back(), {course.values.size(), 3}, rows_of(course.values),
                 {{"units", course.unit},
                  {"long_name", nexus::long_name(course.meaning, course.unit)},
                  {"components", "x, y, z"}});
  }
  for (const Course& course : motion.numbers) {
    numbers.push_back(names.claim(course.name, {""}));
    data.dataset(numbers.back(), {course.values.size()}, course.values,
                 {{"units", course.unit}, {"long_name", nexus::long_name(course.meaning, course.unit)}});
  }
  data.attribute("vectors", vectors);
  data.attribute("courses", numbers);
}

/// The findings of all points: rows of values over the points.
struct Table {
  std::vector<std::string> names{}, units{}, meanings{}, expectations{};
  std::vector<double> values{}, expected{};  // [finding][point]

  explicit Table(const std::vector<ModelResult>& points) {
    for (const FoundAtPoints& found : findings_of(points)) {
      names.push_back(found.name);
      units.push_back(found.unit);
      meanings.push_back(found.meaning);
      expectations.emplace_back(word_of(found.expectation));
      values.insert(values.end(), found.values.begin(), found.values.end());
      expected.insert(expected.end(), found.expected.begin(), found.expected.end());
    }
  }
};

void write_columns(const GroupWriter& group, const Table& table, const hdf5::Shape& shape) {
  const hdf5::Shape one{table.names.size()};
  group.dataset("name", one, table.names, {{"long_name", "what was found"}});
  group.dataset("units", one, table.units, {{"long_name", "unit of each finding"}});
  group.dataset("meaning", one, table.meanings, {{"long_name", "what each finding means"}});
  group.dataset(
      "expectation", one, table.expectations,
      {{"long_name",
        "what is expected of each finding: closed_form, conserved, approximate, or supposed by the paper"}});
  group.dataset("value", shape, table.values, {{"long_name", "each finding, in its unit"}});
  group.dataset("expected", shape, table.expected, {{"long_name", "what is expected of it, in its unit"}});
}

nexus::Axis axis_of(const ScanAxis& scanned) {
  std::string name = scanned.parameter;
  std::replace(name.begin(), name.end(), '.', '_');
  nexus::Axis axis = nexus::index_axis(name, scanned.parameter, scanned.labels);
  if (scanned.dimension) {
    const std::string_view si_unit = si_unit_of(*scanned.dimension);
    axis.units = si_unit.empty() ? "1" : si_unit;
    axis.long_name = nexus::long_name(scanned.parameter, axis.units);
  }
  axis.values = scanned.values;
  axis.parameter = scanned.parameter;
  return axis;
}

/// The first finding is what plots show; the others lie beside it, each over the parameter.
void write_scan(const GroupWriter& entry, const SolvedModel& solved, const Table& table) {
  const std::size_t points = solved.points.size();
  const auto row = [&](const std::vector<double>& all, std::size_t i) {
    return std::span(all).subspan(i * points, points);
  };
  const nexus::Axis axis = axis_of(*solved.axis);
  nexus::Names names({"title", "name", "units", "meaning", "expectation", "value", "expected", axis.name,
                      axis.name + "_labels"});
  const auto long_name = [&](std::size_t i) { return nexus::long_name(table.meanings[i], table.units[i]); };
  std::vector<std::string> claimed;
  for (const std::string& name : table.names) claimed.push_back(names.claim(name, {"", "_expected"}));
  const GroupWriter data = nexus::write_data(
      entry, "findings", solved.title,
      {claimed.front(), table.units.front(), long_name(0), row(table.values, 0), {}, "spectrum"}, {axis});
  for (std::size_t i = 0; i < claimed.size(); ++i) {
    const hdf5::Attributes attributes{{"units", table.units[i]}, {"long_name", long_name(i)}};
    if (i > 0) data.dataset(claimed[i], {points}, row(table.values, i), attributes);
    data.dataset(claimed[i] + "_expected", {points}, row(table.expected, i), attributes);
  }
  write_columns(data, table, {table.names.size(), points});
}

void write_point(const GroupWriter& parent, const SolvedModel& solved, std::size_t point) {
  for (const Motion& motion : solved.points[point].motions) write_motion(parent, solved.title, motion);
}

/// All but where it comes from.
void write_content(const GroupWriter& entry, const SolvedModel& solved) {
  entry.text("model", solved.kind, {{"long_name", "kind of the model"}});
  std::vector<std::string> names;
  for (const Motion& motion : solved.points.front().motions) names.push_back(motion.name);
  entry.dataset("motions", {names.size()}, names, {{"long_name", "names of the motions, in order"}});
  const Table table(solved.points);
  if (solved.axis) {
    write_scan(entry, solved, table);
    entry.attribute("default", "findings");
  } else {
    write_columns(entry.group("findings", "NXcollection"), table, {table.names.size()});
    entry.attribute("default", names.front());
  }
  for (std::size_t i = 0; i < solved.points.size(); ++i) {
    if (solved.axis)
      write_point(entry.group(fmt::format("point_{}", i), "NXcollection"), solved, i);
    else
      write_point(entry, solved, i);
  }
}

GroupWriter entry_of(hdf5::FileWriter& file, const SolvedModel& solved, const std::filesystem::path& path) {
  return nexus::write_entry(file, path.filename().string(), solved.title, solved.provenance.version);
}

hdf5::FileWriter file_of(const SolvedModel& solved, const std::filesystem::path& path) {
  hdf5::FileWriter file(path);
  {
    const GroupWriter entry = entry_of(file, solved, path);
    write_content(entry, solved);
    nexus::write_parameters(entry, solved.parameters);
    nexus::write_provenance(entry, solved.provenance);
  }
  return file;
}

}  // namespace

void write_motions(const SolvedModel& solved, const std::filesystem::path& path) {
  file_of(solved, path).save();
}
std::vector<std::byte> image_of(const SolvedModel& solved) {
  return file_of(solved, hdf5::in_memory).image();
}

}  // namespace rabiline
