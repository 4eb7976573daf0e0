#include "input/map_file.hpp"

#include <fmt/format.h>

#include <filesystem>

#include "input/file.hpp"
#include "input/map_rows.hpp"
#include "input/reader.hpp"
#include "input/text_file.hpp"
#include "storage/digest.hpp"
#include "storage/map_file.hpp"

namespace rabiline {
namespace {

namespace fs = std::filesystem;

/// Behind a plane at zero the map goes on where it ends there; four nodes are the fewest then.
void require_axes(const MapNodes& nodes, const std::array<MapSymmetry, 3>& symmetry) {
  const bool round = nodes.axes.size() == 2;
  const std::string_view names = round ? "rz" : "xyz";
  for (const MapSymmetry plane : symmetry) {
    const bool of_charges = plane == MapSymmetry::same_charges || plane == MapSymmetry::opposite_charges;
    if (plane != MapSymmetry::none && of_charges != nodes.electric)
      throw MapFault(nodes.electric ? "currents have no electric field to mirror, and this is the map of one"
                                    : "charges have no magnetic field to mirror, and this is the map of one",
                     nodes.electric ? "write `same_charges` or `opposite_charges`"
                                    : "write `same_currents` or `opposite_currents`");
  }
  if (round && (symmetry[0] != MapSymmetry::none || symmetry[1] != MapSymmetry::none))
    throw MapFault("a map in r and z is symmetric about its axis, and about no plane but z = 0",
                   "omit `x` and `y`");
  for (std::size_t a = 0; a < nodes.axes.size(); ++a) {
    const MapAxis& axis = nodes.axes[a];
    const char name = names[a];
    const bool ends_at_zero =
        std::abs(axis.begin) <= 1e-6 * axis.step || std::abs(axis.end()) <= 1e-6 * axis.step;
    const bool mirrored = name == 'r' ? ends_at_zero : symmetry[round ? 2 : a] != MapSymmetry::none;
    if (name == 'r' && axis.begin < -1e-6 * axis.step)
      throw MapFault("`r` is below zero in a map about an axis", "r is the distance from the axis");
    if (mirrored && !ends_at_zero)
      throw MapFault(fmt::format("the map does not end at the plane {} = 0", name),
                     fmt::format("omit `{}`, or give the half of the map on one side of the plane", name));
    if (axis.nodes < (mirrored ? 3 : 4))
      throw MapFault(
          fmt::format("there {} along {}, but a map has 4 or more",
                      axis.nodes == 1 ? "is 1 place" : fmt::format("are {} places", axis.nodes), name),
          "use a finer grid");
  }
}

/// At zero to the bit where the map is mirrored.
void put_planes_at_zero(MapNodes& nodes) {
  for (MapAxis& axis : nodes.axes) {
    if (std::abs(axis.begin) <= 1e-6 * axis.step) axis.begin = 0;
    if (std::abs(axis.end()) <= 1e-6 * axis.step) axis.begin = -axis.step * (axis.nodes - 1);
  }
}

/// Of its numbers, in whichever file and unit they are.
std::uint64_t digest_of(const MapNodes& nodes) {
  std::uint64_t all = digest(std::as_bytes(std::span(nodes.field)));
  for (const MapAxis& axis : nodes.axes) {
    const double of_axis[] = {static_cast<double>(axis.nodes), axis.begin, axis.step};
    all = digest(std::as_bytes(std::span(of_axis)), all);
  }
  return nodes.electric ? ~all : all;
}

MapNodes read_nodes(const fs::path& path) {
  if (const auto problem = problem_of(path, true)) throw MapFault(problem->what, problem->help);
  if (path.extension() == ".csv" || path.extension() == ".txt") return read_map_rows(path);
  if (path.extension() != ".h5" && path.extension() != ".hdf5")
    throw MapFault("a map is a CSV file, `.csv`, or an HDF5 file, `.h5`", "rename or convert it");
  try {
    return read_map_file(path);
  } catch (const StorageError& error) {
    std::string_view why = error.what();  // after the file's name, which is told anyway
    if (const std::string name = path.string() + ": "; why.starts_with(name)) why.remove_prefix(name.size());
    throw MapFault(
        std::string(why),
        "it has 1-D datasets `x`, `y`, `z` and 3-D ones `Bx`, `By`, `Bz` (or `r`, `z`, `Br`, `Bz`; of an "
        "electric field `Ex` and so on), each with an attribute `units`");
  }
}

}  // namespace

std::shared_ptr<const FieldMap> read_map(const Node& node, const Row& row, Reading& reading) {
  MapFile spec;
  if (node.is_scalar() ? !read_text(node, row, reading, spec.file)
                       : !read_struct(node, node.place, row, reading, spec))
    return nullptr;
  const fs::path path = (fs::path(reading.folder) / spec.file).lexically_normal();
  const std::array<MapSymmetry, 3> symmetry{spec.x, spec.y, spec.z};
  Reading::File& file = reading.files[path.string()];
  const auto known = file.maps.find(symmetry);
  if (known != file.maps.end()) return known->second;
  try {
    MapNodes nodes = read_nodes(path);
    require_axes(nodes, symmetry);
    put_planes_at_zero(nodes);
    // The file itself is not kept with results: it may be as large as the machine.
    const std::string text =
        fmt::format("a field map of {} numbers, digest {:016x}\n", nodes.field.size(), digest_of(nodes));
    if (reading.stored && stored_text(*reading.stored, path.string()) != text)
      throw MapFault("the map is not the one that the experiment was flown with", "");
    file.source = make_source_text(path.string(), text);
    file.text = text;
    return file.maps[symmetry] = std::make_shared<const FieldMap>(std::move(nodes), symmetry, path.string());
  } catch (const MapFault& fault) {
    if (!file.source) reading.files.erase(path.string());
    reading.error(node.place, fmt::format("`{}`: {}", path.string(), fault.what()), fault.help);
    return nullptr;
  }
}

bool ValueType<LoadedMap>::read(const Node& node, const Row& row, Reading& reading, LoadedMap& out) {
  out.map = read_map(node, row, reading);
  return out.map != nullptr;
}

}  // namespace rabiline
