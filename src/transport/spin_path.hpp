#pragma once
// How the spins of a straight flight are carried from where they were last known to where they are asked for.
#include <vector>

#include "spin/driven_levels.hpp"
#include "transport/kernels.hpp"
#include "transport/level_way.hpp"

namespace rabiline {

struct SpinPath {
  int levels = 0;           // that are told apart at its end; 0: a vector law, whose spin has a projection
  bool from_level = false;  // quantum, and nothing has turned the spin before: one zone has a closed form
  std::vector<SpinZone> zones{};
  std::vector<double> polynomials{};          // MajoranaTable::coefficients
  bool of_atom = false;                       // whose levels no field turns
  const DrivenLevels* transitions = nullptr;  // of an atom that fields drive; a plan makes each once
  const LevelWay* way = nullptr;              // of an atom, instead, through fields without a closed form
  bool operator==(const SpinPath&) const = default;

  /// Nothing on the way acts on spins.
  bool is_idle() const { return zones.empty() && transitions == nullptr && way == nullptr; }
  /// What kernels see of it, which it must outlive.
  SpinPathView view(const RandomKey&) const;
  double cost(double speed) const;
};

/// Time for the turning of spins in zones [s].
double cost_of(const std::vector<SpinZone>&, double speed);

/// The weights of atoms shared out over their levels, a column for each: by what acts on the way, or where
/// nothing does by the level that each is in.
void share_levels(const SpinPath&, const RandomKey&, Isa, const BatchView&, const std::uint64_t* weights,
                  std::uint64_t* shares);

}  // namespace rabiline
