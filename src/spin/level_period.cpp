#include "spin/level_period.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "core/constants.hpp"
#include "core/eigensystem.hpp"
#include "core/portable_math.hpp"

namespace rabiline {
namespace {

using constants::two_pi;
using Complex = std::complex<double>;
using Eigen::MatrixXcd;
constexpr int fewest_samples = 64, most_samples = 8192;
constexpr double most_turning = 2;  // [rad] in a step
constexpr double unseen = 1e-12;    // of modes, what is left out

Complex phase(double angle) { return {portable::cos(angle), portable::sin(angle)}; }

/// H = energy + wave exp(i angle) + its adjoint, in rad/s.
struct Hamiltonian {
  Eigen::VectorXd energy;
  MatrixXcd wave;
  double omega = 0;

  /// What bounds its eigenvalues' size.
  double radius() const {
    const Eigen::MatrixXd size = wave.cwiseAbs2().cwiseSqrt();
    return energy.cwiseAbs().maxCoeff() + (size + size.transpose()).rowwise().sum().maxCoeff();
  }
};

Hamiltonian hamiltonian_of(const LevelManifold& f, const PeriodicField& at) {
  const double ratio = at.field / f.scale, root = portable::hypot(ratio, 1, 0),
               place = portable::atan2(ratio, 1) * (f.cells / std::numbers::pi) + 0.5 * f.cells,
               cell = std::clamp(std::floor(place), 0.0, f.cells - 1.0), x = 2 * (place - cell) - 1;
  const double* rows = f.rows + static_cast<std::ptrdiff_t>(cell) * level_powers * f.width;
  const auto number = [&](int i) {
    double sum = 0;
    for (int power = level_powers - 1; power >= 0; --power) sum = sum * x + rows[power * f.width + i];
    return sum;
  };
  Hamiltonian h{Eigen::VectorXd(f.levels), MatrixXcd::Zero(f.levels, f.levels), at.omega};
  const int first_pair = 3 * f.levels + f.couplings;
  const Complex lowers = 0.25 * f.moment * (at.c[0] + Complex(0, 1) * at.c[1]),
                raises = 0.25 * f.moment * (at.c[0] - Complex(0, 1) * at.c[1]),
                along = 0.5 * f.moment * at.c[2];
  for (int k = 0; k < f.levels; ++k) {
    h.energy(k) = root * number(k) + f.taken_off[k];
    h.wave(k, k) = number(first_pair + f.pairs + k) * along;
  }
  h.energy.array() -= h.energy.mean();
  for (int p = 0; p < f.pairs; ++p) {
    const int low = f.low[p], high = f.high[p];
    const bool keeps = f.m[low] == f.m[high];
    h.wave(low, high) = number(first_pair + p) * (keeps ? along : lowers);
    h.wave(high, low) = number(first_pair + p) * (keeps ? along : raises);
  }
  return h;
}

/// The propagators from the angle 0 to each of so many equal parts of a period, by Taylor's series of each
/// step.
std::vector<MatrixXcd> propagators(const Hamiltonian& h, int samples) {
  const Eigen::Index levels = h.energy.size();
  const double period = two_pi / std::abs(h.omega);
  const int substeps = static_cast<int>(std::ceil(h.radius() * period / samples / most_turning));
  const double time = period / samples / substeps;
  const Complex turning(0, h.omega * time), by(0, -time);
  std::vector<MatrixXcd> out{MatrixXcd::Identity(levels, levels)};
  for (int sample = 0; sample < samples; ++sample) {
    MatrixXcd now = out.back();
    for (int i = 0; i < substeps; ++i) {
      const Complex begun = phase(h.omega * period * (sample + static_cast<double>(i) / substeps) / samples);
      const MatrixXcd wave = begun * h.wave, even = wave + wave.adjoint(), odd = wave - wave.adjoint();
      // Of the waves' series the powers of the time are even and odd by turns.
      std::vector<MatrixXcd> term{now}, of_even, of_odd;
      for (int n = 0; n < 60; ++n) {
        of_even.push_back(even * term.back());
        of_odd.push_back(odd * term.back());
        MatrixXcd next = h.energy.asDiagonal() * term.back();
        Complex power = 1;
        for (int r = 0; r <= n; ++r) {
          const auto before = static_cast<std::size_t>(n - r);
          next += power * (r % 2 == 0 ? of_even[before] : of_odd[before]);
          power *= turning / (r + 1.0);
        }
        next *= by / (n + 1.0);
        now += next;
        const bool is_last = next.cwiseAbs2().maxCoeff() < 1e-36;
        term.push_back(std::move(next));
        if (is_last) break;
      }
    }
    out.push_back(std::move(now));
  }
  return out;
}

/// Orthonormal eigenvectors of a unitary matrix, as those of its Cayley transform, from where no eigenvalue
/// is near.
MatrixXcd eigenvectors_of(const MatrixXcd& unitary) {
  constexpr int tries = 32;
  const MatrixXcd one = MatrixXcd::Identity(unitary.rows(), unitary.rows());
  MatrixXcd best;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < tries; ++i) {
    const MatrixXcd turned = phase(two_pi * i / tries) * unitary;
    const MatrixXcd cayley = Complex(0, 1) * (one + turned).partialPivLu().solve(one - turned);
    const double size = cayley.cwiseAbs2().maxCoeff();
    if (!(size < least)) continue;
    least = size;
    best = 0.5 * (cayley + cayley.adjoint());
  }
  return eigensystem_of<MatrixXcd>(best).vectors;
}

/// sum_s exp(-2 pi i n s/count) value_s for each n, of a power of two of them (J. Cooley and J. Tukey, Math.
/// Comput. 19, 297 (1965)).
std::vector<MatrixXcd> transformed(const std::vector<MatrixXcd>& values) {
  const std::size_t count = values.size();
  if (count == 1) return values;
  std::vector<MatrixXcd> half[2], out(count);
  for (std::size_t i = 0; i < count; ++i) half[i % 2].push_back(values[i]);
  const std::vector<MatrixXcd> even = transformed(half[0]), odd = transformed(half[1]);
  for (std::size_t n = 0; n < count / 2; ++n) {
    const MatrixXcd turned = phase(-two_pi * static_cast<double>(n) / static_cast<double>(count)) * odd[n];
    out[n] = even[n] + turned;
    out[n + count / 2] = even[n] - turned;
  }
  return out;
}

/// [n] The harmonics of modes whose values at equal parts of the period are given, from -samples/2 on.
std::vector<MatrixXcd> harmonics_of(const std::vector<MatrixXcd>& values, bool is_reversed) {
  const std::vector<MatrixXcd> all = transformed(values);
  const auto samples = static_cast<int>(values.size());
  std::vector<MatrixXcd> out;
  for (int n = -samples / 2; n < samples / 2; ++n)
    out.push_back(all[static_cast<std::size_t>(((is_reversed ? -n : n) + samples) % samples)] / samples);
  return out;
}

struct Modes {
  std::vector<MatrixXcd> harmonic;  // [n + samples/2] level, mode
  Eigen::VectorXd quasi;            // [rad/s]
};
/// Nothing where so many samples are too few.
std::optional<Modes> modes_of(const Hamiltonian& h, const std::vector<double>& photons, int samples) {
  const double sense = h.omega < 0 ? -1 : 1, period = two_pi / std::abs(h.omega);
  std::vector<MatrixXcd> values = propagators(h, samples);
  const MatrixXcd whole = values.back(), states = eigenvectors_of(whole);
  values.pop_back();
  const Eigen::Index levels = states.rows();
  Modes out{{}, Eigen::VectorXd(levels)};
  for (Eigen::Index k = 0; k < levels; ++k) {
    const Complex turned = states.col(k).dot(whole * states.col(k));
    out.quasi(k) = -portable::atan2(turned.imag(), turned.real()) / period;
  }
  const auto moved = [&](const auto& angle_of) {  // [level, mode] phases
    MatrixXcd phases(levels, levels);
    for (Eigen::Index j = 0; j < levels; ++j)
      for (Eigen::Index k = 0; k < levels; ++k)
        phases(j, k) = phase(angle_of(static_cast<std::size_t>(j), k));
    return phases;
  };
  for (int s = 0; s < samples; ++s) {
    MatrixXcd& value = values[static_cast<std::size_t>(s)];
    const double part = static_cast<double>(s) / samples;
    value = (value * states).eval().cwiseProduct(moved([&](std::size_t j, Eigen::Index k) {
      return two_pi * std::fmod(sense * photons[j] * s, samples) / samples + out.quasi(k) * period * part;
    }));
  }
  // Each mode around its largest harmonic.
  std::vector<MatrixXcd> harmonic = harmonics_of(values, h.omega < 0);
  std::vector<int> largest(static_cast<std::size_t>(levels));
  for (Eigen::Index k = 0; k < levels; ++k) {
    const auto most =
        std::ranges::max_element(harmonic, {}, [&](const MatrixXcd& c) { return c.col(k).squaredNorm(); });
    largest[static_cast<std::size_t>(k)] = static_cast<int>(most - harmonic.begin()) - samples / 2;
  }
  out.harmonic.assign(harmonic.size(), MatrixXcd::Zero(levels, levels));
  for (Eigen::Index k = 0; k < levels; ++k) {
    const int shift = largest[static_cast<std::size_t>(k)];
    out.quasi(k) -= shift * h.omega;
    for (int n = 0; n < samples; ++n)
      out.harmonic[static_cast<std::size_t>(n)].col(k) =
          harmonic[static_cast<std::size_t>((n + shift + samples) % samples)].col(k);
  }
  for (int n = 0; n < samples; ++n)
    if (std::abs(n - samples / 2) > 3 * samples / 8 &&
        out.harmonic[static_cast<std::size_t>(n)].cwiseAbs2().maxCoeff() > unseen * unseen)
      return std::nullopt;
  return out;
}

/// The quasi-energies as Rayleigh's quotients of Floquet's equation, which modes that are slightly off change
/// by their square, and the largest that is left of it.
double refine(const Hamiltonian& h, const std::vector<double>& photons, Modes& modes) {
  const Eigen::Index levels = h.energy.size();
  const int samples = static_cast<int>(modes.harmonic.size()), middle = samples / 2;
  std::vector<MatrixXcd> by_h;
  const auto part = [&](int n, Eigen::Index j, Eigen::Index k) {
    return n < 0 || n >= samples ? Complex() : modes.harmonic[static_cast<std::size_t>(n)](j, k);
  };
  for (int n = 0; n < samples; ++n) {
    MatrixXcd sum(levels, levels);
    for (Eigen::Index j = 0; j < levels; ++j) {
      const double own = h.energy(j) + (n - middle - photons[static_cast<std::size_t>(j)]) * h.omega;
      sum.row(j) = own * modes.harmonic[static_cast<std::size_t>(n)].row(j);
      for (Eigen::Index l = 0; l < levels; ++l) {
        const int ahead =
            static_cast<int>(photons[static_cast<std::size_t>(j)] - photons[static_cast<std::size_t>(l)]);
        for (Eigen::Index k = 0; k < levels; ++k)
          sum(j, k) +=
              h.wave(j, l) * part(n - 1 - ahead, l, k) + std::conj(h.wave(l, j)) * part(n + 1 - ahead, l, k);
      }
    }
    by_h.push_back(std::move(sum));
  }
  double left = 0;
  for (Eigen::Index k = 0; k < levels; ++k) {
    double norm = 0, energy = 0, square = 0;
    for (std::size_t n = 0; n < by_h.size(); ++n) {
      norm += modes.harmonic[n].col(k).squaredNorm();
      energy += modes.harmonic[n].col(k).dot(by_h[n].col(k)).real();
    }
    modes.quasi(k) = energy / norm;
    for (std::size_t n = 0; n < by_h.size(); ++n)
      square += (by_h[n].col(k) - modes.quasi(k) * modes.harmonic[n].col(k)).squaredNorm();
    left = std::max(left, std::sqrt(square / norm));
  }
  return left;
}

}  // namespace

