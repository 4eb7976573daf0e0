#pragma once
// What is scanned: `scan` in the file and --scan on the command line, as lists of values in the file's own
// form.
#include <array>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "beamline/scan.hpp"
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

/// A dotted name and where it stands.
struct NamedAt {
  std::string name;
  Place place;
};
/// What an axis changes: one parameter, or several that change together.
struct ScannedNames {
  std::vector<NamedAt> names;
};
template <>
struct ValueType<ScannedNames> {
  static constexpr std::string_view
      example = "H0.frequency",
      what = "dotted name, or a list of them",
      schema =
          R"({"anyOf": [{"type": "string"}, {"type": "array", "minItems": 1, "items": {"type": "string"}}]})";
  static bool read(const Node&, const Row&, Reading&, ScannedNames& out);
};

/// One entry of `scan`, as it stands in the file.
struct ScanEntry {
  ScannedNames parameter;
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
    param(
        "parameter", &ScanEntry::parameter,
        "what is scanned: H0.frequency, source.speed.mean, law, variables.B1; the names in a list take each "
        "value together"),
    param("from", &ScanEntry::from, "first value of a range"),
    param("to", &ScanEntry::to, "last value of a range"),
    param("points", &ScanEntry::points, Dimension::number, scan_points,
          "how many values, both ends included"),
    param("spacing", &ScanEntry::spacing, "how the values of a range are spread; linear if omitted"),
    param("values", &ScanEntry::values, "instead of a range: the values one by one, in brackets"),
    param("particles", &ScanEntry::particles, "whether scan points share their particles; shared if omitted"),
};

/// One axis of the scan: what it changes and the value of each of its points.
struct Axis {
  /// Both ends keep their text, so they are exact; the values between are written in SI, which loses no bit.
  struct Range {
    Node from, to;
    double first, last;  // [SI]
    Dimension dimension;
    std::size_t points;
    ScanSpacing spacing;
  };
  std::vector<NamedAt> parameters;
  Place place;
  std::variant<std::vector<Node>, Range> values;

  bool is_range() const { return std::holds_alternative<Range>(values); }
  std::size_t size() const;
  Node value(std::size_t point) const;
  /// "C1.amplitude, C2.amplitude"
  std::string name() const;
};

struct ScanPlan {
  std::vector<Axis> axes;  // the outer one first
  ScanParticles particles = ScanParticles::shared;
};

/// Whether a variable is scanned, so that each point puts it in place anew.
bool scans_variables(const ScanPlan&);

/// Whether an argument of the command line is one line: nothing behind its end would be read.
bool is_one_line(const std::shared_ptr<const SourceText>& argument, Reading&);

/// Reads `scan`. An axis that the command line scans too gives way to it; further ones go outside.
/// `root` is null where the file's scan is omitted.
ScanPlan read_scan(const Node* root, const std::vector<std::shared_ptr<const SourceText>>& arguments,
                   Reading&);

}  // namespace rabiline
