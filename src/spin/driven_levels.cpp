#include "spin/driven_levels.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "core/constants.hpp"
#include "core/eigensystem.hpp"
#include "spin/evolution.hpp"
#include "spin/levels.hpp"
#include "spin/rotating_frame.hpp"

namespace rabiline {
namespace {

using constants::planck;
using constants::two_pi;

/// The levels at a field, each with the sign that the states of `from` have when the field changes slowly: a
/// real state comes back as itself.
Levels followed(const CoupledSpins& spins, const Levels& from, double field, int halvings = 30) {
  Levels to = levels_at(spins, field);
  const Eigen::VectorXd overlaps = from.states.cwiseProduct(to.states).colwise().sum();
  if (overlaps.cwiseAbs().minCoeff() < 0.75 && halvings > 0)
    return followed(spins, followed(spins, from, (from.field + field) / 2, halvings - 1), field,
                    halvings - 1);
  for (int n = 0; n < overlaps.size(); ++n)
    if (overlaps(n) < 0) to.states.col(n) *= -1;
  return to;
}

/// One zone, or the gap before the next one.
struct Stretch {
  double begin = 0, end = 0;  // [m]
  Eigen::VectorXd energy{};   // [Hz]
  std::optional<RotatingTerm> drive{};
  DrivenStates states{};                 // where driven
  const RotatingFrame* frame = nullptr;  // where driven
  StandingCoupling standing{};           // where driven

  bool is_driven() const { return frame != nullptr; }
  /// Whether it takes one of these levels to another.
  bool mixes(int i, int j) const {
    return is_driven() &&
           (standing.first(i, j) != 0 || standing.second(i, j) != 0 || standing.third(i, j) != 0);
  }
};

constexpr double rounding = 1e-9;  // [m] of where zones begin and end

void check(const LevelZone& zone, double last_end) {
  if (!(zone.end >= zone.begin) || zone.begin < last_end - rounding)
    throw std::invalid_argument("zones of driven levels do not ascend along the beam");
}

std::vector<Stretch> stretches_of(const CoupledSpins& spins, std::vector<LevelZone> zones) {
  std::vector<Stretch> stretches;
  Levels levels = levels_at(spins, zones.empty() ? 0 : zones.front().field);
  const auto add = [&](double begin, double end, double field, const std::optional<RotatingTerm>& drive) {
    if (levels.field != field) levels = followed(spins, levels, field);
    Stretch stretch;
    stretch.begin = begin;
    stretch.end = end;
    stretch.energy = Eigen::Map<const Eigen::VectorXd>(levels.energy.data(), spins.levels()) / planck;
    if (drive && drive->amplitude != 0 && end > begin) {
      stretch.drive = drive;
      Oscillator& clock = stretch.drive->oscillator;
      if (sense_of(*drive) == 0 && clock.frequency < 0) {  // cos p = cos(-p)
        clock.frequency *= -1;
        clock.phase *= -1;
      }
      if (sense_of(*drive) < 0)
        clock.phase *= -1;  // photons have exp(-i (omega t + p)), the field -omega t + p
      stretch.states = driven_states(spins, levels, *stretch.drive);
    }
    stretches.push_back(std::move(stretch));
  };
  double last = -std::numeric_limits<double>::infinity();
  for (const LevelZone& zone : zones) {
    check(zone, last);
    if (!stretches.empty() && zone.begin > last + rounding) add(last, zone.begin, 0, std::nullopt);
    add(zone.begin, zone.end, zone.field, zone.drive);
    last = zone.end;
  }
  return stretches;
}

/// The frames of the stretches, one for each clock and kind of field; couplings that stand still in them.
std::deque<RotatingFrame> add_frames(const CoupledSpins& spins, std::vector<Stretch>& stretches) {
  std::deque<RotatingFrame> frames;
  std::map<int, double> frequencies;
  const std::vector<LevelLabel> labels = level_labels(spins);
  for (Stretch& stretch : stretches) {
    if (!stretch.drive) continue;
    const RotatingTerm& drive = *stretch.drive;
    const Oscillator& clock = drive.oscillator;
    if (frequencies.try_emplace(clock.part, clock.frequency).first->second != clock.frequency)
      throw std::invalid_argument("fields of one clock have different frequencies");
    const auto is_ours = [&](int other_clock, int sense) {
      return other_clock == clock.part && sense == sense_of(drive);
    };
    auto frame = std::ranges::find_if(
        frames, [&](const RotatingFrame& other) { return is_ours(other.clock, other.sense); });
    if (frame == frames.end()) {
      std::vector<const DrivenStates*> zones;
      for (const Stretch& other : stretches)
        if (other.drive && is_ours(other.drive->oscillator.part, sense_of(*other.drive)))
          zones.push_back(&other.states);
      frames.push_back(rotating_frame(labels, sense_of(drive), clock.frequency, zones));
      frames.back().clock = clock.part;
      frame = std::prev(frames.end());
    }
    stretch.frame = &*frame;
    stretch.standing = standing_coupling(*frame, stretch.states);
  }
  return frames;
}

/// Sets of levels that are connected, directly or through others.
template <typename Connected>
std::vector<std::vector<int>> sets_of(int levels, Connected connected) {
  std::vector<std::vector<int>> sets;
  std::vector<int> waiting(static_cast<std::size_t>(levels));
  std::iota(waiting.begin(), waiting.end(), 0);
  while (!waiting.empty()) {
    std::vector<int> set{waiting.front()};
    waiting.erase(waiting.begin());
    for (std::size_t k = 0; k < set.size(); ++k)
      std::erase_if(waiting, [&, from = set[k]](int to) {
        const bool joins = connected(from, to);
        if (joins) set.push_back(to);
        return joins;
      });
    std::ranges::sort(set);
    sets.push_back(set);
  }
  return sets;
}

/// Builds the evolution of one block along the stretches.
class BlockBuilder {
 public:
  BlockBuilder(const std::vector<LevelLabel>& labels, const std::vector<int>& levels,
               std::vector<int> random_clocks)
      : labels_(labels),
        levels_(levels),
        random_clocks_(std::move(random_clocks)),
        phase_(Eigen::VectorXd::Zero(size())) {}