LevelPeriod::LevelPeriod(const LevelManifold& f, const PeriodicField& at) {
  const Hamiltonian h = hamiltonian_of(f, at);
  double mean = 0;
  for (int k = 0; k < f.levels; ++k) mean += f.taken_off[k] / f.levels;
  for (int k = 0; k < f.levels; ++k) {
    photons_.push_back(std::round(h.energy(k) / at.omega));
    rate_.push_back(f.taken_off[k] - mean - photons_.back() * at.omega);
  }
  quasi_.assign(photons_.size(), 0);
  std::optional<Modes> modes;
  int samples = fewest_samples;
  // Levels of different photons exchange some.
  const auto [low, high] = std::ranges::minmax(photons_);
  while (samples <= most_samples && 3 * samples < 8 * (high - low + 16)) samples *= 2;
  for (; !modes && samples <= most_samples; samples *= 2) modes = modes_of(h, photons_, samples);
  constexpr double most_left = 1e-9;
  if (!modes || !(refine(h, photons_, *modes) < most_left * h.radius())) return;
  std::ranges::copy(modes->quasi, quasi_.begin());
  const int middle = static_cast<int>(modes->harmonic.size()) / 2;
  for (int n = 0; n < 2 * middle; ++n) {
    const MatrixXcd& harmonic = modes->harmonic[static_cast<std::size_t>(n)];
    const auto before = terms_.size();
    for (int l = 0; l < f.levels; ++l)
      for (int k = 0; k < f.levels; ++k)
        if (const Complex c = harmonic(l, k); std::max(std::abs(c.real()), std::abs(c.imag())) > unseen)
          terms_.push_back({l, k, c.real(), c.imag()});
    if (terms_.empty()) continue;
    if (before == 0) first_ = n - middle;
    ends_.push_back(static_cast<int>(terms_.size()));
  }
  while (ends_.size() > 1 && ends_[ends_.size() - 2] == ends_.back()) ends_.pop_back();
}

double time_for_period(const CoupledSpins& spins, double field, double driving, double omega) {
  constexpr double each = 2e-7, strongest = 24;  // [s] of a step and three levels
  const double frequency = std::abs(omega),
               moment = two_pi * std::max(std::abs(spins.zeeman_j), std::abs(spins.zeeman_i)) *
                        (spins.twice_i + spins.twice_j) / 2;
  double low = 0, high = 0;
  for (int f = std::abs(spins.twice_i - spins.twice_j); f <= spins.twice_i + spins.twice_j; f += 2) {
    low = std::min(low, two_pi * zero_field_energy(spins, f));
    high = std::max(high, two_pi * zero_field_energy(spins, f));
  }
  const double photons = (high - low + 2 * moment * field) / frequency,
               turning = ((high - low) / 2 + moment * (field + driving)) / frequency,
               samples = std::max(1.0 * fewest_samples, 4 * (photons + 16)),
               steps = std::max(samples, two_pi * turning / most_turning);
  if (moment * driving > strongest * frequency || samples > most_samples)
    return std::numeric_limits<double>::infinity();
  return each * steps * portable::pow(spins.levels(), 3);
}

}  // namespace rabiline
