#pragma once
// Levels of two coupled spins in a static field and one that has a period, by Floquet (1883).
#include <array>
#include <complex>
#include <vector>

#include "spin/level_table.hpp"

namespace rabiline {

/// B = field along the third axis + Re(c exp(i angle)), in tesla, whose angle grows by omega.
struct PeriodicField {
  double field = 0;
  double omega = 0;  // [rad/s] of either sign, not 0
  std::array<std::complex<double>, 3> c{};
};

/// The states that come back after each period but for a phase: mode k is
///   psi_k = exp(-i quasi_k t) sum_n sum_l c_nlk exp(i (n - photons_l) angle) |l>
/// in levels l along the static field, and all that matters of n is a few. They are an orthonormal basis at
/// each angle, so that exp(-i quasi_k t) carries amplitudes over any time at no more cost than over a short
/// one.
class LevelPeriod {
 public:
  struct Term {
    int level = 0, mode = 0;
    double re = 0, im = 0;  // c_nlk
  };
  /// Of a manifold that has pairs; no terms where they could not be found: time_for_period() says so before.
  LevelPeriod(const LevelManifold&, const PeriodicField&);

  int first() const { return first_; }
  /// [n - first] Where its terms end.
  const std::vector<int>& ends() const { return ends_; }
  const std::vector<Term>& terms() const { return terms_; }
  const std::vector<double>& photons() const { return photons_; }  // [level] whole numbers
  /// [level] [rad/s] By which amplitudes of the manifold turn more than those of the modes' levels, at a
  /// fixed angle: the manifold leaves out its energies at B = 0.
  const std::vector<double>& rate() const { return rate_; }
  const std::vector<double>& quasi() const { return quasi_; }  // [mode] [rad/s]

 private:
  int first_ = 0;
  std::vector<int> ends_;
  std::vector<Term> terms_;
  std::vector<double> photons_, rate_, quasi_;
};

/// About how long the modes take to be worked out [s]; infinity where fields are too strong for the frequency
/// [rad/s] or levels too far apart. `field` [T] is the static one, `driving` the sum of all others.
double time_for_period(const CoupledSpins&, double field, double driving, double omega);

}  // namespace rabiline
