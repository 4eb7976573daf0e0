#include "spin/wave_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.hpp"
#include "spin/levels.hpp"
#include "spin/rotating_frame.hpp"

namespace rabiline {
namespace {

/// What turns with the static field must not be dropped for a drive farther from resonance than this; below
/// the other share of a gap it mixes nothing, and shifts at most.
constexpr double strength_of_motion = 0.01, least_motion = 1e-4;
/// A drive that makes smaller amplitudes shifts levels alone: what it couples need not turn together, at the
/// rate of its detuning.
constexpr double least_strength = 1e-4;

/// One coupling at one place: `upper` takes up a photon, [Hz].
struct Coupling {
  int upper = 0, lower = 0;
  double up = 0,
         down = 0;   // of half the field, that which a photon leads up by, and that which one leads down by
  double apart = 0;  // E_upper - E_lower
};
double ratio(double coupling, double detuning) {
  if (coupling == 0) return 0;
  return detuning != 0 ? coupling / std::abs(detuning) : std::numeric_limits<double>::infinity();
}

std::vector<Coupling> couplings_at(const CoupledSpins& spins, const WavePlace& place) {
  const Levels levels = levels_at(spins, place.field);
  const auto moment = dipole_matrices(spins, levels);
  std::vector<Coupling> out;
  for (int i = 0; i < spins.levels(); ++i)
    for (int j = i + 1; j < spins.levels(); ++j) {
      const auto energy = [&](int k) {
        return levels.energy[static_cast<std::size_t>(k)] / constants::planck;
      };
      const bool first_is_upper = energy(i) >= energy(j);
      Coupling c{first_is_upper ? i : j, first_is_upper ? j : i};
      c.apart = energy(c.upper) - energy(c.lower);
      const int change = (levels.labels[static_cast<std::size_t>(c.upper)].twice_m -
                          levels.labels[static_cast<std::size_t>(c.lower)].twice_m) /
                         2;
      if (std::abs(change) > 1) continue;
      // <m + 1|mu_x|m> is half of <m + 1|mu_+|m>.
      const double element =
          std::abs(change == 0 ? moment[2](c.upper, c.lower) : moment[0](c.upper, c.lower)) /
          constants::planck / 2;
      c.up = element * (change == 0 ? place.along : change > 0 ? place.raising : place.lowering);
      c.down = element * (change == 0 ? place.along : change > 0 ? place.lowering : place.raising);
      out.push_back(c);
    }
  return out;
}

}  // namespace

WaveFrame wave_frame(const CoupledSpins& spins, const std::vector<int>& manifold_of, double frequency,
                     std::span<const WavePlace> places) {
  const auto count = static_cast<std::size_t>(spins.levels());
  std::vector<FrameEdge> edges;
  std::vector<std::vector<Coupling>> couplings;
  for (const WavePlace& place : places) {
    couplings.push_back(couplings_at(spins, place));
    for (const Coupling& c : couplings.back())
      if (const double strength = ratio(c.up, c.apart - frequency); strength > least_strength)
        edges.push_back({c.upper, c.lower, 1, strength});
  }
  const auto is_mixed = [&](const Coupling& c, double turning) {
    const auto upper = static_cast<std::size_t>(c.upper), lower = static_cast<std::size_t>(c.lower);
    return manifold_of[upper] == manifold_of[lower] &&
           turning > least_motion * constants::two_pi * std::abs(c.apart);
  };
  for (std::size_t i = 0; i < places.size(); ++i)
    for (const Coupling& c : couplings[i])
      if (is_mixed(c, places[i].turning)) edges.push_back({c.upper, c.lower, 0, strength_of_motion});
  RotatingFrame joined;
  joined.photons.resize(count);
  joined.set.resize(count);
  join_levels(std::move(edges), joined);

  WaveFrame frame{joined.photons, joined.set, std::vector<double>(count), 0};
  std::vector<double> sum(count);
  std::vector<int> terms(count);
  for (const WavePlace& place : places) {
    const Levels levels = levels_at(spins, place.field);
    for (std::size_t k = 0; k < count; ++k) {
      const auto set = static_cast<std::size_t>(frame.set[k]);
      sum[set] += levels.energy[k] / constants::planck - frame.photons[k] * frequency;
      ++terms[set];
    }
  }
  for (std::size_t k = 0; k < count; ++k) {
    const auto set = static_cast<std::size_t>(frame.set[k]);
    frame.rate[k] = constants::two_pi * (frame.photons[k] * frequency + sum[set] / terms[set]);
  }
  for (const std::vector<Coupling>& at : couplings)
    for (const Coupling& c : at) {
      const auto upper = static_cast<std::size_t>(c.upper), lower = static_cast<std::size_t>(c.lower);
      const bool one_set = frame.set[upper] == frame.set[lower];
      const int ahead = frame.photons[upper] - frame.photons[lower];
      if (!one_set || ahead != 1)
        frame.neglected = std::max(frame.neglected, ratio(c.up, c.apart - frequency));
      if (!one_set || ahead != -1)
        frame.neglected = std::max(frame.neglected, ratio(c.down, c.apart + frequency));
    }
  return frame;
}

}  // namespace rabiline
