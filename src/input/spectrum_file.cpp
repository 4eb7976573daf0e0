#include "input/spectrum_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "input/file.hpp"
#include "input/text_file.hpp"

namespace rabiline {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_errors = 10;  // of one file: what is wrong there is mostly wrong in every row
constexpr std::string_view header_help =
    "write `speed [m/s],flux`, `wavelength [angstrom],flux` or `energy [meV],flux`";

/// A cell of a line and where it stands.
struct Cell {
  std::string_view text;
  int column;  // from 1
};

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r'; }

std::vector<Cell> cells_of(std::string_view line) {
  std::vector<Cell> cells;
  for (std::size_t begin = 0; begin <= line.size();) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    std::size_t first = begin, last = end;
    while (first < last && is_blank(line[first])) ++first;
    while (last > first && is_blank(line[last - 1])) --last;
    if (last - first > 1 && line[first] == '"' && line[last - 1] == '"') ++first, --last;
    cells.push_back({line.substr(first, last - first), static_cast<int>(first) + 1});
    begin = end + 1;
  }
  return cells;
}

class SpectrumReader {
 public:
  SpectrumReader(std::shared_ptr<const SourceText> source, Reading& reading)
      : source_(std::move(source)), reading_(reading) {}

  std::shared_ptr<const Spectrum> read() {
    spectrum_.path = source_->name;
    for (std::size_t i = 0; i < source_->lines.size() && errors_ < most_errors; ++i) {
      line_ = static_cast<int>(i) + 1;
      const std::string_view line = source_->lines[i];
      const std::size_t first = line.find_first_not_of(" \t\r");
      if (first == line.npos || line[first] == '#') continue;
      if (unit_.empty())
        read_header(line);
      else
        read_row(line);
      if (unit_.empty()) return nullptr;
    }
    if (errors_ == 0) check_whole();
    if (errors_ > 0) return nullptr;
    scale_flux();
    return std::make_shared<const Spectrum>(std::move(spectrum_));
  }

 private:
  void error(int column, std::size_t length, std::string message, std::string help = {}) {
    ++errors_;
    reading_.error({source_, line_, column, std::max(1, static_cast<int>(length))}, std::move(message),
                   std::move(help));
  }

  /// Sets the unit of the first column where the line says what the columns are.
  void read_header(std::string_view line) {
    static constexpr std::pair<std::string_view, Dimension> quantities[] = {
        {"speed", Dimension::speed}, {"wavelength", Dimension::length}, {"energy", Dimension::energy}};
    const std::vector<Cell> cells = cells_of(line);
    const Cell& head = cells.front();
    const std::size_t open = head.text.find('['), close = head.text.rfind(']');
    const std::string_view name = head.text.substr(0, head.text.find_first_of(" \t["));
    const auto quantity = std::find_if(std::begin(quantities), std::end(quantities),
                                       [&](const auto& q) { return q.first == name; });
    if (quantity == std::end(quantities))
      return error(head.column, head.text.size(),
                   "the first line says what the columns are: a speed, wavelength or energy, then the flux",
                   std::string(header_help));
    if (open == head.text.npos || close == head.text.npos || close < open)
      return error(head.column, head.text.size(), fmt::format("the column `{}` does not say its unit", name),
                   fmt::format("write `{} [{}],flux`", name, unit_in(quantity->second)));
    const std::string_view unit = head.text.substr(open + 1, close - open - 1);
    const ParsedQuantity parsed = parse_quantity(fmt::format("1 {}", unit), quantity->second);
    if (!parsed.error.empty() || parsed.dimension != quantity->second)
      return error(head.column + static_cast<int>(open) + 1, unit.size(),
                   fmt::format("`{}` is not a unit of the column `{}`", unit, name),
                   parsed.suggestion.empty()
                       ? fmt::format("write `{} [{}],flux`", name, unit_in(quantity->second))
                       : parsed.suggestion);
    if (cells.size() != 2 || !cells[1].text.starts_with("flux"))
      return error(
          cells.size() > 1 ? cells[1].column : head.column + static_cast<int>(head.text.size()),
          cells.size() > 1 ? cells[1].text.size() : 1,
          fmt::format("a spectrum has two columns, `{}` and `flux`, with a comma between them", name),
          std::string(header_help));
    name_ = name;
    unit_ = unit;
    spectrum_.dimension = quantity->second;
  }
  static std::string_view unit_in(Dimension d) {
    return d == Dimension::speed ? "m/s" : d == Dimension::length ? "angstrom" : "meV";
  }

