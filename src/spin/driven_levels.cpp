#include "spin/driven_levels.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <map>
#include <memory>
#include <stdexcept>
#include <utility>

#include "core/constants.hpp"
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
  Eigen::MatrixXd kept{};                // [Hz] coupling at full amplitude, where driven
};

constexpr double rounding = 1e-9;  // [m] of where zones begin and end

void check(const LevelZone& zone, double last_end) {
  if (!(zone.end >= zone.begin) || zone.begin < last_end - rounding)
    throw std::invalid_argument("zones of driven levels do not ascend along the beam");
  if (!(zone.field >= 0)) throw std::invalid_argument("a zone's field is negative");
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
      if (sense_of(*drive) == 0 && drive->oscillator.frequency < 0) {  // cos p = cos(-p)
        stretch.drive->oscillator.frequency *= -1;
        stretch.drive->oscillator.phase *= -1;
      }
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
      frames.push_back(rotating_frame(labels, drive, zones));
      frame = std::prev(frames.end());
    }
    stretch.frame = &*frame;
    stretch.kept = kept_coupling(*frame, stretch.states);
  }
  return frames;
}

/// Sets of levels that the given pairs connect, directly or through others.
template <typename Connected>
std::vector<std::vector<int>> sets_of(const std::vector<int>& levels, Connected connected) {
  std::vector<std::vector<int>> sets;
  std::vector<int> waiting = levels;
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

struct Slice {
  double length = 0;  // [m]
  double share = 0;   // of the full amplitude
};

/// Each step's two exponentials are again slices of a constant amplitude: with the amplitudes g_1, g_2 at
/// Gauss's points, (1/2 +- 1/sqrt 3) of them each.
std::vector<Slice> magnus_slices(const Stretch& stretch, int steps) {
  std::vector<Slice> slices;
  const double step = (stretch.end - stretch.begin) / steps, gauss = std::sqrt(3.0) / 6;
  const double near = 0.5 + 2 * gauss, far = 0.5 - 2 * gauss;
  for (int k = 0; k < steps; ++k) {
    const double middle = stretch.begin + (k + 0.5) * step;
    const double first = share_of(stretch.drive->envelope, middle - gauss * step);
    const double second = share_of(stretch.drive->envelope, middle + gauss * step);
    slices.push_back({step / 2, near * first + far * second});
    slices.push_back({step / 2, far * first + near * second});
  }
  return slices;
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
      const bool driven = stretch.drive && stretch.kept(levels_, levels_).any();
      if (driven) enter(out, stretch);
      if (driven)
        drive(out, stretch, largest_slowness);
      else if (frame_ != nullptr)
        out.turn(Eigen::VectorXd::Zero(size()), energies(stretch) * (stretch.end - stretch.begin));
    }
    return out;
  }

 private:
  int size() const { return static_cast<int>(levels_.size()); }

  /// E_i/h - n_i f less that of the first level, in the present frame.
  Eigen::VectorXd energies(const Stretch& stretch) const {
    Eigen::VectorXd energy(size());
    for (int k = 0; k < size(); ++k) {
      const int photons = frame_->photons[levels_[k]] - frame_->photons[levels_[0]];
      energy(k) = stretch.energy(levels_[k]) - stretch.energy(levels_[0]) - photons * frame_->frequency;
    }
    return energy;
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

  void pass(Evolution& out, const Stretch& stretch, const std::vector<Slice>& slices) const {
    const Eigen::VectorXd energy = energies(stretch);
    const Eigen::MatrixXd coupling = stretch.kept(levels_, levels_);
    Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver;
    for (const Slice& slice : slices) {
      Eigen::MatrixXd h = slice.share * coupling;
      h.diagonal() += energy;
      solver.compute(h);
      out.mix(solver.eigenvectors().transpose());
      out.turn(Eigen::VectorXd::Zero(size()), solver.eigenvalues() * slice.length);
      out.mix(solver.eigenvectors());
    }
  }

  void drive(Evolution& out, const Stretch& stretch, double largest_slowness) const {
    if (stretch.drive->envelope.shape == Shape::rectangular)
      return pass(out, stretch, {{stretch.end - stretch.begin, 1}});
    const auto amplitudes = [&](int steps) {
      Evolution alone(size(), 0);
      pass(alone, stretch, magnus_slices(stretch, steps));
      return alone.amplitudes(largest_slowness);
    };
    // Steps are doubled until the error falls with their fourth power, then as many as it takes are known.
    constexpr double aim = 3e-8, regular = 1e-5;
    constexpr int most = 1 << 13;
    int steps = 4;
    Eigen::MatrixXcd coarse = amplitudes(steps);
    double error = 1;
    while (error > regular && steps < most) {
      steps *= 2;
      const Eigen::MatrixXcd fine = amplitudes(steps);
      error = (fine - coarse).cwiseAbs().maxCoeff() / 15;
      coarse = fine;
    }
    const double factor = std::clamp(std::sqrt(std::sqrt(error / aim)), 0.5, 8.0);
    pass(out, stretch, magnus_slices(stretch, std::max(4, static_cast<int>(std::ceil(factor * steps)))));
  }

  const std::vector<LevelLabel>& labels_;
  const std::vector<int>& levels_;
  std::vector<int> random_clocks_;
  const RotatingFrame* frame_ = nullptr;
  Eigen::VectorXd phase_;  // [cycles] n_i phase + m_i chi of the present frame
};

