#include "spin/evolution.hpp"

#include <cmath>
#include <complex>
#include <utility>

#include "core/constants.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

constexpr int smallest_product = 4;  // matrices below are multiplied faster without Eigen's packing

/// (re, im) of one row times exp(-2 pi i cycles).
template <typename Row>
void turn_row(Row&& row, double cycles) {
  const double angle = constants::two_pi * (cycles - std::nearbyint(cycles));
  const double c = portable::cos(angle), s = portable::sin(angle);
  const Eigen::Index n = row.size() / 2;
  double *re = row.data(), *im = re + n;
  for (Eigen::Index k = 0; k < n; ++k) {
    const double real = re[k];
    re[k] = c * real + s * im[k];
    im[k] = c * im[k] - s * real;
  }
}

}  // namespace

Evolution::Evolution(int levels, int random_angles) : levels_(levels), random_angles_(random_angles) {
  segments_.push_back({Eigen::MatrixXi::Zero(random_angles, levels), {}});
  begin_step(Eigen::MatrixXd::Identity(levels, levels));
}

void Evolution::begin_step(const Eigen::MatrixXd& matrix) {
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(levels_);
  segments_.back().steps.push_back({matrix, zero, zero});
}

void Evolution::mix(const Eigen::MatrixXd& matrix) {
  mixed_ = true;
  Step& step = segments_.back().steps.back();
  if (step.turns)
    begin_step(matrix);
  else
    step.mixing = (matrix * step.mixing).eval();
}

void Evolution::turn(const Eigen::VectorXd& angle, const Eigen::VectorXd& rate) {
  if (!mixed_) return;
  Step& step = segments_.back().steps.back();
  step.angle += angle;
  step.rate += rate;
  step.turns = true;
}

void Evolution::turn_at_random(const Eigen::MatrixXi& n) {
  if (!mixed_) return;
  if (n.colwise() - n.col(0) == Eigen::MatrixXi::Zero(n.rows(), n.cols())) return;
  segments_.push_back({n, {}});
  begin_step(Eigen::MatrixXd::Identity(levels_, levels_));
}

Evolution::Pairs Evolution::product_of(const Segment& segment, double slowness) const {
  Pairs product = Pairs::Zero(levels_, Eigen::Index{2} * levels_), next = product;
  product.leftCols(levels_) = segment.steps.front().mixing;
  for (std::size_t k = 0; k < segment.steps.size(); ++k) {
    const Step& step = segment.steps[k];
    if (k > 0) {
      if (levels_ < smallest_product)
        next = step.mixing.lazyProduct(product);
      else
        next.noalias() = step.mixing * product;
      std::swap(product, next);
    }
    if (step.turns)
      for (int i = 0; i < levels_; ++i) turn_row(product.row(i), step.angle(i) + step.rate(i) * slowness);
  }
  return product;
}

Eigen::MatrixXcd Evolution::amplitudes(double slowness) const {
  Eigen::MatrixXcd all = Eigen::MatrixXcd::Identity(levels_, levels_);
  for (const Segment& segment : segments_) {
    const Pairs p = product_of(segment, slowness);
    const Eigen::MatrixXcd of_segment =
        p.leftCols(levels_) + std::complex<double>(0, 1) * p.rightCols(levels_);
    all = (of_segment * all).eval();
  }
  return all;
}

/// Steps of each random angle. Where a common shift of all of them changes nothing, the first one stays zero.
std::vector<int> Evolution::samples() const {
  std::vector<int> samples(random_angles_, 1);
  bool only_differences = true;
  for (const Segment& segment : segments_) {
    const Eigen::VectorXi common = segment.random.colwise().sum();
    only_differences = only_differences && common.minCoeff() == common.maxCoeff();
    for (int c = 0; c < random_angles_; ++c)
      samples[c] += segment.random.row(c).maxCoeff() - segment.random.row(c).minCoeff();
  }
  if (only_differences && random_angles_ > 0) samples[0] = 1;
  return samples;
}

Eigen::MatrixXd Evolution::probabilities(double slowness) const {
  const auto squared = [this](const Pairs& p) -> Eigen::MatrixXd {
    return (p.leftCols(levels_).array().square() + p.rightCols(levels_).array().square())
        .matrix()
        .transpose();
  };
  const Pairs first = product_of(segments_.front(), slowness);
  if (segments_.size() == 1) return squared(first);

  std::vector<Eigen::MatrixXcd> later;
  for (std::size_t k = 1; k < segments_.size(); ++k) {
    const Pairs p = product_of(segments_[k], slowness);
    later.emplace_back(p.leftCols(levels_) + std::complex<double>(0, 1) * p.rightCols(levels_));
  }
  const Eigen::MatrixXcd start =
      first.leftCols(levels_) + std::complex<double>(0, 1) * first.rightCols(levels_);
  const std::vector<int> count = samples();
  Eigen::VectorXi sample = Eigen::VectorXi::Zero(random_angles_);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(levels_, levels_);
  Eigen::MatrixXcd all, turned;
  int taken = 0;
  for (bool more = true; more;) {
    all = start;
    for (std::size_t k = 0; k < later.size(); ++k) {
      turned = all;
      for (int i = 0; i < levels_; ++i) {
        double cycles = 0;
        for (int c = 0; c < random_angles_; ++c)
          cycles += segments_[k + 1].random(c, i) * sample(c) / static_cast<double>(count[c]);
        const double angle = constants::two_pi * (cycles - std::nearbyint(cycles));
        turned.row(i) *= std::complex(portable::cos(angle), portable::sin(angle));
      }
      all.noalias() = later[k] * turned;
    }
    sum += all.cwiseAbs2().transpose();
    ++taken;
    more = false;  // the next sample, the first angle running fastest
    for (int c = 0; c < random_angles_ && !more; ++c) {
      sample(c) = (sample(c) + 1) % count[c];
      more = sample(c) != 0;
    }
  }
  return sum / taken;
}

}  // namespace rabiline
