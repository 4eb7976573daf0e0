#include "samples.hpp"

#include <stdlib.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

namespace rabiline::samples {
namespace {

/// `count` numbers from `first` on, upwards in steps of one.
std::vector<double> numbers(double first, std::size_t count) {
  std::vector<double> values(count);
  for (std::size_t i = 0; i < count; ++i) values[i] = first + static_cast<double>(i);
  return values;
}

std::vector<double> scaled(std::vector<double> values, double factor) {
  for (double& value : values) value *= factor;
  return values;
}

DetectorResult detector(const std::string& name, std::size_t points, double offset) {
  constexpr std::size_t nx = 4, nz = 3;
  DetectorResult made;
  made.name = name;
  made.label = name + " S′";
  made.y = 1.2;
  made.x = {"x", {-2e-3, -1e-3, 0, 1e-3, 2e-3}};
  made.z = {"z", {-1.5e-3, -0.5e-3, 0.5e-3, 1.5e-3}};
  made.counts = numbers(offset, points * nx * nz);
  made.counts_errors = scaled(made.counts, 0.1);
  made.counts_x = numbers(offset + 1000, points * nx);
  made.counts_x_errors = scaled(made.counts_x, 0.1);
  made.counts_z = numbers(offset + 2000, points * nz);
  made.counts_z_errors = scaled(made.counts_z, 0.1);
  for (std::size_t i = 0; i < points; ++i) {
    made.detected.push_back(0.5 + 0.4 * std::cos(0.7 * static_cast<double>(i) + offset));
    made.detected_errors.push_back(0.01 + 0.001 * static_cast<double>(i));
  }
  constexpr std::size_t most = 2048;  // points that a covariance is kept of
  if (points > 1 && points <= most) made.detected_covariance = numbers(offset + 3000, points * points);
  made.level_labels = {"m = 1/2", "m = -1/2"};
  made.levels = scaled(numbers(offset, points * 2), 1e-3);
  made.levels.front() = std::numeric_limits<double>::quiet_NaN();
  made.levels_errors = scaled(made.levels, 0.1);
  return made;
}

FateResult fate(const std::string& name, const std::string& where, std::size_t points, double particles) {
  return {name,
          where,
          std::vector<std::uint64_t>(points, 3),
          std::vector<std::uint64_t>(points, 0xfedcba9876543210),
          std::vector<double>(points, particles),
          {}};
}

Provenance provenance() {
  return {{"rabiline", "run", "bench.yaml"},
          {{"bench.yaml", "rabiline: 1\ntitle: B′ and B\n"}, {"../geometries/empty.yaml", ""}},
          {"--set", "B.field=9 mT"},
          "2026-03-01T10:00:00+01:00",
          "2026-03-01T10:00:05+01:00",
          "0.1.0",
          "g++ 12.2",
          "avx2",
          "bench",
          {"`H0` cannot be resonant\n  help: write `sense: co`"},
          2,
          5.25};
}

}  // namespace

Folder::Folder() {
  std::string name = (std::filesystem::temp_directory_path() / "rabiline-test-XXXXXX").string();
  path_ = ::mkdtemp(name.data());
}
Folder::~Folder() { std::filesystem::remove_all(path_); }

std::vector<std::string> Folder::names() const {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(path_))
    names.push_back(entry.path().filename());
  std::sort(names.begin(), names.end());
  return names;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

void put_bytes(const std::filesystem::path& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

ScanAxis frequency_axis(std::size_t points) {
  return {"H0.frequency", Dimension::frequency, scaled(numbers(266.6, points), 1e3), {}};
}
ScanAxis field_axis(std::size_t points) {
  return {"B.field", Dimension::magnetic_field, scaled(numbers(9, points), 1e-3), {}};
}
ScanAxis law_axis() { return {"law", std::nullopt, {0, 1}, {"quantum", "dorado (torque, kappa = 1)"}}; }

Result result(std::vector<ScanAxis> axes, std::vector<std::string> detectors) {
  Result made;
  made.title = "Bench with B′ and B";
  made.axes = std::move(axes);
  std::size_t points = 1;
  for (const ScanAxis& axis : made.axes) points *= axis.values.size();
  made.laws.assign(points, "dorado (torque, kappa = 1)");
  made.species.assign(points, "neutron");
  made.particles = 10000;
  made.seed = 0xffffffffffffffff;
  made.solid_angle = 1.5e-6;
  made.aimed_fraction.assign(points, 2.5e-7);
  made.rate = 1e6;
  made.emitted.assign(points, 10000);
  made.emitted_quanta_high.assign(points, 0);
  made.emitted_quanta_low.assign(points, 10000ull << 40);
  double offset = 0;
  for (const std::string& name : detectors) made.detectors.push_back(detector(name, points, offset += 10));
  made.fates = {fate("detected", "screen", points, 9000), fate("stopped", "chamber", points, 1000)};
  made.provenance = provenance();
  return made;
}

std::vector<Track> tracks() {
  std::vector<Track> made;
  for (const std::uint64_t particle : {7u, 11u, 7u}) {
    Track track;
    track.particle = particle;
    track.species = "neutron";
    track.fate = "stopped";
    track.where = "chamber";
    double first = 0;
    for (auto column : {&Track::t, &Track::x, &Track::y, &Track::z, &Track::vx, &Track::vy, &Track::vz,
                        &Track::sx, &Track::sy, &Track::sz, &Track::weight}) {
      track.*column = numbers(first += 100, 5);
    }
    made.push_back(track);
  }
  return made;
}

Snapshot snapshot(std::uint64_t number, std::size_t sums) {
  Snapshot made;
  made.fingerprint = "experiment 1938";
  made.particles = ~std::uint64_t{0};
  made.changes = {"--set", "H0.amplitude=0.3 uT"};
  made.transit = KeptTransit::totals;
  made.max_memory = 3;
  made.begun = "2026-11-22T15:00:00+0000";
  made.seconds = 0.25 + static_cast<double>(number);
  made.finished = {{0, number + 1}, {number + 1, number + 5}, {number + 9, ~std::uint64_t{0}}};
  made.sums.size = 2 * sums;
  for (std::uint64_t i = 0; i < sums; ++i) {
    made.sums.at.push_back(2 * i + i % 2);
    made.sums.high.push_back(i % 7);
    made.sums.low.push_back((i + number) * 0x9e3779b97f4a7c15);
  }
  made.arguments = {"rabiline", "run", "", "bench.yaml", "--set", "H0.amplitude=0.3 uT"};
  made.inputs = {{"bench.yaml", "rabiline: 1\ntitle: B′\n"}, {"empty.yaml", ""}};
  return made;
}

bool same(const Snapshot& a, const Snapshot& b) {
  const auto same_input = [](const InputText& left, const InputText& right) {
    return left.path == right.path && left.text == right.text;
  };
  return a.fingerprint == b.fingerprint && a.particles == b.particles && a.shard == b.shard &&
         a.changes == b.changes && a.transit == b.transit && a.max_memory == b.max_memory &&
         a.begun == b.begun && a.seconds == b.seconds && a.finished == b.finished && a.sums == b.sums &&
         a.arguments == b.arguments &&
         std::equal(a.inputs.begin(), a.inputs.end(), b.inputs.begin(), b.inputs.end(), same_input);
}

}  // namespace rabiline::samples
