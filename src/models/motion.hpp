#pragma once
// What a model gives: a motion for each way to solve it, and findings that a closed form or a conservation
// law can be held against.
#include <string>
#include <vector>

#include "field/vector3.hpp"

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

/// A number that the model finds, and what is expected of it: a closed form, or zero for the drift of what is
/// conserved. One that has no meaning for the given values (the radius of a path without speed) is left out.
struct Finding {
  std::string name, unit, meaning;
  double value = 0;
  double expected = 0;
};

/// A number that follows from the values of a model alone, for people: "radius", "3.14 m", "of the circle".
struct Fact {
  std::string name, value, meaning;
};

/// Values that are each fine and do not go together: which key of the model to blame, and why.
struct Fault {
  std::string key, message, suggestion;
};

struct ModelResult {
  std::vector<Motion> motions{};
  std::vector<Finding> findings{};
};

}  // namespace rabiline
