#include "storage/flight_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "storage/hdf5_reader.hpp"
#include "storage/hdf5_writer.hpp"
#include "storage/origin.hpp"

namespace rabiline {
namespace {

/// Raised where the same sums come to mean something else.
constexpr std::uint64_t flight_version = 2;
constexpr std::size_t most_kept_sums = std::size_t{1} << 29, most_cells = std::size_t{1} << 16,
                      most_stragglers = std::size_t{1} << 24, most_kept_text = std::size_t{1} << 26;

[[noreturn]] void refuse_result(const std::filesystem::path& path, std::string_view why) {
  throw StorageError(fmt::format("{}: {}", path.string(), why));
}

FlightRecord read_record(const std::filesystem::path& path, const hdf5::FileReader& file) {
  const auto in_flight = [](const char* name) { return std::string("entry/flight/") + name; };
  if (!file.contains(in_flight("version")) ||
      file.numbers(in_flight("version"), 1) != std::vector{flight_version})
    refuse_result(path, "its flight was kept by another version of the program\n  help: fly it again");
  FlightRecord record;
  record.asked_for = true;
  record.totals_of = file.texts(in_flight("totals_of"), most_kept_text);
  const auto first = file.reals(in_flight("cells_first"), most_cells),
             width = file.reals(in_flight("cells_width"), most_cells);
  const auto count = file.numbers(in_flight("cells_count"), most_cells);
  if (first.size() != width.size() || first.size() != count.size())
    refuse_result(path, "its cells of the slowness are incomplete");
  for (std::size_t i = 0; i < first.size(); ++i) {
    if (!std::isfinite(first[i]) || !(width[i] > 0) || count[i] == 0 || count[i] > most_kept_sums)
      refuse_result(path, "its cells of the slowness are damaged");
    record.cells.push_back({first[i], width[i], static_cast<int>(count[i])});
  }
  const auto halvings = file.numbers(in_flight("halvings"), 1);
  if (halvings.empty() || halvings[0] > 20) refuse_result(path, "its part of the particles is damaged");
  record.halvings = static_cast<int>(halvings[0]);
  const auto size = file.numbers(in_flight("sums"), 1);
  const auto place = file.numbers(in_flight("place"), most_kept_sums),
             high = file.numbers(in_flight("high"), most_kept_sums),
             low = file.numbers(in_flight("low"), most_kept_sums);
  if (size.empty() || size[0] > most_kept_sums || place.size() != high.size() || place.size() != low.size())
    refuse_result(path, "its moments are incomplete");
  record.sums.resize(size[0]);
  for (std::size_t i = 0; i < place.size(); ++i) {
    if (place[i] >= size[0]) refuse_result(path, "its moments are damaged");
    record.sums[place[i]] = (static_cast<Sum>(high[i]) << 64) | low[i];
  }
  const auto trees = file.numbers(in_flight("straggler_trees"), most_stragglers),
             particles = file.numbers(in_flight("straggler_particles"), most_stragglers);
  if (trees.size() != particles.size()) refuse_result(path, "its list of stragglers is incomplete");
  for (std::size_t i = 0; i < trees.size(); ++i) record.stragglers.push_back({trees[i], particles[i]});
  return record;
}

}  // namespace

std::size_t size_in_file(const FlightRecord& record) {
  const auto kept =
      record.sums.size() - static_cast<std::size_t>(std::count(record.sums.begin(), record.sums.end(), 0));
  return 5 * kept + 16 * record.stragglers.size();  // packed; measured: 2 to 6
}

void nexus::write_flight(const hdf5::GroupWriter& entry, const FlightRecord& record) {
  const hdf5::GroupWriter group = entry.group("flight", "NXcollection");
  group.attribute("meaning",
                  "what `rabiline rescan` computes other scans from: exact sums of the flight that depend on "
                  "no scan point, among them moments of the slowness 1/v in cells; sum = high * 2^64 + low "
                  "at each place that is not zero");
  std::vector<double> first, width;
  std::vector<std::uint64_t> count, place, high, low, trees, particles;
  for (const SlownessCells& cells : record.cells) {
    first.push_back(cells.first);
    width.push_back(cells.width);
    count.push_back(static_cast<std::uint64_t>(cells.count));
  }
  for (std::size_t i = 0; i < record.sums.size(); ++i) {
    if (record.sums[i] == 0) continue;
    place.push_back(i);
    high.push_back(static_cast<std::uint64_t>(record.sums[i] >> 64));
    low.push_back(static_cast<std::uint64_t>(record.sums[i]));
  }
  for (const Straggler& s : record.stragglers) {
    trees.push_back(s.tree);
    particles.push_back(s.particle);
  }
  const std::vector<std::uint64_t> size{record.sums.size()},
      halvings{static_cast<std::uint64_t>(record.halvings)};
  group.dataset("version", {1}, std::vector{flight_version}, {{"long_name", "version of what is kept"}});
  group.dataset("totals_of", {record.totals_of.size()}, record.totals_of,
                {{"long_name", "parts whose bins are added up and whose tallies are left out"}});
  group.dataset("cells_first", {first.size()}, first,
                {{"units", "s/m"}, {"long_name", "slowness where the cells begin (s/m)"}});
  group.dataset("cells_width", {width.size()}, width,
                {{"units", "s/m"}, {"long_name", "width of a cell (s/m)"}});
  group.dataset("cells_count", {count.size()}, count, {{"long_name", "number of cells"}});
  group.dataset("sums", {1}, size, {{"long_name", "number of sums, those that are zero included"}});
  group.dataset("halvings", {1}, halvings,
                {{"long_name", "how often the particles were halved, as fewer were enough"}});
  group.dataset("place", {place.size()}, place, {{"long_name", "place among the sums"}});
  group.dataset("high", {high.size()}, high, {{"long_name", "upper 64 bits"}});
  group.dataset("low", {low.size()}, low, {{"long_name", "lower 64 bits"}});
  group.dataset("straggler_trees", {trees.size()}, trees,
                {{"long_name", "species in the beam of each particle outside the cells"}});
  group.dataset("straggler_particles", {particles.size()}, particles,
                {{"long_name", "numbers of the particles outside the cells"}});
}

namespace {

/// What a run that was to keep its flight has said of it, or how to keep it.
std::string why_not_kept(const hdf5::FileReader& file) {
  constexpr std::string_view said = "nothing is kept for `rabiline rescan`: ";
  constexpr std::size_t most_text = std::size_t{1} << 26;
  if (file.contains("entry/simulation/warnings"))
    for (const std::string& warning : file.texts("entry/simulation/warnings", most_text))
      if (warning.starts_with(said))
        return fmt::format("fly the other scan with `rabiline run`, as none follows from this flight: {}",
                           warning.substr(said.size(), warning.find('\n') - said.size()));
  return "fly it again with `--transit totals`, which keeps them or says why it cannot";
}

}  // namespace

KeptFlight read_kept_flight(const std::filesystem::path& path) {
  const hdf5::FileReader file(path);
  Origin origin = read_origin(file, path);
  if (!file.contains("entry/flight"))
    refuse_result(path, "keeps no moments of its flight, so other scans do not follow from it\n  help: " +
                            why_not_kept(file));
  return {std::move(origin.inputs), std::move(origin.changes), read_record(path, file)};
}

}  // namespace rabiline
