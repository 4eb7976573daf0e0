#pragma once
// What is scanned, as results keep it.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "parameter/parameter.hpp"

namespace rabiline {

/// Whether scan points fly the same particles (smooth curves, correlated points) or each its own.
enum class ScanParticles { shared, independent };
template <>
inline constexpr auto choices<ScanParticles> = std::array{
    Choice<ScanParticles>{"shared", ScanParticles::shared,
                          "every scan point flies the same particles: smooth curves"},
    Choice<ScanParticles>{"independent", ScanParticles::independent,
                          "every scan point draws its own particles"},
};

/// One scanned parameter, or several that change together, and its values, for axes of results.
struct ScanAxis {
  std::string parameter;               // dotted name, e.g. "H0.frequency"; several with ", " between
  std::optional<Dimension> dimension;  // none for a categorical axis such as "law"
  std::vector<double> values;          // [SI]; the index 0, 1, ... for a categorical axis
  std::vector<std::string> labels;     // of a categorical axis, else empty
  std::string unit{};  // that the values are written in, for people; empty where they have none
};
/// A value of the axis for people, in the unit that it is written in.
std::string value_at(const ScanAxis&, std::size_t i);

}  // namespace rabiline
