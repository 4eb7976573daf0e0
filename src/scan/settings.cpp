#include "scan/settings.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <set>
#include <tuple>

namespace rabiline {
namespace {

Setting read_setting(const std::shared_ptr<const SourceText>& source, Reading& reading) {
  if (!is_one_line(source, reading)) return {};
  const std::string& text = source->lines.front();
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0) {
    reading.error({source, 1, 1, std::max(1, static_cast<int>(text.size()))}, "a value is set as NAME=VALUE",
                  "such as `H0.amplitude=0.3 uT`");
    return {};
  }
  Node value = parse_value(source, equals + 1, text.size() - equals - 1);
  const std::string name = text.substr(0, equals);
  if (!value.is_null()) return {name, {source, 1, 1, static_cast<int>(equals)}, std::move(value)};
  reading.error({source, 1, static_cast<int>(equals) + 2, 1}, fmt::format("`{}` is set to nothing", name),
                "write the value after `=`");
  return {};
}

}  // namespace

std::vector<Setting> read_settings(const Changes& changes, Sources& sources, Reading& reading) {
  std::vector<Setting> out;
  for (const std::string& text : changes.set) {
    sources.push_back(make_source_text(changes.dashes + "set", text));
    out.push_back(read_setting(sources.back(), reading));
  }
  const auto add_count = [&](const std::string& name, const std::optional<std::string>& value) {
    if (!value) return;
    sources.push_back(make_source_text(changes.dashes + name, *value));
    if (!is_one_line(sources.back(), reading)) return;
    const Node node = parse_value(sources.back(), 0, sources.back()->lines[0].size());
    if (node.is_null())
      reading.error({sources.back(), 1, 1, 1}, fmt::format("`{}` is set to nothing", changes.dashes + name),
                    "write a number behind it, or omit it");
    else
      out.push_back({name, node.place, node});
  };
  add_count("particles", changes.particles);
  add_count("seed", changes.seed);
  std::set<std::string> names;
  for (const Setting& s : out)
    if (!s.name.empty() && !names.insert(s.name).second)
      reading.error(s.place, fmt::format("`{}` is set twice", s.name), "keep one of the values");
  return out;
}

std::uint64_t read_argument(const std::string& option, const std::string& text, const Range& range) {
  Reading reading;
  const auto source = make_source_text(option, text);
  std::uint64_t out = 0;
  if (!read_count(parse_value(source, 0, source->lines.front().size()),
                  {option, Dimension::number, range, ""}, reading, out))
    throw InputError(std::move(reading.errors));
  return out;
}

double read_time_argument(const std::string& option, const std::string& text, const Range& range) {
  Reading reading;
  const auto source = make_source_text(option, text);
  double out = 0;
  if (read_quantity(parse_value(source, 0, source->lines.front().size()),
                    {option, Dimension::time, range, ""}, reading, out))
    return out;
  // Who waits for a program does not count in microseconds.
  const std::string example = fmt::format("`{}`", example_of(Dimension::time));
  for (Diagnostic& error : reading.errors)
    if (const std::size_t at = error.suggestion.find(example); at != std::string::npos)
      error.suggestion.replace(at, example.size(), "`10 min`");
  throw InputError(std::move(reading.errors));
}

std::uint64_t read_memory_argument(const std::string& option, const std::string& text) {
  constexpr std::array<std::string_view, 3> units{"MiB", "GiB", "TiB"};
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  std::string_view unit(end, text.data() + text.size());
  unit.remove_prefix(std::min(unit.find_first_not_of(' '), unit.size()));
  const auto found = std::ranges::find(units, unit);
  constexpr double most = 1 << 20;           // of the largest unit
  constexpr double least = 1.0 / (1 << 20);  // a byte
  if (error != std::errc() || found == units.end() || !(number >= least) || number > most) {
    const auto source = make_source_text(option, text);
    throw InputError({{{source, 1, 1, static_cast<int>(text.size())},
                       fmt::format("`{}` is not a size of memory", text),
                       "write a number greater than zero with MiB, GiB or TiB, such as 2GiB"}});
  }
  return static_cast<std::uint64_t>(
      number * static_cast<double>(std::uint64_t{1} << (20 + 10 * (found - units.begin()))));
}

Sources scan_arguments(const Changes& changes, Sources& sources) {
  Sources out;
  for (const std::string& text : changes.scan) out.push_back(make_source_text(changes.dashes + "scan", text));
  sources.insert(sources.end(), out.begin(), out.end());
  return out;
}

void refuse_settings_of_scanned(const std::vector<Setting>& settings, const ScanPlan& plan,
                                Reading& reading) {
  for (const Setting& s : settings)
    for (const Axis& axis : plan.axes)
      for (const NamedAt& scanned : axis.parameters)
        if (!scanned.name.empty() && (s.name == scanned.name || s.name.starts_with(scanned.name + ".")))
          reading.error(s.place, fmt::format("`{}` is scanned, so it cannot be set as well", scanned.name),
                        fmt::format("replace the scan: `--scan {}=...`", scanned.name));
}

void add_files(const Reading& reading, std::vector<InputText>& inputs, Sources& sources) {
  for (const auto& [path, file] : reading.files) {
    if (std::find(sources.begin(), sources.end(), file.source) != sources.end()) continue;
    inputs.push_back({path, file.text});
    sources.push_back(file.source);
  }
}

void throw_if_wrong(Reading& reading, const Sources& sources) {
  if (reading.errors.empty()) return;
  const auto key = [&](const Diagnostic& d) {
    const auto found = std::find(sources.begin(), sources.end(), d.place.text);
    return std::tuple(found - sources.begin(), d.place.line, d.place.column);
  };
  std::stable_sort(reading.errors.begin(), reading.errors.end(),
                   [&](const Diagnostic& a, const Diagnostic& b) { return key(a) < key(b); });
  const auto same = [&](const Diagnostic& a, const Diagnostic& b) {
    return key(a) == key(b) && a.message == b.message;
  };
  reading.errors.erase(std::unique(reading.errors.begin(), reading.errors.end(), same), reading.errors.end());
  throw InputError(std::move(reading.errors));
}

}  // namespace rabiline
