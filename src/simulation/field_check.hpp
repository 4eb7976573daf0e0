#pragma once
// Flights in steps held against an independent integration of the same equations, in every run.
#include <optional>

#include "plan/plan.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// Flies the first few particles of the plan up to each region with fields that differ from place to place
/// and each deflecting magnet, and through it both ways: by the kernel, and by GSL's rk8pd, in a region with
/// y as the variable (P. Prince and J. Dormand, J. Comput. Appl. Math. 7, 67 (1981)). Those that turn back or
/// meet a wall inside are left out. Levels of atoms that are carried as amplitudes through whole fields are
/// held against both spins in the laboratory (LevelReference), of as many particles as a second suffices for.
/// Nothing where there is neither.
std::optional<FieldCheck> check_fields(const Plan&, Isa);

}  // namespace rabiline