  void read_row(std::string_view line) {
    const std::vector<Cell> cells = cells_of(line);
    if (cells.size() != 2)
      return error(1, line.size(),
                   fmt::format("a row has two numbers, `{}` and `flux`, but {} here", name_,
                               cells.size() == 1 ? std::string("there is one")
                                                 : fmt::format("there are {}", cells.size())),
                   cells.size() > 2
                       ? "numbers have a decimal point, and a comma stands between the columns only"
                       : "a comma stands between the columns");
    double number = 0, flux = 0;
    if (!read_number(cells[0], number) || !read_number(cells[1], flux)) return;
    const double at = parse_quantity(fmt::format("{} {}", cells[0].text, unit_)).value;
    if (!(at > 0))
      return error(cells[0].column, cells[0].text.size(),
                   fmt::format("`{}` must be greater than zero", name_));
    if (!spectrum_.at.empty() && !(at > spectrum_.at.back()))
      return error(cells[0].column, cells[0].text.size(),
                   fmt::format("`{}` must rise from row to row", name_),
                   "sort the rows, and let each value stand once");
    if (flux < 0)
      return error(cells[1].column, cells[1].text.size(), "`flux` must not be negative",
                   "set what is below zero by its background to 0");
    spectrum_.at.push_back(at);
    spectrum_.flux.push_back(flux);
  }
  bool read_number(const Cell& cell, double& out) {
    const ParsedQuantity parsed = parse_quantity(cell.text);
    if (parsed.error.empty() && parsed.dimension == Dimension::number) {
      out = parsed.value;
      return true;
    }
    error(cell.column, cell.text.size(),
          cell.text.empty() ? "a number is missing here"
                            : fmt::format("`{}` is not a number", cell.text.substr(0, 40)),
          parsed.error.empty() ? "the unit stands in the first line only" : "");
    return false;
  }

  void check_whole() {
    line_ = static_cast<int>(source_->lines.size());
    if (unit_.empty())
      error(1, 1, "the file has no spectrum", std::string(header_help));
    else if (spectrum_.at.size() < 2)
      error(1, 1,
            fmt::format("a spectrum has two rows or more, but here {}",
                        spectrum_.at.empty() ? "is none" : "is one"),
            "one sharp speed is `{kind: single, value: ...}`");
    else if (std::all_of(spectrum_.flux.begin(), spectrum_.flux.end(), [](double f) { return f == 0; }))
      error(1, 1, "the flux is zero in every row");
  }

  /// Fluxes count relative to each other. A power of two takes them near 1, so that no sum or square of them
  /// overflows and none loses a bit.
  void scale_flux() {
    const int exponent = std::ilogb(*std::max_element(spectrum_.flux.begin(), spectrum_.flux.end()));
    for (double& flux : spectrum_.flux) flux = std::ldexp(flux, -exponent);
  }

  std::shared_ptr<const SourceText> source_;
  Reading& reading_;
  Spectrum spectrum_;
  std::string name_, unit_;
  int line_ = 0;
  std::size_t errors_ = 0;
};

/// The text, or why there is none.
std::string text_of(const fs::path& path, const Reading& reading, std::string& problem) {
  if (reading.stored) {
    const auto text = stored_text(*reading.stored, path.string());
    if (!text) problem = "this file was not read when the experiment was flown";
    return text.value_or("");
  }
  TextFile file = read_text_file(path);
  if (!file.problem.empty()) return problem = file.problem, "";
  std::string& text = file.text;
  if (text.size() > max_text_bytes)
    return problem = fmt::format("the file is larger than {} MiB", max_text_bytes >> 20), "";
  if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
  return std::move(text);
}

}  // namespace

std::shared_ptr<const Spectrum> read_spectrum(const Node& node, const Row& row, Reading& reading) {
  std::string name;
  if (!read_text(node, row, reading, name)) return nullptr;
  const fs::path path = (fs::path(reading.folder) / name).lexically_normal();
  const auto known = reading.files.find(path.string());
  if (known != reading.files.end()) return known->second.spectrum;
  std::string problem;
  const std::string text = text_of(path, reading, problem);
  if (!problem.empty()) {
    reading.error(node.place, fmt::format("`{}`: {}", path.string(), problem),
                  "the path begins at the folder of the beamline file");
    return nullptr;
  }
  Reading::File& file = reading.files[path.string()];
  file.source = make_source_text(path.string(), text);
  file.text = text;
  file.spectrum = SpectrumReader(file.source, reading).read();
  return file.spectrum;
}

}  // namespace rabiline
