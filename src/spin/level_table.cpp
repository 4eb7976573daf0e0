#include "spin/level_table.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numbers>

#include "core/eigensystem.hpp"
#include "core/portable_math.hpp"
#include "spin/angular_momentum.hpp"
#include "spin/hamiltonian.hpp"
#include "spin/level_labels.hpp"

namespace rabiline {
namespace {

constexpr double energy_error = 3e-14, coupling_error = 1e-10;
constexpr double driven_error = 3e-15;  // for phases between manifolds
constexpr int fewest_theta_cells = 64, most_theta_cells = 2048;
constexpr double half_pi = std::numbers::pi / 2;

/// F with their energies at B = 0, from the lowest on.
std::vector<std::pair<double, int>> zero_field_levels(const CoupledSpins& spins) {
  std::vector<std::pair<double, int>> out;
  for (int f = std::abs(spins.twice_i - spins.twice_j); f <= spins.twice_i + spins.twice_j; f += 2)
    out.emplace_back(zero_field_energy(spins, f), f);
  std::ranges::stable_sort(out, {}, &std::pair<double, int>::first);
  return out;
}
double spread_of(const CoupledSpins& spins) {
  const auto levels = zero_field_levels(spins);
  return levels.back().first - levels.front().first;
}

/// The states and energies with theta; columns are levels. Signs go on from one call to the next.
class StatesAlong {
 public:
  StatesAlong(const CoupledSpins& spins, double scale)
      : states(Eigen::MatrixXd::Zero(spins.levels(), spins.levels())),
        energy(Eigen::VectorXd::Zero(spins.levels())),
        spins_(spins),
        labels_(level_labels(spins)) {
    CoupledSpins free = spins;
    free.coupling = free.coupling_squared = free.offset = 0;
    zero_ = hamiltonian(spins, 0);
    zeeman_ = hamiltonian(free, 1) * scale;
    const auto order = zero_field_levels(spins);
    for (int twice_m = spins.twice_i + spins.twice_j; twice_m >= -spins.twice_i - spins.twice_j;
         twice_m -= 2) {
      Block block;
      for (int m_j = -spins.twice_j; m_j <= spins.twice_j; m_j += 2)
        if (std::abs(twice_m - m_j) <= spins.twice_i)
          block.products.push_back(spins.product_index(m_j, twice_m - m_j));
      for (const auto& [unused, f] : order)
        if (f >= std::abs(twice_m)) block.levels.push_back(*find_weak_field_level(labels_, f, twice_m));
      blocks_.push_back(block);
    }
    if (is_free())
      for (int level = 0; level < spins.levels(); ++level) {
        const LevelLabel& label = labels_[static_cast<std::size_t>(level)];
        states(spins.product_index(label.twice_m_j, label.twice_m_i), level) = 1;
      }
  }

  void go_to(double theta) {
    const double cosine = portable::cos(theta), sine = portable::sin(theta);
    const Eigen::MatrixXd h = cosine * zero_ + sine * zeeman_;
    slope = -sine * zero_ + cosine * zeeman_;
    if (is_free()) {
      energy = (states.transpose() * h * states).diagonal();
      return;
    }
    for (const Block& block : blocks_) {
      const auto own = eigensystem_of<Eigen::MatrixXd>(h(block.products, block.products));
      for (std::size_t k = 0; k < block.levels.size(); ++k) {
        Eigen::VectorXd state = own.vectors.col(static_cast<Eigen::Index>(k));
        const auto before = states(block.products, block.levels[k]);
        const double along = before.dot(state);
        if (along < 0 || (along == 0 && state(0) < 0)) state = -state;
        states(block.products, block.levels[k]) = state;
        energy(block.levels[k]) = own.values(static_cast<Eigen::Index>(k));
      }
    }
  }

  Eigen::MatrixXd states, slope;  // slope: dH/dtheta in products
  Eigen::VectorXd energy;

 private:
  struct Block {
    std::vector<int> products, levels;
  };
  bool is_free() const { return spins_.coupling == 0 && spins_.coupling_squared == 0; }

