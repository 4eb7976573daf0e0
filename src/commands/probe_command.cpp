// rabiline probe: the field at a place, or along a line.
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string_view>

#include <unistd.h>

#include "commands/common.hpp"
#include "commands/say.hpp"
#include "core/units.hpp"
#include "scan/settings.hpp"

namespace rabiline {
namespace {

struct ProbeArguments {
  ExperimentOptions experiment;
  std::string at = "0 m,0 m,0 m", time = "0 s", along, from, to, points, picture, title, size, dpi;
};

/// "1 mm,0.4 m,0": a bare zero is a length too.
double read_quantity(const char* option, std::string_view text, Dimension dimension) {
  const ParsedQuantity read = parse_quantity(text, dimension);
  const bool is_bare_zero = read.dimension == Dimension::number && read.value == 0;
  if (!read.error.empty() || (read.dimension != dimension && !is_bare_zero))
    throw ArgumentError(fmt::format("{}: `{}` is not {}\n  help: write it like `{}`", option, text,
                                    with_article(name_of(dimension)), example_of(dimension)));
  if (constexpr double farthest = 1e12; std::abs(read.value) > farthest)
    throw ArgumentError(fmt::format("{}: `{}` is beyond {:g} in SI", option, text, farthest));
  return read.value;
}

std::array<double, 3> read_place(const std::string& text) {
  std::array<double, 3> place{};
  std::size_t begin = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t end = text.find(',', begin);
    if ((end == text.npos) != (i == 2))
      throw ArgumentError(
          fmt::format("--at: `{}` is not a place\n  help: write x, y and z, such as `0 m,0.4 m,1 mm`", text));
    std::string_view part = std::string_view(text).substr(begin, end == text.npos ? end : end - begin);
    while (part.starts_with(' ')) part.remove_prefix(1);
    place[i] = read_quantity("--at", part, Dimension::length);
    begin = end + 1;
  }
  return place;
}

std::string field_text(const std::array<double, 3>& b, char name, Dimension dimension) {
  const auto text = [&](double x) { return pretty_quantity(x, dimension); };
  return fmt::format("({}, {}, {}), |{}| = {}", text(b[0]), text(b[1]), text(b[2]), name,
                     text(std::hypot(b[0], b[1], b[2])));
}
bool is_none(const std::array<double, 3>& field) { return field == std::array<double, 3>{}; }

/// How far from its axis a fringe is known, of the parts beyond that. Divergence and curl are nothing there,
/// too: such a field obeys Maxwell's equations, but no magnet makes it.
using Limits = std::map<std::string, double>;

void look(const Probed& p, Limits& limits) {
  for (const Probed::Contribution& from : p.contributions)
    if (from.good_up_to > 0) limits[from.part] = from.good_up_to;
}
void warn(const Limits& limits, const char* where) {
  for (const auto& [part, limit] : limits)
    say(stderr,
        "warning: {} more than {} from the axis of `{}`: so far from it its fringe or profile does not "
        "tell what the field is\n",
        where, pretty_quantity(limit, Dimension::length), part);
}

void print_place(const Probed& p, double time) {
  const auto metres = [](double x) { return pretty_quantity(x, Dimension::length); };
  const auto& g = p.slope;
  fmt::print("at ({}, {}, {}), t = {}\n", metres(p.place[0]), metres(p.place[1]), metres(p.place[2]),
             pretty_quantity(time, Dimension::time));
  fmt::print("  B = {}\n", field_text(p.field, 'B', Dimension::magnetic_field));
  for (const Probed::Contribution& from : p.contributions)
    if (is_none(from.electric))
      fmt::print("    {:<16} {}\n", from.part, field_text(from.field, 'B', Dimension::magnetic_field));
  if (!is_none(p.electric)) fmt::print("  E = {}\n", field_text(p.electric, 'E', Dimension::electric_field));
  for (const Probed::Contribution& from : p.contributions)
    if (!is_none(from.electric))
      fmt::print("    {:<16} {}\n", from.part, field_text(from.electric, 'E', Dimension::electric_field));
  fmt::print("  gradient [T/m]   d/dx           d/dy           d/dz\n");
  for (std::size_t i = 0; i < 3; ++i)
    fmt::print("    dB{}        {:>14.6g} {:>14.6g} {:>14.6g}\n", "xyz"[i], g[3 * i], g[3 * i + 1],
               g[3 * i + 2]);
  const double size = std::hypot(p.field[0], p.field[1], p.field[2]);
  if (size > 0) {
    std::array<double, 3> of_size{};
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) of_size[k] += p.field[i] * g[3 * i + k] / size;
    fmt::print("    d|B|       {:>14.6g} {:>14.6g} {:>14.6g}\n", of_size[0], of_size[1], of_size[2]);
  }
  fmt::print("  div B = {:.3g} T/m, curl B = ({:.3g}, {:.3g}, {:.3g}) T/m\n", g[0] + g[4] + g[8], g[7] - g[5],
             g[2] - g[6], g[3] - g[1]);
  Limits limits;
  look(p, limits);
  warn(limits, "this place is");
}

