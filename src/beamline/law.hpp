#pragma once
// The law of motion: always an explicit choice, recorded in every result.
#include <array>
#include <string>
#include <string_view>
#include <tuple>
#include <variant>

#include "parameter/parameter.hpp"

namespace rabiline {

/// What becomes of a particle whose level a deflecting magnet asks for. `coherent_drawn` is `coherent` for
/// the flight of one particle alone, of which a magnet draws one level.
enum class Outcomes { split, sample, coherent, coherent_drawn };
template <>
inline constexpr auto choices<Outcomes> = std::array{
    Choice<Outcomes>{"split", Outcomes::split,
                     "its weight is shared out over the levels: less noise, and scans fly each path once"},
    Choice<Outcomes>{"sample", Outcomes::sample, "one level is drawn for each particle"},
    Choice<Outcomes>{
        "coherent", Outcomes::coherent,
        "as `split`; but a field that differs from place to place leaves the levels coherent where it "
        "neither surely keeps nor surely destroys their phases"},
};

/// What steps through fields are chosen for where nothing else is asked for.
inline constexpr double usual_tolerance = 1e-6;
inline constexpr Range tolerances{1e-10, 1e-2, true, true, "from 1e-10 to 1e-2"};

struct QuantumLaw {
  static constexpr std::string_view kind = "quantum",
                                    meaning = "standard physics: levels, coherent while fields drive them";
  Outcomes outcomes = Outcomes::split;
  double tolerance = usual_tolerance;
  bool operator==(const QuantumLaw&) const = default;
};

template <>
inline constexpr auto parameters<QuantumLaw> = std::tuple{
    param("outcomes", &QuantumLaw::outcomes, "what becomes of the levels that a deflecting magnet asks for",
          Outcomes::split),
    param("tolerance", &QuantumLaw::tolerance, Dimension::number, tolerances,
          "error of probabilities, and of the path over its length, where fields are flown through in steps",
          usual_tolerance),
};

struct ClassicalLaw {
  static constexpr std::string_view kind = "classical",
                                    meaning = "standard physics, large-spin limit: a Bloch vector";
  double tolerance = usual_tolerance;
  bool operator==(const ClassicalLaw&) const = default;
};

template <>
inline constexpr auto parameters<ClassicalLaw> = std::tuple{
    param("tolerance", &ClassicalLaw::tolerance, Dimension::number, tolerances,
          "error of spins, and of the path over its length, where fields are flown through in steps",
          usual_tolerance),
};

/// How the hypothesis closes: which angular velocity W turns the velocity, dv/dt = kappa W x v.
enum class Closure {
  torque,  // W = S x (dS/dt) / |S|^2: the turning that the torque itself asks for (eqs. 8-10, 29, 33, 57, 64)
  larmor   // W = -gamma B: the whole Larmor rotation (eqs. 34-41)
};
template <>
inline constexpr auto choices<Closure> = std::array{
    Choice<Closure>{"torque", Closure::torque, "W = S x (dS/dt)/|S|^2: no torque, straight flight"},
    Choice<Closure>{"larmor", Closure::larmor, "W = -gamma B: the whole Larmor rotation"},
};

/// What the hypothesis keeps the path to where nothing else is asked for, over the length of the flight.
inline constexpr double usual_path_error = 1e-6;

/// The hypothesis that the velocity turns jointly with the spin; it replaces the Lorentz force.
struct DoradoLaw {
  static constexpr std::string_view kind = "dorado",
                                    meaning = "a hypothesis: the velocity turns jointly with the spin";
  Closure closure = Closure::torque;
  double kappa = 1;                      // strength; 0 is straight flight, 1 is the paper
  double path_error = usual_path_error;  // over the length of the flight
  bool operator==(const DoradoLaw&) const = default;
};
template <>
inline constexpr auto parameters<DoradoLaw> = std::tuple{
    param("closure", &DoradoLaw::closure, "which angular velocity turns the velocity", Closure::torque),
    param("kappa", &DoradoLaw::kappa, Dimension::number, range::any,
          "strength of the hypothesis: 0 is straight flight, 1 is the paper", 1.0),
    param("path_error", &DoradoLaw::path_error, Dimension::number,
          Range{1e-9, 1e-3, true, true, "from 1e-9 to 1e-3"},
          "the path's error over its length, about, that steps are chosen for; a hundredth of it takes three "
          "times the steps",
          usual_path_error),
};

using Law = std::variant<QuantumLaw, ClassicalLaw, DoradoLaw>;
template <>
inline constexpr std::string_view tag_key<Law> = "name";

/// "quantum", or "dorado (torque, kappa = 1)".
std::string describe(const Law&);

/// What a law does with levels and velocities: all that anything else knows of it.
struct LawTraits {
  double tolerance = usual_tolerance;  // what steps are chosen for
  bool has_levels = false;             // spins are found in levels; else they are vectors
  bool splits = false;                 // weights are shared out over the levels that a magnet asks for
  bool stays_coherent = false;         // where a field neither surely keeps nor surely destroys phases
  bool has_forces = true;              // Lorentz's on charges, and that of a gradient on moments
  double kappa = 0;                    // of its spin's turning, the share by which the velocity turns
  Closure closure = Closure::torque;   // what of the turning that is
};
LawTraits law_traits(const Law&);
/// The same law, under which a particle is found in one level where it asks for levels.
Law without_splitting(Law);

}  // namespace rabiline
