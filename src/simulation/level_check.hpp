#pragma once
// Levels of atoms that were carried through fields of any direction, held against the whole Hamiltonian of
// both spins.
#include <optional>
#include <vector>

#include "transport/spin_path.hpp"

namespace rabiline {

/// One particle at a plane from where its flight is straight, before and behind.
struct StraightFlight {
  Vector3 place, velocity;  // [m], [m/s]
  double t = 0;             // [s]
  Fall fall{};
  std::uint64_t particle = 0;
  int level = 0;
};

/// Where both spins are followed in the laboratory, in products of their states: no frame moves with the
/// field, no table says what levels do, and F far apart are coupled like all others. Within a step the field
/// is the polynomial of third degree in the time through four points, and the state its Taylor series; steps
/// are halved until probabilities are known.
class LevelReference {
 public:
  /// Not where something drives in the rotating-wave approximation: that is no whole field.
  static bool is_for(const LevelWay& way) { return way.fields().waves.empty(); }

  LevelReference(const LevelWay&, const RandomKey&);
  /// The probabilities of all levels at the end. Takes what it costs off `operations`; nothing where that is
  /// too little.
  std::optional<std::vector<double>> carried(const StraightFlight&, double& operations) const;

 private:
  const LevelWay& way_;
  const RandomKey& key_;
};

}  // namespace rabiline
