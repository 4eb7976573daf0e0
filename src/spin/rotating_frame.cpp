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
      const double apart = states.energy(i) - states.energy(j);
      const int upper = apart >= 0 ? i : j, lower = apart >= 0 ? j : i;
      if (states.up(upper, lower) != 0)
        pairs.push_back({upper, lower, states.up(upper, lower), std::abs(apart)});
    }
  return pairs;
}
std::vector<CoupledPair> two_photon_pairs(const DrivenStates& states, double frequency) {
  return pairs_of_two_photons(states.energy, std::span(&states.up, 1), frequency);
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
std::vector<Dressed> neighbours_of(const std::vector<Dressed>& own, const Eigen::MatrixXd& up) {
  std::vector<Dressed> outside;
  for (const Dressed& state : own)
    for (int k = 0; k < up.cols(); ++k)
      for (const int change : {-1, 1}) {
        const Dressed next{k, state.photons + change};
        if ((change < 0 ? up(k, state.level) : up(state.level, k)) != 0 &&
            std::ranges::find(own, next) == own.end() && std::ranges::find(outside, next) == outside.end())
          outside.push_back(next);
      }
  return outside;
}

Eigen::MatrixXd between(const std::vector<Dressed>& rows, const std::vector<Dressed>& columns,
                        const Eigen::MatrixXd& up) {
  Eigen::MatrixXd out = Eigen::MatrixXd::Zero(std::ssize(rows), std::ssize(columns));
  for (Eigen::Index i = 0; i < out.rows(); ++i)
    for (Eigen::Index j = 0; j < out.cols(); ++j) {
      const int more = rows[i].photons - columns[j].photons, row = rows[i].level, column = columns[j].level;
      if (std::abs(more) == 1) out(i, j) = more < 0 ? up(row, column) : up(column, row);
    }
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

DrivenStates driven_states(const CoupledSpins& spins, const Levels& levels, const DriveParts& parts) {
  const auto mu = dipole_matrices(spins, levels);
  DrivenStates states;
  states.energy = Eigen::Map<const Eigen::VectorXd>(levels.energy.data(), spins.levels()) / constants::planck;
  states.up = Eigen::MatrixXd::Zero(spins.levels(), spins.levels());
  // What vanishes by symmetry is zero, not its rounding: levels that do not couple stay apart.
  const double least =
      1e-12 * parts.size() / 2 *
      std::max(std::abs(spins.zeeman_i) * spins.twice_i, std::abs(spins.zeeman_j) * spins.twice_j);
  for (int i = 0; i < spins.levels(); ++i)
    for (int j = 0; j < spins.levels(); ++j) {
      const int by = (levels.labels[static_cast<std::size_t>(i)].twice_m -
                      levels.labels[static_cast<std::size_t>(j)].twice_m) /
                     2;
      const double size = by == 1 ? parts.right : by == -1 ? parts.left : by == 0 ? parts.along / 2 : 0;
      const double coupling = -size / constants::planck * mu[by == 0 ? 2 : 0](i, j).real();
      if (std::abs(coupling) > least) states.up(i, j) = coupling;
    }
  return states;
}

DrivenStates driven_states(const CoupledSpins& spins, const Levels& levels, const RotatingTerm& drive) {
  DrivenStates states = driven_states(spins, levels, parts_of(drive));
  if (sense_of(drive) == 0 && (drive.first.x != 0 || drive.first.y != 0))
    states.axis = portable::atan2(drive.first.y, drive.first.x);
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

RotatingFrame rotating_frame(std::span<const LevelLabel> labels, int sense, double frequency,
                             std::span<const DrivenStates* const> zones) {
  RotatingFrame frame{sense, frequency, std::vector<int>(labels.size()), std::vector<int>(labels.size())};
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
  const Eigen::MatrixXd zero = Eigen::MatrixXd::Zero(states.up.rows(), states.up.cols());
  if (frame.sense != 0) return {states.up + states.up.transpose(), zero, zero};
  StandingCoupling out{zero, zero, zero};
  // 1/d, but for what is nearer than the coupling: there a shift is bounded by it.
  const double nearest = states.up.cwiseAbs().maxCoeff();
  const auto energy = [&](const Dressed& s) { return states.energy(s.level) + s.photons * frame.frequency; };
  for (int set = 0; set < std::ssize(frame.set); ++set) {
    const std::vector<Dressed> own = states_of(frame, set), outside = neighbours_of(own, states.up);
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
    const Eigen::MatrixXd kept = between(own, own, states.up);
    const Eigen::MatrixXd there = between(own, outside, states.up);
    const Eigen::MatrixXd first = (there.array() * inverse).matrix();
    const Eigen::MatrixXd among = first * between(outside, outside, states.up) - kept * first;
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
    largest = std::max(largest, kept ? mixing(states.up(pair.lower, pair.upper), pair.apart + frame.frequency)
                                     : pair.strength(frame.frequency));
    if (!kept) continue;
    const double modulation = states.up(pair.upper, pair.upper) - states.up(pair.lower, pair.lower);
    largest = std::max(largest, mixing(modulation, frame.frequency));
  }
  for (const CoupledPair& pair : two_photon_pairs(states, frame.frequency))
    if (frame.set[pair.upper] != frame.set[pair.lower] ||
        frame.photons[pair.upper] - frame.photons[pair.lower] != 2)
      largest = std::max(largest, pair.strength(2 * frame.frequency));
  return largest;
}

}  // namespace rabiline
