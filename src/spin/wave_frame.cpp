#include "spin/wave_frame.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
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

/// A coupling of half the field at one place [Hz]: that which a photon leads up by, and that which one leads
/// down by.
struct Coupling {
  int upper = 0, lower = 0;
  double up = 0, down = 0;
  double apart = 0;  // E_upper - E_lower
};

/// Levels at a place, [Hz].
struct LevelsThere {
  Eigen::VectorXd energy{};
  std::array<Eigen::MatrixXd, 3> up{};  // (i, j): i takes up a photon from j, with m - 1, m and m + 1
  double turning = 0, fastest = 0;      // [rad/s], [Hz]
  std::vector<Coupling> couplings{};
  std::vector<double> dressed{};  // [level] by how much resonant drives shift it at the most, to either side
};

LevelsThere levels_there(const CoupledSpins& spins, const WavePlace& place) {
  const Levels levels = levels_at(spins, place.field);
  const auto moment = dipole_matrices(spins, levels);
  const Eigen::Index count = spins.levels();
  LevelsThere out;
  out.turning = place.turning;
  out.fastest = place.fastest;
  out.energy = Eigen::Map<const Eigen::VectorXd>(levels.energy.data(), count) / constants::planck;
  out.up.fill(Eigen::MatrixXd::Zero(count, count));
  const double size[3] = {place.lowering, place.along, place.raising};
  const auto change = [&](int i, int j) -> Eigen::Index {
    return (levels.labels[static_cast<std::size_t>(i)].twice_m -
            levels.labels[static_cast<std::size_t>(j)].twice_m) /
           2;
  };
  for (int i = 0; i < count; ++i)
    for (int j = 0; j < count; ++j)
      if (const Eigen::Index by = change(i, j); std::abs(by) <= 1)
        // <m + 1|mu_x|m> is half of <m + 1|mu_+|m>.
        out.up[static_cast<std::size_t>(by + 1)](i, j) =
            (by == 0 ? moment[2] : moment[0])(i, j).real() / constants::planck / 2 * size[by + 1];
  for (int i = 0; i < count; ++i)
    for (int j = i + 1; j < count; ++j) {
      if (std::abs(change(i, j)) > 1) continue;
      const bool first_is_upper = out.energy(i) >= out.energy(j);
      const int upper = first_is_upper ? i : j, lower = first_is_upper ? j : i;
      const auto takes_up = [&](int to, int from) {
        return std::abs(out.up[static_cast<std::size_t>(change(to, from) + 1)](to, from));
      };
      out.couplings.push_back({upper, lower, takes_up(upper, lower), takes_up(lower, upper),
                               out.energy(upper) - out.energy(lower)});
    }
  return out;
}

/// From here on a coupling, over its detuning, splits its levels (S. Autler and C. Townes, Phys. Rev. 100,
/// 703 (1955)), and what is off their bare line by as much is on that of the dressed ones.
constexpr double least_splitting = 0.25;
/// |V|/|detuning|, as near as a shift of the levels by so much brings it to resonance: where that is on it,
/// no farther off than `nearest`.
double dressed_mixing(double coupling, double detuning, double shift, double nearest) {
  return mixing(coupling, shift == 0 ? detuning : std::max(std::abs(detuning) - shift, nearest));
}

/// Levels that a photon taken up and one given off couple, as strong as they are against what they are apart.
std::vector<TwoPhotons> raman_pairs(const LevelsThere& there, double frequency, const WaveFrame& frame) {
  const Eigen::MatrixXd up = there.up[0] + there.up[1] + there.up[2];
  std::vector<TwoPhotons> out;
  for (int i = 0; i < up.rows(); ++i)
    for (int j = i + 1; j < up.rows(); ++j) {
      if (!frame.stand_still(i, j, 0)) continue;
      double bound = 0;
      for (int l = 0; l < up.rows(); ++l) {
        const double apart = there.energy(j) - there.energy(l);
        if (!frame.stand_still(i, l, 1)) bound += mixing(up(i, l) * up(j, l), apart - frequency);
        if (!frame.stand_still(l, i, 1)) bound += mixing(up(l, i) * up(l, j), apart + frequency);
      }
      if (mixing(bound, there.energy(i) - there.energy(j)) > least_of_two_photons) out.push_back({i, j, 0});
    }
  return out;
}

