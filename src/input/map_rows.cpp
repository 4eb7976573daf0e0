#include "input/map_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <span>
#include <string_view>

#include "core/units.hpp"

namespace rabiline {
namespace {

constexpr std::string_view columns_help =
    "write `x [mm], y [mm], z [mm], Bx [mT], By [mT], Bz [mT]`, or `r [mm], z [mm], Br [mT], Bz [mT]`; of an "
    "electric field `Ex [kV/m]` and so on";
constexpr double tolerance = 1e-6;  // of the step: numbers in text are rounded

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r");
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::string_view unquoted(std::string_view cell) {
  const bool is_quoted = cell.size() > 1 && cell.front() == '"' && cell.back() == '"';
  return is_quoted ? cell.substr(1, cell.size() - 2) : cell;
}

/// Cells between commas, without the blanks and the quotes around them.
void split(std::string_view line, std::vector<std::string_view>& cells) {
  cells.clear();
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    cells.push_back(unquoted(trimmed(line.substr(begin, end - begin))));
    begin = end + 1;
  }
}

/// A column: what it is, and one of its unit in SI.
struct Column {
  std::string name;
  double unit = 1;
};
std::vector<Column> columns_of(const std::vector<std::string_view>& cells) {
  std::vector<Column> columns;
  for (const std::string_view cell : cells) {
    const std::size_t open = cell.find('['), close = cell.rfind(']');
    const std::string name(trimmed(cell.substr(0, open)));
    if (open == cell.npos || close == cell.npos || close < open)
      throw MapFault(fmt::format("the column `{}` does not say its unit", name), std::string(columns_help));
    const std::string_view unit = trimmed(cell.substr(open + 1, close - open - 1));
    const Dimension dimension = name.starts_with('B')   ? Dimension::magnetic_field
                                : name.starts_with('E') ? Dimension::electric_field
                                                        : Dimension::length;
    const ParsedQuantity one = parse_quantity(fmt::format("1 {}", unit), dimension);
    if (!one.error.empty() || one.dimension != dimension)
      throw MapFault(fmt::format("`{}` is not a unit of the column `{}`", unit, name),
                     one.suggestion.empty() ? std::string(columns_help) : one.suggestion);
    columns.push_back({name, one.value});
  }
  return columns;
}

bool is_electric(const std::vector<Column>& columns) {
  return std::ranges::any_of(columns, [](const Column& c) { return c.name.starts_with('E'); });
}

/// Where the columns of a map are among those of the file: places first, then components.
std::vector<std::size_t> order_of(const std::vector<Column>& columns) {
  const bool is_round =
      std::any_of(columns.begin(), columns.end(), [](const Column& c) { return c.name == "r"; });
  std::vector<std::string> wanted;
  for (const char axis : std::string_view(is_round ? "rz" : "xyz")) wanted.emplace_back(1, axis);
  for (std::size_t a = 0, axes = wanted.size(); a < axes; ++a)
    wanted.push_back((is_electric(columns) ? "E" : "B") + wanted[a]);
  std::vector<std::size_t> order;
  for (const std::string& name : wanted) {
    const auto found =
        std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
    if (found == columns.end())
      throw MapFault(fmt::format("there is no column `{}`", name), std::string(columns_help));
    order.push_back(static_cast<std::size_t>(found - columns.begin()));
  }
  if (columns.size() != wanted.size())
    throw MapFault(fmt::format("a map has {} columns, but here are {}", wanted.size(), columns.size()),
                   std::string(columns_help));
  return order;
}

/// The rows as they stand in the file, in SI.
struct Rows {
  std::size_t axes = 3;
  bool electric = false;
  std::vector<double> places, field;   // `axes` numbers a row each
  std::vector<std::uint32_t> lines{};  // where each row stands in the file, from 1
  std::size_t size() const { return lines.size(); }
};

double number_in(std::string_view cell, std::uint32_t line) {
  double value = 0;
  if (cell.starts_with('+') && !cell.starts_with("+-")) cell.remove_prefix(1);
  const std::from_chars_result end = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  if (end.ec != std::errc{} || end.ptr != cell.data() + cell.size())
    throw MapFault(
        cell.empty() ? fmt::format("line {}: a number is missing", line)
                     : fmt::format("line {}: `{}` is not a number", line, cell.substr(0, 40)),
        "numbers have a decimal point, commas stand between columns, units in the first line only");
  if (!std::isfinite(value))
    throw MapFault(fmt::format("line {}: `{}` is not a finite number", line, cell),
                   "compute or measure the field there, or make the map smaller");
  return value;
}

Rows rows_of(std::ifstream& file) {
  Rows rows;
  std::vector<Column> columns;
  std::vector<std::size_t> order;
  std::vector<std::string_view> cells;
  std::array<char, 4096> line;
  for (std::uint32_t number = 1; file.getline(line.data(), line.size()) || file.gcount() > 0; ++number) {
    if (file.fail() && !file.eof())
      throw MapFault(fmt::format("line {} has {} characters or more", number, line.size() - 1),
                     "a map of text has a row in each line");
    const std::string_view whole(line.data(), static_cast<std::size_t>(file.gcount()) - (file.eof() ? 0 : 1));
    if (whole.find('\0') != whole.npos)
      throw MapFault(fmt::format("line {}: the byte 0x00 is not text", number),
                     "save the map as text, or as HDF5");
    std::string_view text = trimmed(whole);
    if (number == 1 && text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    if (text.empty() || text.starts_with('#')) continue;
    split(text, cells);
    if (columns.empty()) {
      if (text.find_first_of(";\t") != text.npos)
        throw MapFault(fmt::format("line {}: a comma stands between columns, not a {}", number,
                                   text.find(';') == text.npos ? "tab" : "semicolon"),
                       "separate the columns of all rows by commas; numbers have a decimal point");
      columns = columns_of(cells);
      order = order_of(columns);
      rows.axes = order.size() / 2;
      rows.electric = is_electric(columns);
      continue;
    }
    if (cells.size() != columns.size())
      throw MapFault(fmt::format("line {}: {} columns stand here, but the first line names {}", number,
                                 cells.size(), columns.size()),
                     "a comma stands between columns, and no row is shorter or longer");
    for (std::size_t c = 0; c < order.size(); ++c) {
      const double value = number_in(cells[order[c]], number) * columns[order[c]].unit;
      if (std::abs(value) > largest_of_map)
        throw MapFault(
            fmt::format("line {}: `{}` is beyond {:g} in SI", number, cells[order[c]], largest_of_map),
            "is its unit right?");
      (c < rows.axes ? rows.places : rows.field).push_back(value);
    }
    rows.lines.push_back(number);
  }
  if (columns.empty()) throw MapFault("the file has no map", std::string(columns_help));
  return rows;
}

/// The grid's axis from the places of all rows along it.
MapAxis axis_of(const Rows& rows, std::size_t axis) {
  std::vector<double> places;
  places.reserve(rows.size());
  for (std::size_t i = 0; i < rows.size(); ++i) places.push_back(rows.places[rows.axes * i + axis]);
  std::sort(places.begin(), places.end());
  const double extent = places.empty() ? 0 : places.back() - places.front();
  const double same = extent / static_cast<double>(std::max<std::size_t>(rows.size(), 1)) * tolerance;
  places.erase(std::unique(places.begin(), places.end(), [&](double a, double b) { return b - a <= same; }),
               places.end());
  std::string why;
  const std::string_view names = rows.axes == 2 ? "rz" : "xyz";
  const std::optional<MapAxis> found = even_axis(places, names.substr(axis, 1), why);
  if (!found)
    throw MapFault(why, places.size() < 3
                            ? "where the field does not change along it, repeat the table at four places"
                            : "a map stands on a regular grid: coordinates need enough digits");
  return *found;
}

}  // namespace

MapNodes read_map_rows(const std::filesystem::path& path) {
  std::error_code problem;
  const std::uintmax_t bytes = std::filesystem::file_size(path, problem);
  if (problem) throw MapFault("its size is not known: " + problem.message(), "");
  if (bytes > most_map_text)
    throw MapFault(
        fmt::format("the file has {:.1f} GiB; maps are read as text up to {} GiB",
                    static_cast<double>(bytes) / 0x1p30, most_map_text >> 30),
        "store the map as HDF5, leave out rows that the beam does not need, or use a coarser grid");
  std::ifstream file(path, std::ios::binary);
  MapNodes out;
  const Rows rows = rows_of(file);
  out.electric = rows.electric;
  std::size_t nodes = 1;
  for (std::size_t a = 0; a < rows.axes; ++a) {
    out.axes.push_back(axis_of(rows, a));
    nodes *= static_cast<std::size_t>(out.axes.back().nodes);
    if (nodes > 64 * rows.size() + 64)
      throw MapFault(fmt::format("the places of the {} rows do not stand on a regular grid", rows.size()),
                     "every node of the grid has a row, with its coordinates as they are on the grid");
  }
  // Where each row belongs.
  std::vector<std::uint32_t> line(nodes, 0);
  out.field.assign(nodes * rows.axes, 0);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    std::size_t node = 0;
    for (std::size_t a = 0; a < rows.axes; ++a) {
      const MapAxis& axis = out.axes[a];
      const double at = (rows.places[rows.axes * i + a] - axis.begin) / axis.step;
      node = node * static_cast<std::size_t>(axis.nodes) + static_cast<std::size_t>(std::lround(at));
    }
    if (line[node] != 0)
      throw MapFault(fmt::format("lines {} and {} are of the same place", line[node], rows.lines[i]),
                     "every node of the grid has one row");
    line[node] = rows.lines[i];
    std::copy_n(rows.field.begin() + static_cast<std::ptrdiff_t>(rows.axes * i), rows.axes,
                out.field.begin() + static_cast<std::ptrdiff_t>(rows.axes * node));
  }
  const auto missing = std::find(line.begin(), line.end(), 0U);
  if (missing == line.end()) return out;
  auto rest = static_cast<std::size_t>(missing - line.begin());
  std::string where;
  for (std::size_t a = rows.axes; a-- > 0;) {
    const MapAxis& axis = out.axes[a];
    const auto n = static_cast<std::size_t>(axis.nodes);
    where = fmt::format(
        "{}{}{}", pretty_quantity(axis.begin + axis.step * static_cast<double>(rest % n), Dimension::length),
        where.empty() ? "" : ", ", where);
    rest /= n;
  }
  throw MapFault(
      fmt::format("{} of {} nodes are missing, the first at ({})", nodes - rows.size(), nodes, where),
      "every node of the grid has a row");
}

}  // namespace rabiline