  Evolution evolution(const std::vector<Stretch>& stretches, double largest_slowness) {
    Evolution out(size(), static_cast<int>(random_clocks_.size()));
    for (const Stretch& stretch : stretches) {
      const bool mixes = std::ranges::any_of(levels_, [&](int i) {
        return std::ranges::any_of(levels_, [&](int j) { return i != j && stretch.mixes(i, j); });
      });
      if (mixes) enter(out, stretch);
      if (frame_ == nullptr) continue;
      if (stretch.is_driven()) standing_ = stretch.standing.among(levels_);
      if (!stretch.is_driven() || stretch.drive->envelope.shape == Shape::rectangular)
        pass(out, hamiltonian(stretch, 1), stretch.end - stretch.begin);
      else
        pass_slices(out, stretch, slices_of(stretch, largest_slowness));
    }
    return out;
  }

 private:
  int size() const { return static_cast<int>(levels_.size()); }

  /// [Hz] In the present frame at a share of the drive's amplitude, less the energy of the first level.
  Eigen::MatrixXd hamiltonian(const Stretch& stretch, double share) const {
    Eigen::MatrixXd h = Eigen::MatrixXd::Zero(size(), size());
    if (stretch.is_driven()) h = standing_.at(share);
    for (int k = 0; k < size(); ++k) {
      const int photons = frame_->photons[levels_[k]] - frame_->photons[levels_[0]];
      h(k, k) += stretch.energy(levels_[k]) - stretch.energy(levels_[0]) - photons * frame_->frequency;
    }
    return h;
  }

