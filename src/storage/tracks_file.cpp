#include "storage/tracks_file.hpp"

#include <fmt/format.h>

#include "core/version.hpp"
#include "storage/nexus.hpp"
#include "storage/parameters_group.hpp"

namespace rabiline {
namespace {

using hdf5::GroupWriter;

struct Column {
  std::string name, units, meaning;
  std::vector<double> Track::*values;
};

/// What a track holds beside the plotted x over y.
const std::vector<Column>& columns() {
  static const std::vector<Column> all{
      {"t", "s", "time", &Track::t},
      {"z", "m", "z", &Track::z},
      {"vx", "m/s", "velocity along x", &Track::vx},
      {"vy", "m/s", "velocity along y", &Track::vy},
      {"vz", "m/s", "velocity along z", &Track::vz},
      {"sx", "1", "spin along x over its largest value, of an atom that of F", &Track::sx},
      {"sy", "1", "spin along y over its largest value, of an atom that of F", &Track::sy},
      {"sz", "1", "spin along z over its largest value, of an atom that of F", &Track::sz},
      {"weight", "1", "what filters, gas and the like have left of the particle", &Track::weight},
  };
  return all;
}

std::string describe(const Track& track) {
  const std::string where = track.where.empty() ? "" : fmt::format(" ({})", track.where);
  return fmt::format("{} {}: {}{}", track.species, track.particle, track.fate, where);
}

void write_track(const GroupWriter& entry, const std::string& name, const std::string& title,
                 const Track& track) {
  const GroupWriter data = nexus::write_data(entry, name, fmt::format("{}: {}", title, describe(track)),
                                             {"x", "m", "x (m)", track.x, {}, ""},
                                             {{"y", "m", "y, along the beam (m)", track.y, {}, ""}});
  for (const Column& column : columns()) {
    const std::vector<double>& values = track.*column.values;
    data.dataset(column.name, {track.y.size()}, values,
                 {{"units", column.units}, {"long_name", nexus::long_name(column.meaning, column.units)}});
  }
  data.attribute("particle", track.particle);
  data.attribute("law", track.law);
  data.attribute("species", track.species);
  data.attribute("fate", track.fate);
  data.attribute("where", track.where);
}

/// What the particles passed, for who draws their paths.
void write_parts(const GroupWriter& entry, const std::vector<PartName>& parts) {
  const GroupWriter group = entry.group("parts", "NXcollection");
  std::vector<std::string> names, kinds, labels;
  std::vector<double> begins, ends;
  std::vector<std::uint64_t> fields, drives;
  for (const PartName& part : parts) {
    names.push_back(part.name);
    kinds.push_back(part.kind);
    labels.push_back(part.label);
    begins.push_back(part.begin);
    ends.push_back(part.end);
    fields.push_back(part.field ? 1 : 0);
    drives.push_back(part.drives ? 1 : 0);
  }
  const hdf5::Shape shape{parts.size()};
  group.dataset("name", shape, names);
  group.dataset("kind", shape, kinds);
  group.dataset("label", shape, labels);
  group.dataset("begin", shape, begins, {{"units", "m"}});
  group.dataset("end", shape, ends, {{"units", "m"}});
  group.dataset("has_field", shape, fields);
  group.dataset("drives", shape, drives);
}

hdf5::FileWriter file_of(const Tracks& tracks, const std::filesystem::path& path) {
  hdf5::FileWriter file(path);
  {
    const GroupWriter entry = nexus::write_entry(file, path.filename().string(), tracks.title, version);
    nexus::Names names({"title", "program_name", "law", "parts", "parameters"});
    if (!tracks.parts.empty()) write_parts(entry, tracks.parts);
    if (!tracks.parameters.empty()) nexus::write_parameters(entry, tracks.parameters);
    if (!tracks.paths.empty()) entry.text("law", tracks.paths.front().law, {{"long_name", "law of motion"}});
    for (const Track& track : tracks.paths) {
      const std::string name = names.claim(fmt::format("particle_{}", track.particle), {""});
      if (&track == &tracks.paths.front()) entry.attribute("default", name);
      write_track(entry, name, tracks.title, track);
    }
  }
  return file;
}

}  // namespace

void write_tracks(const Tracks& tracks, const std::filesystem::path& path) { file_of(tracks, path).save(); }
std::vector<std::byte> image_of(const Tracks& tracks) { return file_of(tracks, hdf5::in_memory).image(); }

}  // namespace rabiline
