#include "storage/map_file.hpp"

#include <fmt/format.h>
#include <cmath>

#include "core/machine_memory.hpp"
#include "core/units.hpp"
#include "storage/hdf5_reader.hpp"

namespace rabiline {
namespace {

constexpr std::size_t most_places = 100000;
constexpr std::size_t most_nodes = std::size_t{1} << 28;
constexpr double bytes_per_node = 64;  // while it is read: a component, three components, four coefficients

class MapReader {
 public:
  explicit MapReader(const std::filesystem::path& path)
      : file_(path, hdf5::Writer::anybody), path_(path.string()) {}

  MapNodes read() {
    const bool is_round = file_.contains("r");
    const std::vector<std::string> axes =
        is_round ? std::vector<std::string>{"r", "z"} : std::vector<std::string>{"x", "y", "z"};
    std::vector<std::size_t> sizes;
    std::size_t nodes = 1;
    for (const std::string& name : axes) {
      const std::vector<double> places = numbers(name, Dimension::length, {}, most_places);
      std::string why;
      const std::optional<MapAxis> axis = even_axis(places, name, why);
      if (!axis) throw StorageError(fmt::format("{}: /{}: {}", path_, name, why));
      out_.axes.push_back(*axis);
      sizes.push_back(places.size());
      nodes *= places.size();  // at most 1e15
    }
    if (nodes > most_nodes)
      throw StorageError(
          fmt::format("{}: the map has {:.2g} nodes, which need {:.3g} GiB; {:.2g} are the most", path_,
                      static_cast<double>(nodes), static_cast<double>(nodes) * bytes_per_node / 0x1p30,
                      static_cast<double>(most_nodes)));
    const double needed = static_cast<double>(nodes) * bytes_per_node;
    if (needed > memory_there())
      throw StorageError(fmt::format(
          "{}: the map has {:.2g} nodes, which need {:.3g} GiB, and there are {:.3g} GiB of memory", path_,
          static_cast<double>(nodes), needed / 0x1p30, memory_there() / 0x1p30));
    const std::size_t m = axes.size();
    out_.electric = file_.contains("E" + axes[0]);
    for (std::size_t c = 0; c < m; ++c) {
      const std::string name = (out_.electric ? "E" : "B") + axes[c];
      const std::vector<double> component =
          numbers(name, out_.electric ? Dimension::electric_field : Dimension::magnetic_field, sizes, nodes);
      if (c == 0) out_.field.resize(nodes * m);
      for (std::size_t i = 0; i < nodes; ++i) out_.field[i * m + c] = component[i];
    }
    return std::move(out_);
  }

 private:
  /// In SI; the dataset has these sizes, or is one-dimensional where there are none.
  std::vector<double> numbers(const std::string& name, Dimension dimension,
                              const std::vector<std::size_t>& sizes, std::size_t most) {
    if (!file_.contains(name)) throw StorageError(fmt::format("{}: there is no dataset /{}", path_, name));
    std::vector<double> values =
        sizes.empty() ? file_.reals_of_any_size(name, most) : file_.grid(name, sizes);
    const std::string unit = file_.attribute(name, "units");
    const ParsedQuantity one = parse_quantity("1 " + unit, dimension);
    if (!one.error.empty() || one.dimension != dimension)
      throw StorageError(fmt::format("{}: /{}: `{}` is not a unit of {}", path_, name, unit,
                                     with_article(name_of(dimension))));
    for (std::size_t i = 0; i < values.size(); ++i) {
      values[i] *= one.value;
      if (!std::isfinite(values[i]))
        throw StorageError(fmt::format("{}: /{}[{}] is not finite", path_, name, place_of(i, sizes)));
      if (std::abs(values[i]) > largest_of_map)
        throw StorageError(
            fmt::format("{}: /{}[{}] is beyond {:g} in SI", path_, name, place_of(i, sizes), largest_of_map));
    }
    return values;
  }
  /// "3, 0, 14", as h5py counts them; of a single axis the number itself.
  static std::string place_of(std::size_t number, const std::vector<std::size_t>& sizes) {
    std::string out = std::to_string(sizes.empty() ? number : number % sizes.back());
    for (std::size_t a = sizes.size(); a-- > 1;) {
      number /= sizes[a];
      out = fmt::format("{}, {}", number % sizes[a - 1], out);
    }
    return out;
  }

  hdf5::FileReader file_;
  std::string path_;
  MapNodes out_;
};

}  // namespace

MapNodes read_map_file(const std::filesystem::path& path) { return MapReader(path).read(); }

}  // namespace rabiline