  /// From the present frame into that of a drive: a_i grows by the phase (n_i p + m_i chi) of the new one
  /// less that of the old one.
  void enter(Evolution& out, const Stretch& stretch) {
    Eigen::VectorXd phase(size()), rate = Eigen::VectorXd::Zero(size());
    Eigen::MatrixXi random = Eigen::MatrixXi::Zero(static_cast<Eigen::Index>(random_clocks_.size()), size());
    const RotatingFrame& next = *stretch.frame;
    for (int k = 0; k < size(); ++k) {
      const auto photons = [&](const RotatingFrame& frame) {
        return frame.photons[levels_[k]] - frame.photons[levels_[0]];
      };
      const double m = (labels_[levels_[k]].twice_m - labels_[levels_[0]].twice_m) / 2.0;
      phase(k) = (photons(next) * stretch.drive->oscillator.phase + m * stretch.states.axis) / two_pi;
      if (frame_ == nullptr || frame_ == &next) continue;
      rate(k) = (photons(*frame_) * frame_->frequency - photons(next) * next.frequency) * stretch.begin;
      for (std::size_t c = 0; c < random_clocks_.size(); ++c)
        random(static_cast<Eigen::Index>(c), k) = (next.clock == random_clocks_[c] ? photons(next) : 0) -
                                                  (frame_->clock == random_clocks_[c] ? photons(*frame_) : 0);
    }
    if (phase != phase_ || rate.any()) out.turn(phase_ - phase, rate);
    if (frame_ != nullptr && frame_ != &next) out.turn_at_random(random);
    phase_ = phase;
    frame_ = &next;
  }

  void pass(Evolution& out, const Eigen::MatrixXd& h, double length) const {
    const Eigen::VectorXd no_angle = Eigen::VectorXd::Zero(size());
    if (h.isDiagonal(0)) return out.turn(no_angle, h.diagonal() * length);
    const auto own = eigensystem_of(h);
    out.mix(own.vectors.transpose());
    out.turn(no_angle, own.values * length);
    out.mix(own.vectors);
  }

  /// Each step's two exponentials are of the mean Hamiltonian of half a step: with H_1, H_2 at Gauss's
  /// points, (1/2 +- 1/sqrt 3) of them each.
  void pass_slices(Evolution& out, const Stretch& stretch, int steps) const {
    const double step = (stretch.end - stretch.begin) / steps, gauss = std::sqrt(3.0) / 6;
    const double near = 0.5 + 2 * gauss, far = 0.5 - 2 * gauss;
    for (int k = 0; k < steps; ++k) {
      const double middle = stretch.begin + (k + 0.5) * step;
      const auto at = [&](double y) { return hamiltonian(stretch, share_of(stretch.drive->envelope, y)); };
      const Eigen::MatrixXd first = at(middle - gauss * step), second = at(middle + gauss * step);
      pass(out, near * first + far * second, step / 2);
      pass(out, far * first + near * second, step / 2);
    }
  }

  /// Steps are doubled until the error falls with their fourth power, then as many as it takes are known;
  /// of these the next number of three binary digits, so that frequencies near to one another have one
  /// number.
  int slices_of(const Stretch& stretch, double largest_slowness) const {
    const auto amplitudes = [&](int steps) {
      Evolution alone(size(), 0);
      alone.mix(Eigen::MatrixXd::Identity(size(), size()));
      pass_slices(alone, stretch, steps);
      return alone.amplitudes(largest_slowness);
    };
    constexpr double aim = 3e-9, regular = 1e-5;
    constexpr int most = 1 << 13;
    const int least = 8 * static_cast<int>(stretch.drive->envelope.half_waves);
    int steps = least;
    Eigen::MatrixXcd coarse = amplitudes(steps);
    double error = 1;
    while (error > regular && steps < most) {
      steps *= 2;
      const Eigen::MatrixXcd fine = amplitudes(steps);
      error = (fine - coarse).cwiseAbs().maxCoeff() / 15;
      coarse = fine;
    }
    const double factor = std::clamp(std::sqrt(std::sqrt(error / aim)), 0.5, 8.0);
    const auto wanted = static_cast<unsigned>(std::max(least, static_cast<int>(std::ceil(factor * steps))));
    const unsigned digit = std::max(1U, std::bit_floor(wanted) / 4);
    return static_cast<int>((wanted + digit - 1) / digit * digit);
  }