/// The largest amplitude by which photons of two frequencies together take a level to another, both taken up
/// or one of them given off, by ways of which the frame does not keep both steps; on resonance, that of the
/// time [s] for which they drive.
double strength_of_both(const LevelsThere& one, double first, const LevelsThere& other, double second,
                        const WaveFrame& frame, double time) {
  const Eigen::MatrixXd up = one.up[0] + one.up[1] + one.up[2],
                        more = other.up[0] + other.up[1] + other.up[2];
  const double nearest = std::max(up.cwiseAbs().maxCoeff(), more.cwiseAbs().maxCoeff());
  const Eigen::Index levels = up.rows();
  double largest = 0;
  for (const bool both_up : {true, false}) {
    const Eigen::MatrixXd last = both_up ? more : more.transpose();
    const double by = both_up ? second : -second;
    const int ahead = both_up ? 1 : -1;
    const auto inverse = [&](double apart) { return apart / (apart * apart + nearest * nearest); };
    for (int i = 0; i < levels; ++i)
      for (int j = 0; j < levels; ++j) {
        if (i == j) continue;
        double coupling = 0;
        for (int l = 0; l < levels; ++l) {
          if (!frame.stand_still(l, j, 1) || !frame.stand_still(i, l, ahead))
            coupling += last(i, l) * up(l, j) * inverse(one.energy(j) + first - one.energy(l));
          if (!frame.stand_still(l, j, ahead) || !frame.stand_still(i, l, 1))
            coupling += up(i, l) * last(l, j) * inverse(one.energy(j) + by - one.energy(l));
        }
        const double off = std::abs(one.energy(i) - one.energy(j) - first - by);
        largest = std::max(largest, mixing(coupling, std::max(off, 1 / (constants::two_pi * time))));
      }
  }
  return largest;
}

}  // namespace

