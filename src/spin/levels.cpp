#include "spin/levels.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/constants.hpp"
#include "core/eigensystem.hpp"
#include "spin/hamiltonian.hpp"

namespace rabiline {
namespace {

using constants::planck;

/// What one m_F has: its product states from the lowest energy in a strong field upwards, and beside each the
/// number of the level that becomes it.
struct Block {
  std::vector<int> products, levels;
};

/// F from I+J down, m_F from +F down: all levels of larger F come first.
int level_number(const CoupledSpins& spins, int twice_f, int twice_m) {
  int before = 0;
  for (int f = spins.twice_i + spins.twice_j; f > twice_f; f -= 2) before += f + 1;
  return before + (twice_f - twice_m) / 2;
}

Block block_of(const CoupledSpins& spins, int twice_m) {
  Block block;
  for (int m_j = -spins.twice_j; m_j <= spins.twice_j; m_j += 2)
    if (std::abs(twice_m - m_j) <= spins.twice_i)
      block.products.push_back(spins.product_index(m_j, twice_m - m_j));
  // At fixed m_F the strong-field energy is (zeeman_j - zeeman_i) B m_J + const.
  if (spins.zeeman_j < spins.zeeman_i) std::ranges::reverse(block.products);

  std::vector<int> weak;  // F from below, so that a stable sort leaves degenerate ones in the order of F
  for (int f = std::abs(spins.twice_i - spins.twice_j); f <= spins.twice_i + spins.twice_j; f += 2)
    if (f >= std::abs(twice_m)) weak.push_back(f);
  std::ranges::stable_sort(weak, {}, [&](int f) { return zero_field_energy(spins, f); });
  for (const int f : weak) block.levels.push_back(level_number(spins, f, twice_m));
  return block;
}

std::vector<Block> blocks_of(const CoupledSpins& spins) {
  std::vector<Block> blocks;
  const int top = spins.twice_i + spins.twice_j;
  for (int twice_m = top; twice_m >= -top; twice_m -= 2) blocks.push_back(block_of(spins, twice_m));
  return blocks;
}

std::vector<LevelLabel> labels_of(const CoupledSpins& spins, std::span<const Block> blocks) {
  std::vector<LevelLabel> labels(static_cast<std::size_t>(spins.levels()));
  for (int f = spins.twice_i + spins.twice_j, n = 0; n < spins.levels(); f -= 2)
    for (int m = f; m >= -f; m -= 2, ++n) labels[n] = {.twice_f = f, .twice_m = m};
  for (const Block& block : blocks)
    for (std::size_t k = 0; k < block.levels.size(); ++k) {
      labels[block.levels[k]].twice_m_j = spins.twice_m_j(block.products[k]);
      labels[block.levels[k]].twice_m_i = spins.twice_m_i(block.products[k]);
    }
  return labels;
}

/// An eigenvector is known up to its sign: the first component that does not vanish is made positive.
void fix_sign(Eigen::MatrixXd::ColXpr state) {
  for (const double component : state) {
    if (std::abs(component) < 1e-13) continue;
    if (component < 0) state = -state;
    return;
  }
}

}  // namespace

std::vector<LevelLabel> level_labels(const CoupledSpins& spins) { return labels_of(spins, blocks_of(spins)); }

std::optional<int> find_weak_field_level(std::span<const LevelLabel> labels, int twice_f, int twice_m) {
  for (std::size_t n = 0; n < labels.size(); ++n)
    if (labels[n].twice_f == twice_f && labels[n].twice_m == twice_m) return static_cast<int>(n);
  return std::nullopt;
}

std::optional<int> find_strong_field_level(std::span<const LevelLabel> labels, int twice_m_j, int twice_m_i) {
  for (std::size_t n = 0; n < labels.size(); ++n)
    if (labels[n].twice_m_j == twice_m_j && labels[n].twice_m_i == twice_m_i) return static_cast<int>(n);
  return std::nullopt;
}

Levels levels_at(const CoupledSpins& spins, double field) {
  const std::vector<Block> blocks = blocks_of(spins);
  const Eigen::MatrixXd h = hamiltonian(spins, field);
  const std::size_t count = static_cast<std::size_t>(spins.levels());
  Levels out{field, labels_of(spins, blocks), std::vector<double>(count), std::vector<double>(count),
             Eigen::MatrixXd::Zero(spins.levels(), spins.levels())};
  for (const Block& block : blocks) {
    const auto own = eigensystem_of<Eigen::MatrixXd>(h(block.products, block.products));
    for (std::size_t k = 0; k < block.levels.size(); ++k) {
      const int n = block.levels[k];
      double slope = 0;  // [Hz/T] <dH/dB>/h, diagonal in the basis
      for (std::size_t p = 0; p < block.products.size(); ++p) {
        const int product = block.products[p];
        const double amplitude = own.vectors(p, k);
        out.states(product, n) = amplitude;
        slope += amplitude * amplitude *
                 (spins.zeeman_i * spins.twice_m_i(product) + spins.zeeman_j * spins.twice_m_j(product)) / 2;
      }
      fix_sign(out.states.col(n));
      out.energy[n] = planck * own.values(k);
      out.moment[n] = -planck * slope;
    }
  }
  return out;
}

}  // namespace rabiline
