#pragma once
// What a model gives: a motion for each way to solve it, and findings that a closed form, a conservation law
// or the paper can be held against.
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/fault.hpp"
#include "core/vector3.hpp"
#include "parameter/parameter.hpp"

namespace rabiline {

/// A number over time.
struct Course {
  std::string name, unit, meaning;
  std::vector<double> values{};  // one at each time
};
/// A vector over time, in the laboratory.
struct VectorCourse {
  std::string name, unit, meaning;
  std::vector<Vector3> values{};  // one at each time
};

/// How the model moves under one set of equations.
struct Motion {
  std::string name;                     // a word: results call it so
  std::string meaning;                  // which equations, of which theory
  std::vector<double> time{};           // [s] ascending, from 0
  std::vector<Vector3> position{};      // [m] of the centre of mass, one at each time
  std::vector<VectorCourse> vectors{};  // velocity, axis, spin, ...
  std::vector<Course> numbers{};        // energy, angles, ...
};

/// What is expected of a finding, the surest first.
enum class Expectation { closed_form, conserved, approximate, supposed };
template <>
inline constexpr auto choices<Expectation> = std::array{
    Choice<Expectation>{"closed_form", Expectation::closed_form, "closed form of the same equations"},
    Choice<Expectation>{"conserved", Expectation::conserved, "zero drift of what the equations keep"},
    Choice<Expectation>{"approximate", Expectation::approximate, "right to some order of what is small"},
    Choice<Expectation>{"supposed", Expectation::supposed,
                        "what the paper supposes; the equations need not give it"},
};
constexpr std::string_view word_of(Expectation expectation) {
  return choices<Expectation>[static_cast<std::size_t>(expectation)].word;
}

/// A number that the model finds, and what is expected of it. One that has no meaning for the given values
/// (the radius of a path without speed) is left out.
struct Finding {
  std::string name, unit, meaning;
  Expectation expectation = Expectation::closed_form;
  double value = 0;
  double expected = 0;
};

/// A number that follows from the values of a model alone, for people: "radius", "3.14 m", "of the circle".
struct Fact {
  std::string name, value, meaning;
};

struct ModelResult {
  std::vector<Motion> motions{};
  std::vector<Finding> findings{};
};

/// A finding at all points of a scan.
struct FoundAtPoints {
  std::string name, unit, meaning;
  Expectation expectation = Expectation::closed_form;  // the least sure of all points
  std::vector<double> values{}, expected{};            // one at each point; NaN where it has none
};
/// Every finding that any point has, in order of appearance.
std::vector<FoundAtPoints> findings_of(const std::vector<ModelResult>& points);

}  // namespace rabiline