  const CoupledSpins& spins_;
  const std::vector<LevelLabel> labels_;
  Eigen::MatrixXd zero_, zeeman_;
  std::vector<Block> blocks_;
};

Eigen::MatrixXd lowering(const AngularMomentum& s) { return s.x - s.i_times_y; }
Eigen::MatrixXd along(const AngularMomentum& s) { return s.z; }
/// by_j J + by_i I in products, of one component.
template <typename Component>
Eigen::MatrixXd weighted(const CoupledSpins& spins, double by_j, double by_i, Component component) {
  const Eigen::MatrixXd one_i = Eigen::MatrixXd::Identity(spins.twice_i + 1, spins.twice_i + 1),
                        one_j = Eigen::MatrixXd::Identity(spins.twice_j + 1, spins.twice_j + 1);
  return by_j * kronecker(component(angular_momentum(spins.twice_j)), one_i) +
         by_i * kronecker(one_j, component(angular_momentum(spins.twice_i)));
}

/// [Hz] By level, the mean energy of its manifold at B = 0.
std::vector<double> means_at_zero(const CoupledSpins& spins, const std::vector<int>& manifold_of) {
  const std::vector<LevelLabel> labels = level_labels(spins);
  std::vector<double> sum(labels.size()), out;
  std::vector<int> levels(labels.size());
  for (std::size_t n = 0; n < labels.size(); ++n) {
    sum[static_cast<std::size_t>(manifold_of[n])] += zero_field_energy(spins, labels[n].twice_f);
    ++levels[static_cast<std::size_t>(manifold_of[n])];
  }
  for (const int manifold : manifold_of)
    out.push_back(sum[static_cast<std::size_t>(manifold)] / levels[static_cast<std::size_t>(manifold)]);
  return out;
}

}  // namespace

double scale_of(const CoupledSpins& spins) {
  const double spread = spread_of(spins),
               zeeman = std::max(std::abs(spins.zeeman_j - spins.zeeman_i),
                                 1e-3 * std::max(std::abs(spins.zeeman_j), std::abs(spins.zeeman_i)));
  return spread > 0 && zeeman > 0 ? spread / zeeman : 1e-4;
}

std::vector<int> manifolds_of(const CoupledSpins& spins, double apart) {
  const auto order = zero_field_levels(spins);
  std::vector<int> group(static_cast<std::size_t>(spins.twice_i + spins.twice_j + 1));
  int groups = 0;
  for (std::size_t k = 0; k < order.size(); ++k) {
    if (k > 0 && order[k].first - order[k - 1].first > apart) ++groups;
    group[static_cast<std::size_t>(order[k].second)] = groups;
  }
  std::vector<int> out;
  for (const LevelLabel& label : level_labels(spins))
    out.push_back(group[static_cast<std::size_t>(label.twice_f)]);
  return out;
}

LevelTable::LevelTable(const CoupledSpins& spins, std::vector<int> manifold_of, bool is_driven)
    : spins_(spins), scale_(scale_of(spins)), manifold_of_(manifold_of) {
  const std::vector<LevelLabel> labels = level_labels(spins);
  const std::size_t count = labels.size();
  const std::vector<int> exchanges = std::move(manifold_of);
  parted_ = std::ranges::max(exchanges) > 0;
  std::vector<double> taken_off;  // [Hz]
  if (is_driven) {
    taken_off = means_at_zero(spins, exchanges);
    std::ranges::fill(manifold_of_, 0);
  }
  place_of_.resize(count);
  manifolds_.resize(static_cast<std::size_t>(std::ranges::max(manifold_of_)) + 1);
  for (std::size_t n = 0; n < count; ++n) {
    Manifold& manifold = manifolds_[static_cast<std::size_t>(manifold_of_[n])];
    place_of_[n] = static_cast<int>(manifold.number.size());
    manifold.number.push_back(static_cast<int>(n));
    manifold.m.push_back(labels[n].twice_m / 2.0);
    if (is_driven) manifold.taken_off.push_back(2 * std::numbers::pi * taken_off[n]);
    const bool free = spins.coupling == 0 && spins.coupling_squared == 0;
    manifold.mirror.push_back(
        free ? *find_strong_field_level(labels, -labels[n].twice_m_j, -labels[n].twice_m_i)
             : *find_weak_field_level(labels, labels[n].twice_f, -labels[n].twice_m));
  }
  for (Manifold& manifold : manifolds_) {
    const int levels = static_cast<int>(manifold.number.size());
    const auto couple = [&](double by, std::vector<int>& lows, std::vector<int>& highs, bool all) {
      for (int from = 0; from < levels; ++from)
        for (int to = 0; to < levels; ++to) {
          const auto low = static_cast<std::size_t>(to), high = static_cast<std::size_t>(from);
          const bool moves = exchanges[static_cast<std::size_t>(manifold.number[low])] ==
                             exchanges[static_cast<std::size_t>(manifold.number[high])];
          if (manifold.m[low] != manifold.m[high] - by || (by == 0 && to <= from) || !(moves || all))
            continue;
          lows.push_back(to);
          highs.push_back(from);
        }
    };
    couple(1, manifold.to, manifold.from, false);
    manifold.ladders = static_cast<int>(manifold.to.size());
    couple(0, manifold.to, manifold.from, false);
    if (!is_driven) continue;
    couple(1, manifold.low, manifold.high, true);
    couple(0, manifold.low, manifold.high, true);
  }

  const Eigen::MatrixXd minus = weighted(spins, 1, 1, lowering),
                        drive_minus = weighted(spins, spins.zeeman_j, spins.zeeman_i, lowering),
                        drive_along = weighted(spins, spins.zeeman_j, spins.zeeman_i, along);
  const double moment = std::max(std::abs(spins.zeeman_j), std::abs(spins.zeeman_i));
  Eigen::VectorXd points(level_powers);
  for (int k = 0; k < level_powers; ++k) points(k) = -portable::cos((2 * k + 1) * half_pi / level_powers);
  Eigen::MatrixXd powers(level_powers, level_powers);
  for (int k = 0; k < level_powers; ++k)
    for (int p = 0; p < level_powers; ++p) powers(k, p) = p == 0 ? 1 : powers(k, p - 1) * points(k);
  const Eigen::MatrixXd solve = powers.inverse();
  // What a row has, at the states of the moment.
  const auto row_of = [&](const Manifold& manifold, const StatesAlong& at, double cosine) {
    const std::size_t levels = manifold.number.size();
    Eigen::VectorXd row = Eigen::VectorXd::Zero(static_cast<Eigen::Index>((manifold.numbers() + 7) / 8 * 8));
    double mean = 0;
    for (const int n : manifold.number) mean += at.energy(n) / static_cast<double>(levels);
    for (std::size_t k = 0; k < levels; ++k) {
      const double off = is_driven ? cosine * taken_off[static_cast<std::size_t>(manifold.number[k])] : mean;
      row(static_cast<Eigen::Index>(k)) = 2 * std::numbers::pi * (at.energy(manifold.number[k]) - off);
    }
    const auto between_states = [&](const Eigen::MatrixXd& by) -> Eigen::MatrixXd {
      return at.states.transpose() * by * at.states;
    };
    const Eigen::MatrixXd lowers = between_states(minus), stretches = between_states(at.slope);
    for (std::size_t c = 0; c < manifold.to.size(); ++c) {
      const int to = manifold.number[static_cast<std::size_t>(manifold.to[c])],
                from = manifold.number[static_cast<std::size_t>(manifold.from[c])];
      const bool ladder = static_cast<int>(c) < manifold.ladders;
      const double gap = at.energy(from) - at.energy(to);
      row(static_cast<Eigen::Index>(levels + c)) = ladder     ? lowers(to, from)
                                                   : gap != 0 ? stretches(to, from) / gap
                                                              : 0;
    }
    // What other manifolds shift these levels by, to second order.
    for (std::size_t k = 0; k < levels; ++k)
      for (int q = 0; q < spins.levels(); ++q) {
        const int n = manifold.number[k];
        const double gap = at.energy(n) - at.energy(q);
        if (exchanges[static_cast<std::size_t>(q)] == exchanges[static_cast<std::size_t>(n)] || gap == 0)
          continue;
        const double over = 1 / (2 * std::numbers::pi * gap),
                     turned = portable::hypot(lowers(q, n), lowers(n, q)), stretched = stretches(q, n) / gap;
        row(static_cast<Eigen::Index>(levels + manifold.to.size() + k)) += turned * turned / 4 * over;
        row(static_cast<Eigen::Index>(2 * levels + manifold.to.size() + k)) += stretched * stretched * over;
      }
    if (manifold.low.empty()) return row;
    const Eigen::MatrixXd driven_down = between_states(drive_minus),
                          driven_along = between_states(drive_along);
    for (std::size_t p = 0; p < manifold.low.size(); ++p) {
      const int low = manifold.number[static_cast<std::size_t>(manifold.low[p])],
                high = manifold.number[static_cast<std::size_t>(manifold.high[p])];
      const bool same_m =
          labels[static_cast<std::size_t>(low)].twice_m == labels[static_cast<std::size_t>(high)].twice_m;
      row(static_cast<Eigen::Index>(3 * levels + manifold.to.size() + p)) =
          (same_m ? driven_along : driven_down)(low, high) / moment;
    }
    for (std::size_t k = 0; k < levels; ++k)
      row(static_cast<Eigen::Index>(3 * levels + manifold.to.size() + manifold.low.size() + k)) =
          driven_along(manifold.number[k], manifold.number[k]) / moment;
    return row;
  };

  const double largest = 2 * std::numbers::pi *
                         (spread_of(spins) + scale_ * (std::abs(spins.zeeman_i) * spins.twice_i +
                                                       std::abs(spins.zeeman_j) * spins.twice_j));
  double worst = 2;
  for (cells_ = fewest_theta_cells / 2; worst > 1 && cells_ < most_theta_cells;) {
    cells_ *= 2;
    worst = 0;
    StatesAlong states(spins, scale_);
    Eigen::MatrixXd first_states;
    for (Manifold& manifold : manifolds_) manifold.rows.clear();
    for (int cell = 0; cell < cells_; ++cell) {
      const double width = 2 * half_pi / cells_, middle = -half_pi + (cell + 0.5) * width;
      std::vector<Eigen::MatrixXd> seen(manifolds_.size());
      std::vector<Eigen::VectorXd> between(manifolds_.size());
      for (int k = 0; k < level_powers; ++k) {
        if (k == level_powers / 2) {
          states.go_to(middle);
          for (std::size_t f = 0; f < manifolds_.size(); ++f)
            between[f] = row_of(manifolds_[f], states, portable::cos(middle));
        }
        const double theta = middle + points(k) * width / 2;
        states.go_to(theta);
        if (first_states.size() == 0) first_states = states.states;
        for (std::size_t f = 0; f < manifolds_.size(); ++f) {
          const Eigen::VectorXd row = row_of(manifolds_[f], states, portable::cos(theta));
          if (k == 0) seen[f].resize(level_powers, row.size());
          seen[f].row(k) = row.transpose();
        }
      }
      for (std::size_t f = 0; f < manifolds_.size(); ++f) {
        const Eigen::MatrixXd fitted = solve * seen[f];
        const auto levels = static_cast<Eigen::Index>(manifolds_[f].number.size());
        for (Eigen::Index i = 0; i < fitted.cols(); ++i) {
          const double off = std::abs(fitted(0, i) - between[f](i));
          worst =
              std::max(worst, i < levels ? off / ((is_driven ? driven_error : energy_error) * largest)
                                         : off / (coupling_error * std::max(1.0, std::abs(between[f](i)))));
        }
        for (Eigen::Index p = 0; p < level_powers; ++p)
          for (Eigen::Index i = 0; i < fitted.cols(); i += 8) {
            Eight& eight = manifolds_[f].rows.emplace_back();
            for (Eigen::Index k = 0; k < 8; ++k) eight.number[k] = fitted(p, i + k);
          }
      }
    }
    // Half a turn about the first axis takes the product of m_J, m_I to that of -m_J, -m_I.
    for (Manifold& f : manifolds_) {
      f.mirror_sign.clear();
      for (std::size_t k = 0; k < f.number.size(); ++k)
        f.mirror_sign.push_back(
            states.states.col(f.mirror[k]).reverse().dot(first_states.col(f.number[k])) < 0 ? -1 : 1);
    }
  }
  for (const Manifold& f : manifolds_) {
    LevelManifold view;
    view.levels = static_cast<int>(f.number.size());
    view.ladders = f.ladders;
    view.couplings = static_cast<int>(f.to.size());
    view.width = (static_cast<int>(f.numbers()) + 7) / 8 * 8;
    view.is_chain = view.couplings == view.levels - 1 && view.ladders == view.couplings;
    for (int k = 0; k < view.levels; ++k)
      view.most_of_one = std::max(
          view.most_of_one, static_cast<int>(std::ranges::count(f.to, k) + std::ranges::count(f.from, k)));
    view.number = f.number.data();
    view.mirror = f.mirror.data();
    view.m = f.m.data();
    view.to = f.to.data();
    view.from = f.from.data();
    view.rows = f.rows.front().number;
    view.cells = cells_;
    view.scale = scale_;
    view.pairs = static_cast<int>(f.low.size());
    view.low = f.low.data();
    view.high = f.high.data();
    view.moment = 2 * std::numbers::pi * moment;
    if (is_driven) view.taken_off = f.taken_off.data();
    view.mirror_sign = f.mirror_sign.data();
    views_.push_back(view);
  }
}

}  // namespace rabiline
