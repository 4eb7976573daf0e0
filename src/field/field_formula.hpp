#pragma once
// Fields as formulas in place and time, sampled onto the nodes of maps.
#include <array>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "field/field_map.hpp"

namespace rabiline {

/// The components of a field in x, y and z [m] and, where it moves, t [s]; named constants in SI.
struct FieldFormula {
  std::array<std::string, 3> components{"0", "0", "0"};
  std::map<std::string, double> constants;
  double frequency = 0;  // [Hz] with which it repeats in t
  double duration = 0;   // [s] or else for which it is worked out from t = 0 on
  bool moves() const { return frequency > 0 || duration > 0; }
};
/// What of a field swings as cos(k 2 pi f t), or as the sine of that; k = 0: what stands.
struct FieldHarmonic {
  int number = 0;
  bool sine = false;
  MapNodes nodes;
};
inline constexpr int most_field_harmonics = 4;

/// What of a field is B(r) f(t), with f between -1 and 1.
struct FieldOfCourse {
  MapNodes nodes;
  std::vector<double> course, stops;  // f as TimeCourse has it, from t = 0 to `duration`
};
inline constexpr int most_field_courses = 8;

/// What is wrong with the text of one component, and where in it: at `length` characters from `from` on.
struct FormulaFault : std::runtime_error {
  FormulaFault(const std::string& message, std::string help_)
      : runtime_error(message), help(std::move(help_)) {}
  std::string help;
  std::size_t component = 0, from = 0, length = 0;
};

/// Whether a formula can have a constant of that name: a letter, then letters, digits or `_`, and no word
/// with a meaning of its own.
bool can_name_constant(const std::string&);

/// The field at the nodes of these axes, x, y, z, as the sum of its harmonics in t; those that are nothing
/// are left out, but for the first. Throws FormulaFault, also where no formula has t although it has a
/// frequency (component 3), and where it needs more harmonics.
std::vector<FieldHarmonic> sampled(const FieldFormula&, const std::array<MapAxis, 3>& axes);

/// The field at these nodes while its duration lasts, as the sum of fields with a course in time each. Throws
/// FormulaFault, also where no formula has t, where it needs more of them, or jumps (component 3).
std::vector<FieldOfCourse> sampled_in_time(const FieldFormula&, const std::array<MapAxis, 3>& axes);

}  // namespace rabiline
