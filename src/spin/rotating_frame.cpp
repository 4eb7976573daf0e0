#include "spin/rotating_frame.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <limits>
#include <numeric>

#include "core/constants.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

std::vector<CoupledPair> coupled_pairs(const DrivenStates& states) {
  std::vector<CoupledPair> pairs;
  for (int i = 0; i < states.energy.size(); ++i)
    for (int j = i + 1; j < states.energy.size(); ++j) {
      if (states.coupling(i, j) == 0) continue;
      const double apart = states.energy(i) - states.energy(j);
      pairs.push_back({apart >= 0 ? i : j, apart >= 0 ? j : i, states.coupling(i, j) / 2, std::abs(apart)});
    }
  return pairs;
}
/// Of an oscillating field: each half of it takes photons up as it gives them off.
std::vector<CoupledPair> two_photon_pairs(const DrivenStates& states, double frequency) {
  const Eigen::MatrixXd half = states.coupling / 2;
  return pairs_of_two_photons(states.energy, std::span(&half, 1), frequency);
}

/// A level and so many photons that the field has more: a state of both.
struct Dressed {
  int level = 0, photons = 0;
  bool operator==(const Dressed&) const = default;
};

/// The set's own states, and all that half an oscillating field takes them to.
std::vector<Dressed> states_of(const RotatingFrame& frame, int set) {
  std::vector<Dressed> own;
  for (std::size_t i = 0; i < frame.set.size(); ++i)
    if (frame.set[i] == set) own.push_back({static_cast<int>(i), -frame.photons[i]});
  return own;
}
std::vector<Dressed> neighbours_of(const std::vector<Dressed>& own, const Eigen::MatrixXd& coupling) {
  std::vector<Dressed> outside;
  for (const Dressed& state : own)
    for (int k = 0; k < coupling.cols(); ++k)
      for (const int change : {-1, 1}) {
        const Dressed next{k, state.photons + change};
        if (coupling(state.level, k) != 0 && std::ranges::find(own, next) == own.end() &&
            std::ranges::find(outside, next) == outside.end())
          outside.push_back(next);
      }
  return outside;
}

Eigen::MatrixXd between(const std::vector<Dressed>& rows, const std::vector<Dressed>& columns,
                        const Eigen::MatrixXd& coupling) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(std::ssize(rows), std::ssize(columns));
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index j = 0; j < out.cols(); ++j)
      if (std::abs(rows[i].photons - columns[j].photons) == 1)
        out(i, j) = coupling(rows[i].level, columns[j].level) / 2;
  return out;
}

}  // namespace

double mixing(double coupling, double detuning) {
  if (coupling == 0) return 0;
  return detuning != 0 ? std::abs(coupling / detuning) : std::numeric_limits<double>::infinity();
}

std::vector<CoupledPair> pairs_of_two_photons(const Eigen::VectorXd& energy,
                                              std::span<const Eigen::MatrixXd> up, double frequency) {
  const Eigen::Index levels = energy.size();
  double nearest = 0;
  for (const Eigen::MatrixXd& part : up) nearest = std::max(nearest, part.cwiseAbs().maxCoeff());
  // No coupling is larger than half of levels x nearest, and no shift than levels x nearest.
  const double near = (1 / least_of_two_photons + 2) * static_cast<double>(levels) * nearest;
  const auto is_near = [&](int upper, int lower) {
    return upper != lower && energy(upper) >= energy(lower) &&
           std::abs(energy(upper) - energy(lower) - 2 * frequency) < near;
  };
  bool some_are = false;
  for (int upper = 0; upper < levels; ++upper)
    for (int lower = 0; lower < levels; ++lower) some_are = some_are || is_near(upper, lower);
  if (!some_are) return {};
  // By way of l: (i, l) from i one photon down, and one up, where what is nearer than the coupling is
  // bounded.
  Eigen::MatrixXd down(levels, levels), further(levels, levels);
  for (Eigen::Index i = 0; i < levels; ++i)
    for (Eigen::Index l = 0; l < levels; ++l) {
      const auto inverse = [&](double apart) { return apart / (apart * apart + nearest * nearest); };
      down(i, l) = inverse(energy(i) - energy(l) - frequency);
      further(i, l) = inverse(energy(i) - energy(l) + frequency);
    }
  Eigen::VectorXd shift = Eigen::VectorXd::Zero(levels);
  for (const Eigen::MatrixXd& part : up)
    shift += (part.cwiseAbs2().cwiseProduct(down) + part.transpose().cwiseAbs2().cwiseProduct(further))
                 .rowwise()
                 .sum();
  Eigen::MatrixXd coupling = Eigen::MatrixXd::Zero(levels, levels), terms = coupling;
  for (std::size_t one = 0; one < up.size(); ++one)
    for (std::size_t other = one; other < up.size(); ++other) {
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(levels, levels);
      const auto add = [&](const Eigen::MatrixXd& first, const Eigen::MatrixXd& last) {
        sum += (last.cwiseProduct(down) * first + last * first.cwiseProduct(further.transpose())) / 2;
        terms += (last.cwiseProduct(down).cwiseAbs() * first.cwiseAbs() +
                  last.cwiseAbs() * first.cwiseProduct(further.transpose()).cwiseAbs()) /
                 2;
      };
      add(up[one], up[other]);
      if (one != other) add(up[other], up[one]);
      coupling += sum.cwiseAbs();
    }
  std::vector<CoupledPair> pairs;
  for (int upper = 0; upper < levels; ++upper)
    for (int lower = 0; lower < levels; ++lower) {
      const bool vanishes = coupling(upper, lower) <= 1e-12 * terms(upper, lower);  // by symmetry
      if (!is_near(upper, lower) || vanishes) continue;
      const double bare = energy(upper) - energy(lower) - 2 * frequency;
      const double full = bare + shift(upper) - shift(lower);
      const double off = bare * full <= 0 ? 0 : std::min(std::abs(bare), std::abs(full));
      pairs.push_back({upper, lower, coupling(upper, lower), 2 * frequency + off});
    }
  return pairs;
}

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