/// A table that any plotting program reads.
void print_line(std::FILE* out, const Setup& setup, const ProbeArguments& a, std::array<double, 3> place,
                double time) {
  const std::size_t axis = std::string_view("xyz").find(a.along);
  if (a.along.size() != 1 || axis == std::string_view::npos)
    throw ArgumentError(fmt::format("--along: `{}` is none of x, y and z", a.along));
  const std::string enough = a.picture.empty() ? "101" : "1001";  // for a table; for a curve without corners
  const std::uint64_t points =
      read_argument("--points", a.points.empty() ? enough : a.points, {2, 1e6, true, true, "from 2 to 1e6"});
  if (a.from.empty() || a.to.empty())
    throw ArgumentError(fmt::format("--along: where the line {} is missing\n  help: add `{}`",
                                    !a.from.empty() ? "ends"
                                    : a.to.empty()  ? "begins and ends"
                                                    : "begins",
                                    !a.from.empty() ? "--to '1 m'"
                                    : a.to.empty()  ? "--from '0 m' --to '1 m'"
                                                    : "--from '0 m'"));
  const double from = read_quantity("--from", a.from, Dimension::length),
               to = read_quantity("--to", a.to, Dimension::length);
  if (from == to) throw ArgumentError("--along: the line has no length: it begins where it ends");
  fmt::print(out,
             "x [m],y [m],z [m],Bx [T],By [T],Bz [T],|B| [T],div B [T/m],curl B [T/m],Ex [V/m],Ey [V/m],"
             "Ez [V/m]\n");
  Limits limits;
  for (std::uint64_t i = 0; i < points; ++i) {
    place[axis] = from + (to - from) * static_cast<double>(i) / static_cast<double>(points - 1);
    const Probed p = probe(setup, place, time);
    look(p, limits);
    const std::array<double, 3>& b = p.field;
    const std::array<double, 9>& g = p.slope;
    fmt::print(out, "{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.3g},{:.3g},{:.9g},{:.9g},{:.9g}\n",
               place[0], place[1], place[2], b[0], b[1], b[2], std::hypot(b[0], b[1], b[2]),
               g[0] + g[4] + g[8], std::hypot(g[7] - g[5], g[2] - g[6], g[3] - g[1]), p.electric[0],
               p.electric[1], p.electric[2]);
  }
  warn(limits, "some of these places are");
}

/// The package draws the table, which it reads from a file without a name, and along the beam where parts
/// are.
void draw_line(const Setup& setup, const ProbeArguments& a, const std::array<double, 3>& place, double time) {
  std::FILE* const table = std::tmpfile();
  if (table == nullptr) throw StorageError("no temporary file could be made");
  print_line(table, setup, a, place, time);
  std::rewind(table);
  dup2(fileno(table), STDIN_FILENO);
  std::vector<std::string> words{"plot-field",
                                 "/dev/stdin",
                                 "-o",
                                 a.picture,
                                 "--title",
                                 !a.title.empty()        ? a.title
                                 : setup.title().empty() ? a.experiment.file.filename().string()
                                                         : setup.title()};
  for (const auto& [option, value] : {std::pair{"--size", a.size}, std::pair{"--dpi", a.dpi}})
    if (!value.empty()) words.insert(words.end(), {option, value});
  if (a.along == "y")
    for (const PartName& part : parts_of(setup))
      if ((part.field || part.drives) && part.begin < part.end)
        words.insert(words.end(), {"--region", fmt::format("{}={}:{}", part.label, part.begin, part.end)});
  start_package(words);
}

void probe_command(const ProbeArguments& a) {
  const std::array<double, 3> place = read_place(a.at);
  const double time = read_quantity("--time", a.time, Dimension::time);
  const Setup setup = load_beamline(a.experiment.file, a.experiment.changes);
  if (a.along.empty())
    print_place(probe(setup, place, time), time);
  else if (a.picture.empty())
    print_line(stdout, setup, a, place, time);
  else
    draw_line(setup, a, place, time);
}

}  // namespace

void add_probe(CLI::App& app) {
  CLI::App* verb =
      app.add_subcommand("probe", "show the fields at a place, the gradient of B and whose they are");
  auto a = std::make_shared<ProbeArguments>();
  a->experiment.add_without_scan_to(*verb);
  verb->add_option("--at", a->at, "the place, such as '0 m,0.4 m,1 mm'")->type_name("X,Y,Z");
  verb->add_option("--time", a->time, "when, for fields with a clock; random phases are taken as 0")
      ->type_name("T");
  CLI::Option* along =
      verb->add_option("--along", a->along, "a table along x, y or z through the place")->type_name("AXIS");
  verb->add_option("--from", a->from, "where the line begins")->type_name("PLACE")->needs(along);
  verb->add_option("--to", a->to, "where it ends")->type_name("PLACE")->needs(along);
  verb->add_option("--points", a->points, "how many places on the line; 101 if omitted, 1001 for a picture")
      ->type_name("N")
      ->needs(along);
  CLI::Option* picture =
      verb->add_option("-o,--output", a->picture, "draws the line instead: PNG, PDF or SVG")
          ->type_name("PICTURE")
          ->needs(along);
  verb->add_option("--title", a->title, "of the picture")->type_name("TEXT")->needs(picture);
  verb->add_option("--size", a->size, "of the picture in mm, such as 86x60")
      ->type_name("WxH")
      ->needs(picture);
  verb->add_option("--dpi", a->dpi, "dots per inch of a PNG; 200 if omitted")->type_name("N")->needs(picture);
  verb->callback([a] { probe_command(*a); });
}

}  // namespace rabiline
