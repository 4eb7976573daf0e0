#include "spin/evolution.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <functional>
#include <numeric>

#include "core/constants.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

/// What an orthogonal mixing of two levels does to Bloch's vector, as LevelBlock has it.
std::array<double, 5> turn_of_bloch_vector(const Eigen::MatrixXd& m) {
  const double a = m(0, 0), b = m(0, 1), c = m(1, 0), d = m(1, 1);
  return {0.5 * (a * a - b * b - c * c + d * d), a * b - c * d, a * c - b * d, a * d + b * c, a * d - b * c};
}

}  // namespace

Evolution::Evolution(int levels, int random_angles) : levels_(levels), random_angles_(random_angles) {}

void Evolution::mix(const Eigen::MatrixXd& matrix) {
  if (!steps_.empty() && !steps_.back().turns) {
    steps_.back().mixing = (matrix * steps_.back().mixing).eval();
    return;
  }
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(levels_);
  steps_.push_back({matrix, zero, zero, Eigen::MatrixXi::Zero(random_angles_, levels_)});
}

void Evolution::turn(const Eigen::VectorXd& angle, const Eigen::VectorXd& rate) {
  if (steps_.empty()) return;
  steps_.back().angle += angle;
  steps_.back().rate += rate;
  steps_.back().turns = true;
}

void Evolution::turn_at_random(const Eigen::MatrixXi& n) {
  if (steps_.empty()) return;
  steps_.back().random += n;
  steps_.back().turns = true;
}

Eigen::MatrixXcd Evolution::amplitudes(double slowness) const {
  Eigen::MatrixXcd all = Eigen::MatrixXcd::Identity(levels_, levels_);
  for (const Step& step : steps_) {
    all = (step.mixing * all).eval();
    for (int i = 0; step.turns && i < levels_; ++i) {
      const double cycles = step.angle(i) + step.rate(i) * slowness;
      const double angle = -constants::two_pi * (cycles - std::nearbyint(cycles));
      all.row(i) *= std::complex(portable::cos(angle), portable::sin(angle));
    }
  }
  return all;
}

/// Of each random angle. Where a common shift of all of them changes nothing, the first one stays zero.
std::vector<int> Evolution::samples() const {
  std::vector<int> samples(static_cast<std::size_t>(random_angles_), 1);
  bool only_differences = true;
  for (const Step& step : steps_) {
    const Eigen::VectorXi common = step.random.colwise().sum();
    only_differences = only_differences && common.minCoeff() == common.maxCoeff();
    for (int c = 0; c < random_angles_; ++c)
      samples[static_cast<std::size_t>(c)] += step.random.row(c).maxCoeff() - step.random.row(c).minCoeff();
  }
  if (only_differences && random_angles_ > 0) samples[0] = 1;
  return samples;
}

LevelBlock Evolution::lay_out(std::vector<double>& numbers) const {
  const std::vector<int> count = samples();
  LevelBlock block{.levels = levels_,
                   .steps = static_cast<int>(steps_.size()) - 1,
                   .samples = std::accumulate(count.begin(), count.end(), 1, std::multiplies<>()),
                   .first_number = static_cast<int>(numbers.size())};
  const auto add_row = [&](const auto& row) { numbers.insert(numbers.end(), row.begin(), row.end()); };
  const auto add_matrix = [&](const Eigen::MatrixXd& m) {
    if (levels_ == 2) return add_row(turn_of_bloch_vector(m));
    for (int i = 0; i < levels_; ++i) add_row(m.row(i));
  };
  add_matrix(steps_.front().mixing);
  for (std::size_t k = 0; k + 1 < steps_.size(); ++k) {
    const Step& step = steps_[k];
    add_row((step.rate.array() - step.rate(0)).matrix());
    for (int sample = 0; sample < block.samples; ++sample) {
      Eigen::VectorXd angle = step.angle;
      for (int c = 0, rest = sample; c < random_angles_; ++c) {
        const int steps = count[static_cast<std::size_t>(c)];
        angle += step.random.row(c).transpose().cast<double>() * (rest % steps) / steps;
        rest /= steps;
      }
      add_row((angle.array() - angle(0)).matrix());
    }
    add_matrix(steps_[k + 1].mixing);
  }
  return block;
}

}  // namespace rabiline