WaveFrame wave_frame(const CoupledSpins& spins, const std::vector<int>& manifold_of,
                     std::span<const WaveAlong> waves, double time) {
  const auto count = static_cast<std::size_t>(spins.levels());
  const double frequency = waves.front().frequency;
  std::vector<FrameEdge> edges;
  struct Passed {
    double frequency;
    LevelsThere there;
    std::vector<CoupledPair> by_two;
  };
  std::vector<Passed> along;
  for (const WaveAlong& wave : waves)
    for (const WavePlace& place : wave.places)
      along.push_back({wave.frequency, levels_there(spins, place), {}});
  const std::size_t places = waves.front().places.size();  // of each wave
  for (std::size_t place = 0; place < places; ++place) {
    std::vector<double> dressed(count);
    for (std::size_t one = place; one < along.size(); one += places)
      for (const Coupling& c : along[one].there.couplings)
        if (const double off = c.apart - along[one].frequency; mixing(c.up, off) > least_splitting)
          for (const int k : {c.upper, c.lower})
            dressed[static_cast<std::size_t>(k)] += (portable::hypot(off, 2 * c.up) - std::abs(off)) / 2;
    for (std::size_t one = place; one < along.size(); one += places) along[one].there.dressed = dressed;
  }
  const auto shift_of = [](const LevelsThere& there, const Coupling& c) {
    return there.dressed[static_cast<std::size_t>(c.upper)] +
           there.dressed[static_cast<std::size_t>(c.lower)];
  };
  for (auto& [own, there, by_two] : along) {
    for (const Coupling& c : there.couplings) {
      const double bare = mixing(c.up, c.apart - own),
                   strength = bare > least_splitting
                                  ? bare
                                  : dressed_mixing(c.up, c.apart - own, shift_of(there, c), c.up);
      if (strength > least_strength) edges.push_back({c.upper, c.lower, 1, strength});
    }
    by_two = pairs_of_two_photons(there.energy, there.up, own);
    if (own != frequency) continue;  // its photons are no others'
    for (const CoupledPair& pair : by_two)
      if (const double strength = pair.strength(2 * own); strength > least_of_two_photons)
        edges.push_back({pair.upper, pair.lower, 2, strength});
  }
  const auto of_one_manifold = [&](const Coupling& c) {
    return manifold_of[static_cast<std::size_t>(c.upper)] == manifold_of[static_cast<std::size_t>(c.lower)];
  };
  // Of two levels, say of one F and of two, those that are mixed more come first.
  const auto mixed_by = [&](const Coupling& c, const LevelsThere& there) {
    return of_one_manifold(c) ? there.turning / (there.turning + constants::two_pi * std::abs(c.apart)) : 0.0;
  };
  double most = 0;
  for (const Passed& one : along)
    for (const Coupling& c : one.there.couplings) most = std::max(most, mixed_by(c, one.there));
  for (const Passed& one : along)
    for (const Coupling& c : one.there.couplings)
      if (const double share = mixed_by(c, one.there); share > least_motion)
        edges.push_back({c.upper, c.lower, 0, strength_of_motion * std::sqrt(share / most)});
  RotatingFrame joined;
  joined.photons.resize(count);
  joined.set.resize(count);
  join_levels(std::move(edges), joined);

  WaveFrame frame{joined.photons, joined.set, std::vector<double>(count), {}, 0};
  std::vector<double> sum(count);
  std::vector<int> terms(count);
  for (const Passed& one : along)
    for (std::size_t k = 0; k < count; ++k) {
      const auto set = static_cast<std::size_t>(frame.set[k]);
      sum[set] += one.there.energy(static_cast<Eigen::Index>(k)) - frame.photons[k] * frequency;
      ++terms[set];
    }
  for (std::size_t k = 0; k < count; ++k) {
    const auto set = static_cast<std::size_t>(frame.set[k]);
    frame.rate[k] = constants::two_pi * (frame.photons[k] * frequency + sum[set] / terms[set]);
  }
  const auto neglect = [&](double strength) { frame.neglected = std::max(frame.neglected, strength); };
  const auto keep = [&](const TwoPhotons& pair) {
    if (std::ranges::find(frame.two, pair) == frame.two.end()) frame.two.push_back(pair);
  };
  for (const auto& [own, there, by_two] : along) {
    for (const Coupling& c : there.couplings) {
      const double shift = shift_of(there, c), nearest = 1 / (constants::two_pi * time);
      if (!frame.stand_still(c.upper, c.lower, 1))
        neglect(dressed_mixing(c.up, c.apart - own, shift, nearest));
      if (!frame.stand_still(c.upper, c.lower, -1))
        neglect(dressed_mixing(c.down, c.apart + own, shift, nearest));
      if (there.fastest > 0 && of_one_manifold(c) && !frame.stand_still(c.upper, c.lower, 0))
        neglect(mixing(there.turning / constants::two_pi, c.apart - there.fastest));
    }
    for (const CoupledPair& pair : by_two)
      if (const double strength = pair.strength(2 * own); !frame.stand_still(pair.upper, pair.lower, 2))
        neglect(strength);
      else if (own == frequency && strength > least_of_two_photons)
        keep({pair.upper, pair.lower, 2});
    if (own == frequency)
      for (const TwoPhotons& pair : raman_pairs(there, own, frame)) keep(pair);
  }
  for (std::size_t one = 0; one < along.size(); ++one)
    for (std::size_t other = one + places; other < along.size(); other += places)
      neglect(strength_of_both(along[one].there, along[one].frequency, along[other].there,
                               along[other].frequency, frame, time));
  return frame;
}

}  // namespace rabiline
