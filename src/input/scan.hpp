#pragma once
// What is scanned: `scan` in the file and --scan on the command line, as lists of values in the file's own
// form.
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "beamline/beamline.hpp"
#include "input/document.hpp"
#include "input/values.hpp"

namespace rabiline {

/// How the values of a range are spread between its ends.
enum class ScanSpacing { linear, logarithmic };
template <>
inline constexpr std::array choices<ScanSpacing>{
    Choice<ScanSpacing>{"linear", ScanSpacing::linear, "equal steps"},
    Choice<ScanSpacing>{"logarithmic", ScanSpacing::logarithmic,
                        "equal ratios; both ends on the same side of zero"},
};

/// One entry of `scan`, as it stands in the file.
struct ScanEntry {
  std::string parameter;
  std::optional<Node> from, to;
  std::optional<std::uint64_t> points;
  std::optional<ScanSpacing> spacing;
  std::optional<Node> values;
  std::optional<ScanParticles> particles;
};
inline constexpr double max_scan_points = 1e6;
inline constexpr Range scan_points{2, max_scan_points, true, true, "from 2 to 1000000"};
template <>
inline constexpr auto parameters<ScanEntry> = std::tuple{
    param("parameter", &ScanEntry::parameter,
          "dotted name of what is scanned: H0.frequency, source.speed.mean, law"),
    param("from", &ScanEntry::from, "first value of a range"),
    param("to", &ScanEntry::to, "last value of a range"),
    param("points", &ScanEntry::points, Dimension::number, scan_points,
          "how many values, both ends included"),
    param("spacing", &ScanEntry::spacing, "how the values of a range are spread; linear where it is missing"),
    param("values", &ScanEntry::values, "instead of a range: the values one by one, in brackets"),
    param("particles", &ScanEntry::particles,
          "whether scan points share their particles; shared where it is missing"),
};

/// One axis of the scan: the parameter and the value of each of its points.
struct Axis {
  std::string parameter;
  Place place;
  std::vector<Node> values;
  bool is_range = false;  // else the values were written one by one
};

struct ScanPlan {
  std::vector<Axis> axes;  // the outer one first
  ScanParticles particles = ScanParticles::shared;
};

/// Reads `scan`. An axis that the command line scans too gives way to it; further ones go outside.
ScanPlan read_scan(const Node& root, const std::vector<std::shared_ptr<const SourceText>>& arguments,
                   Reading&);

}  // namespace rabiline
