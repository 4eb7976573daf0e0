#include "spin/rotating_frame.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

struct Pair {
  int upper = 0, lower = 0;
  double detuning = 0;  // [Hz] | |E_i - E_j|/h - f |
};

/// Levels that a field couples, the higher one first.
std::vector<Pair> coupled_pairs(const DrivenStates& states, double frequency) {
  std::vector<Pair> pairs;
  for (int i = 0; i < states.energy.size(); ++i)
    for (int j = i + 1; j < states.energy.size(); ++j) {
      if (states.coupling(i, j) == 0) continue;
      const double apart = states.energy(i) - states.energy(j);
      pairs.push_back({apart >= 0 ? i : j, apart >= 0 ? j : i, std::abs(std::abs(apart) - frequency)});
    }
  return pairs;
}

bool keeps(const RotatingFrame& frame, const Pair& pair) {
  return frame.photons[pair.upper] - frame.photons[pair.lower] == 1;
}

double ratio(double coupling, double detuning) {
  if (coupling == 0) return 0;
  return detuning > 0 ? std::abs(coupling) / detuning : std::numeric_limits<double>::infinity();
}

}  // namespace

DrivenStates driven_states(const CoupledSpins& spins, const Levels& levels, const RotatingTerm& drive) {
  const auto mu = dipole_matrices(spins, levels);
  const bool swings = sense_of(drive) == 0;
  const double across = swings ? portable::hypot(drive.first.x, drive.first.y) : 1;
  const double along = swings ? drive.first.z : 0;
  DrivenStates states;
  states.energy = Eigen::Map<const Eigen::VectorXd>(levels.energy.data(), spins.levels()) / constants::planck;
  states.coupling =
      -drive.amplitude / constants::planck * (across * mu[0].real() + along * mu[2].real()).eval();
  states.axis = swings && across > 0 ? portable::atan2(drive.first.y, drive.first.x) : 0;
  // What vanishes by symmetry is zero, not its rounding: levels that do not couple stay apart.
  const double least =
      1e-12 * std::abs(drive.amplitude) *
      std::max(std::abs(spins.zeeman_i) * spins.twice_i, std::abs(spins.zeeman_j) * spins.twice_j);
  states.coupling = (states.coupling.array().abs() > least).select(states.coupling, 0.0);
  return states;
}

RotatingFrame rotating_frame(std::span<const LevelLabel> labels, const RotatingTerm& drive,
                             std::span<const DrivenStates* const> zones) {
  RotatingFrame frame{drive.oscillator.part, sense_of(drive), drive.oscillator.frequency,
                      std::vector<int>(labels.size())};
  if (frame.sense != 0) {
    for (std::size_t i = 0; i < labels.size(); ++i)
      frame.photons[i] = frame.sense * (labels[i].twice_m - labels[0].twice_m) / 2;
    return frame;
  }
  std::vector<Pair> pairs;
  for (const DrivenStates* zone : zones)
    std::ranges::copy(coupled_pairs(*zone, frame.frequency), std::back_inserter(pairs));
  std::ranges::stable_sort(pairs, {}, &Pair::detuning);
  std::vector<int> tree(labels.size());
  for (std::size_t i = 0; i < tree.size(); ++i) tree[i] = static_cast<int>(i);
  for (const Pair& pair : pairs) {
    const int joined = tree[pair.lower], other = tree[pair.upper];
    if (joined == other) continue;
    const int shift = frame.photons[pair.lower] + 1 - frame.photons[pair.upper];
    for (std::size_t i = 0; i < tree.size(); ++i)
      if (tree[i] == other) {
        tree[i] = joined;
        frame.photons[i] += shift;
      }
  }
  return frame;
}

Eigen::MatrixXd kept_coupling(const RotatingFrame& frame, const DrivenStates& states) {
  if (frame.sense != 0) return states.coupling;
  Eigen::MatrixXd kept = Eigen::MatrixXd::Zero(states.coupling.rows(), states.coupling.cols());
  for (const Pair& pair : coupled_pairs(states, frame.frequency))
    if (keeps(frame, pair))
      kept(pair.upper, pair.lower) = kept(pair.lower, pair.upper) =
          states.coupling(pair.upper, pair.lower) / 2;
  return kept;
}

double neglected_amplitude(const RotatingFrame& frame, const DrivenStates& states) {
  if (frame.sense != 0) return 0;
  double largest = 0;
  for (const Pair& pair : coupled_pairs(states, frame.frequency)) {
    const double apart = std::abs(states.energy(pair.upper) - states.energy(pair.lower));
    const double half = states.coupling(pair.upper, pair.lower) / 2;
    largest = std::max(largest, ratio(half, keeps(frame, pair) ? apart + frame.frequency : pair.detuning));
    if (!keeps(frame, pair)) continue;
    const double modulation =
        states.coupling(pair.upper, pair.upper) - states.coupling(pair.lower, pair.lower);
    largest = std::max(largest, ratio(modulation / 2, frame.frequency));
  }
  return largest;
}

double counter_rotating_shift(const DrivenStates& states, double frequency, int upper, int lower) {
  const auto shift_of = [&](int level) {
    double shift = 0;
    for (int other = 0; other < states.energy.size(); ++other) {
      const double apart = states.energy(level) - states.energy(other),
                   half = states.coupling(level, other) / 2;
      if (other == level || half == 0) continue;
      shift += (apart < 0 ? -1 : 1) * half * half / (std::abs(apart) + frequency);
    }
    return shift;
  };
  return shift_of(upper) - shift_of(lower);
}

}  // namespace rabiline