/// Clocks of driven stretches whose start phase is random.
std::vector<int> random_clocks(const std::vector<Stretch>& stretches) {
  std::vector<int> clocks;
  for (const Stretch& stretch : stretches)
    if (stretch.drive && stretch.drive->oscillator.random_phase &&
        std::ranges::find(clocks, stretch.drive->oscillator.part) == clocks.end())
      clocks.push_back(stretch.drive->oscillator.part);
  return clocks;
}

/// Cycles per s/m of the phases between levels that a drive mixes by more than 1e-3 somewhere, summed along
/// the stretches.
double fastest_of(const std::vector<Stretch>& stretches, const std::vector<int>& block) {
  constexpr double least_mixing = 1e-3;
  // E_i/h - n_i f of one block in a drive's frame; without one the last frame holds.
  const auto energy = [](const Stretch& stretch, const RotatingFrame& frame, int i) {
    return stretch.energy(i) - frame.photons[i] * frame.frequency;
  };
  const auto mixes = [&](int i, int j) {
    return std::ranges::any_of(stretches, [&](const Stretch& stretch) {
      if (stretch.frame == nullptr || stretch.kept(i, j) == 0) return false;
      const double v = 2 * stretch.kept(i, j);
      const double apart = energy(stretch, *stretch.frame, i) - energy(stretch, *stretch.frame, j);
      return v * v > least_mixing * (v * v + apart * apart);
    });
  };
  double fastest = 0;
  for (const std::vector<int>& set : sets_of(block, mixes)) {
    if (set.size() < 2) continue;
    double sum = 0;
    const RotatingFrame* frame = nullptr;
    for (const Stretch& stretch : stretches) {
      const auto spread = [&](auto value) {
        const auto [least, most] = std::ranges::minmax(set, {}, value);
        return value(most) - value(least);
      };
      if (stretch.frame != nullptr && frame != nullptr && frame != stretch.frame)
        sum += std::abs(stretch.begin) * spread([&](int i) {
                 return stretch.frame->photons[i] * stretch.frame->frequency -
                        frame->photons[i] * frame->frequency;
               });
      if (stretch.frame != nullptr) frame = stretch.frame;
      if (frame == nullptr) continue;
      const double length = stretch.end - stretch.begin;
      sum += length * spread([&](int i) { return energy(stretch, *frame, i); });
      if (stretch.frame != nullptr)
        sum += 2 * length * stretch.kept(set, set).cwiseAbs().rowwise().sum().maxCoeff();
    }
    fastest = std::max(fastest, sum);
  }
  return fastest;
}

}  // namespace

DrivenLevels::DrivenLevels(const CoupledSpins& spins, std::vector<LevelZone> zones, double largest_slowness)
    : levels_(spins.levels()) {
  std::vector<Stretch> stretches = stretches_of(spins, std::move(zones));
  const std::deque<RotatingFrame> frames = add_frames(spins, stretches);
  const auto is_driven = [](const Stretch& stretch) { return stretch.frame != nullptr; };
  for (const Stretch& stretch : stretches)
    if (is_driven(stretch))
      neglected_ = std::max(neglected_, neglected_amplitude(*stretch.frame, stretch.states));
  // What comes before the first drive and after the last one turns each level by itself.
  const auto last = std::find_if(stretches.rbegin(), stretches.rend(), is_driven).base();
  stretches.erase(last, stretches.end());

  std::vector<int> all(levels_);
  for (int n = 0; n < levels_; ++n) all[n] = n;
  const std::vector<LevelLabel> labels = level_labels(spins);
  const std::vector<int> clocks = random_clocks(stretches);
  const auto coupled = [&](int i, int j) {
    return std::ranges::any_of(stretches,
                               [&](const Stretch& s) { return s.frame != nullptr && s.kept(i, j) != 0; });
  };
  for (const std::vector<int>& set : sets_of(all, coupled)) {
    blocks_.push_back({set, BlockBuilder(labels, set, clocks).evolution(stretches, largest_slowness)});
    fastest_ = std::max(fastest_, fastest_of(stretches, set));
  }
}

std::vector<std::pair<int, int>> DrivenLevels::connected() const {
  std::vector<std::pair<int, int>> pairs;
  for (const Block& block : blocks_)
    for (const int from : block.levels)
      for (const int to : block.levels) pairs.emplace_back(from, to);
  return pairs;
}

void DrivenLevels::put_probabilities(double slowness, double* out) const {
  for (const Block& block : blocks_) {
    const Eigen::MatrixXd p = block.evolution.probabilities(slowness);
    for (Eigen::Index from = 0; from < p.rows(); ++from)
      for (Eigen::Index to = 0; to < p.cols(); ++to) *out++ = p(from, to);
  }
}

Eigen::MatrixXd DrivenLevels::probabilities(double slowness) const {
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(levels_, levels_);
  for (const Block& block : blocks_)
    all(block.levels, block.levels) = block.evolution.probabilities(slowness);
  return all;
}

}  // namespace rabiline