  const std::vector<LevelLabel>& labels_;
  const std::vector<int>& levels_;
  std::vector<int> random_clocks_;
  const RotatingFrame* frame_ = nullptr;
  StandingCoupling standing_{};  // of the present stretch, where driven
  Eigen::VectorXd phase_;        // [cycles] n_i phase + m_i chi of the present frame
};

/// Of the levels of a set at most.
int photons_apart(const RotatingFrame& frame, const std::vector<int>& levels) {
  int least = frame.photons[static_cast<std::size_t>(levels.front())], most = least;
  for (const int level : levels) {
    least = std::min(least, frame.photons[static_cast<std::size_t>(level)]);
    most = std::max(most, frame.photons[static_cast<std::size_t>(level)]);
  }
  return most - least;
}

/// Clocks of driven stretches whose start phase is random.
std::vector<int> random_clocks(const std::vector<Stretch>& stretches) {
  std::vector<int> clocks;
  for (const Stretch& stretch : stretches)
    if (stretch.drive && stretch.drive->oscillator.random_phase &&
        std::ranges::find(clocks, stretch.drive->oscillator.part) == clocks.end())
      clocks.push_back(stretch.drive->oscillator.part);
  return clocks;
}

}  // namespace

DrivenLevels::DrivenLevels(const CoupledSpins& spins, std::vector<LevelZone> zones, double largest_slowness)
    : block_of_(static_cast<std::size_t>(spins.levels()), -1) {
  std::vector<Stretch> stretches = stretches_of(spins, std::move(zones));
  const std::deque<RotatingFrame> frames = add_frames(spins, stretches);
  for (const Stretch& stretch : stretches)
    if (stretch.is_driven())
      neglected_ = std::max(neglected_, neglected_amplitude(*stretch.frame, stretch.states));
  // What comes before the first drive and after the last one turns each level by itself.
  const auto last =
      std::find_if(stretches.rbegin(), stretches.rend(), std::mem_fn(&Stretch::is_driven)).base();
  stretches.erase(last, stretches.end());

  const std::vector<LevelLabel> labels = level_labels(spins);
  const std::vector<int> clocks = random_clocks(stretches);
  const auto coupled = [&](int i, int j) {
    return std::ranges::any_of(stretches, [&](const Stretch& s) { return s.mixes(i, j); });
  };
  for (const std::vector<int>& set : sets_of(spins.levels(), coupled)) {
    if (set.size() < 2) continue;
    const Evolution evolution = BlockBuilder(labels, set, clocks).evolution(stretches, largest_slowness);
    if (!evolution.mixes()) continue;
    for (const int level : set) block_of_[static_cast<std::size_t>(level)] = static_cast<int>(blocks_.size());
    if (frames.size() == 1) photons_ = std::max(photons_, photons_apart(frames.front(), set));
    blocks_.push_back(evolution.lay_out(numbers_));
    blocks_.back().first_level = static_cast<int>(levels_.size());
    levels_.insert(levels_.end(), set.begin(), set.end());
  }
}

std::uint64_t DrivenLevels::reachable_from(int level) const {
  const int block = block_of_[static_cast<std::size_t>(level)];
  if (block < 0) return std::uint64_t{1} << level;
  std::uint64_t bits = 0;
  for (int to = 0; to < levels(); ++to)
    if (block_of_[static_cast<std::size_t>(to)] == block) bits |= std::uint64_t{1} << to;
  return bits;
}

double DrivenLevels::work() const {
  constexpr double turn = 30;  // of one level
  double sum = levels();
  for (const LevelBlock& b : blocks_)
    sum += b.levels * (b.samples * b.steps * b.levels * (turn + 4 * b.levels)) / levels();
  return sum;
}

}  // namespace rabiline