void join_levels(std::vector<FrameEdge> edges, RotatingFrame& frame) {
  std::iota(frame.set.begin(), frame.set.end(), 0);
  std::ranges::stable_sort(edges, std::greater(), &FrameEdge::strength);
  for (const FrameEdge& edge : edges) {
    const int joined = frame.set[edge.lower], other = frame.set[edge.upper];
    if (joined == other) continue;
    const int by = edge.ahead - (frame.photons[edge.upper] - frame.photons[edge.lower]);
    const bool drops_another = std::ranges::any_of(edges, [&](const FrameEdge& e) {
      const bool along = frame.set[e.lower] == joined && frame.set[e.upper] == other;
      const bool against = frame.set[e.lower] == other && frame.set[e.upper] == joined;
      const int shift = along ? by : -by;
      return (along || against) && frame.photons[e.upper] - frame.photons[e.lower] + shift != e.ahead &&
             2 * e.strength > edge.strength;
    });
    if (drops_another) continue;
    for (std::size_t i = 0; i < frame.set.size(); ++i)
      if (frame.set[i] == other) {
        frame.set[i] = joined;
        frame.photons[i] += by;
      }
  }
}

RotatingFrame rotating_frame(std::span<const LevelLabel> labels, const RotatingTerm& drive,
                             std::span<const DrivenStates* const> zones) {
  RotatingFrame frame{drive.oscillator.part, sense_of(drive), drive.oscillator.frequency,
                      std::vector<int>(labels.size()), std::vector<int>(labels.size())};
  if (frame.sense != 0) {
    for (std::size_t i = 0; i < labels.size(); ++i)
      frame.photons[i] = frame.sense * (labels[i].twice_m - labels[0].twice_m) / 2;
    return frame;
  }
  std::vector<FrameEdge> edges;
  for (const DrivenStates* zone : zones) {
    for (const CoupledPair& pair : coupled_pairs(*zone))
      edges.push_back({pair.upper, pair.lower, 1, pair.strength(frame.frequency)});
    for (const CoupledPair& pair : two_photon_pairs(*zone, frame.frequency))
      if (const double strength = pair.strength(2 * frame.frequency); strength > least_of_two_photons)
        edges.push_back({pair.upper, pair.lower, 2, strength});
  }
  join_levels(std::move(edges), frame);
  return frame;
}

StandingCoupling standing_coupling(const RotatingFrame& frame, const DrivenStates& states) {
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(states.coupling.rows(), states.coupling.cols());
  if (frame.sense != 0) return {states.coupling, zero, zero};
  StandingCoupling out{zero, zero, zero};
  // 1/d, but for what is nearer than the coupling: there a shift is bounded by it.
  const double nearest = states.coupling.cwiseAbs().maxCoeff() / 2;
  const auto energy = [&](const Dressed& s) { return states.energy(s.level) + s.photons * frame.frequency; };
  for (int set = 0; set < std::ssize(frame.set); ++set) {
    const std::vector<Dressed> own = states_of(frame, set), outside = neighbours_of(own, states.coupling);
    if (outside.empty()) continue;
    std::vector<int> levels;
    levels.reserve(own.size());
    for (const Dressed& state : own) levels.push_back(state.level);
    Eigen::ArrayXXd inverse(std::ssize(own), std::ssize(outside));
    for (Eigen::Index i = 0; i < inverse.rows(); ++i)
      for (Eigen::Index k = 0; k < inverse.cols(); ++k) {
        const double apart = energy(own[i]) - energy(outside[k]);
        inverse(i, k) = apart / (apart * apart + nearest * nearest);
      }
    const Eigen::MatrixXd kept = between(own, own, states.coupling);
    const Eigen::MatrixXd there = between(own, outside, states.coupling);
    const Eigen::MatrixXd first = (there.array() * inverse).matrix();
    const Eigen::MatrixXd among = first * between(outside, outside, states.coupling) - kept * first;
    const auto there_and_back = [&](const Eigen::MatrixXd& amplitude) -> Eigen::MatrixXd {
      const Eigen::MatrixXd half = amplitude * there.transpose() / 2;
      return half + half.transpose();
    };
    out.first(levels, levels) = kept;
    out.second(levels, levels) = there_and_back(first);
    out.third(levels, levels) = there_and_back((among.array() * inverse).matrix());
  }
  return out;
}

double neglected_amplitude(const RotatingFrame& frame, const DrivenStates& states) {
  if (frame.sense != 0) return 0;
  double largest = 0;
  for (const CoupledPair& pair : coupled_pairs(states)) {
    const bool kept = frame.set[pair.upper] == frame.set[pair.lower] &&
                      frame.photons[pair.upper] - frame.photons[pair.lower] == 1;
    largest = std::max(
        largest, kept ? mixing(pair.coupling, pair.apart + frame.frequency) : pair.strength(frame.frequency));
    if (!kept) continue;
    const double modulation =
        states.coupling(pair.upper, pair.upper) - states.coupling(pair.lower, pair.lower);
    largest = std::max(largest, mixing(modulation / 2, frame.frequency));
  }
  for (const CoupledPair& pair : two_photon_pairs(states, frame.frequency))
    if (frame.set[pair.upper] != frame.set[pair.lower] ||
        frame.photons[pair.upper] - frame.photons[pair.lower] != 2)
      largest = std::max(largest, pair.strength(2 * frame.frequency));
  return largest;
}

}  // namespace rabiline
