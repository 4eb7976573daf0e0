#include "spin/transition_table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace rabiline {
namespace {

/// Probabilities between connected levels at every point, while a table is made.
struct DenseTable {
  std::vector<std::pair<int, int>> pairs{};  // from, to
  double first = 0, step = 0;                // [s/m]
  int points = 0;
  std::vector<double> values{};  // [point][pair]
  double error = 0;

  std::ptrdiff_t row() const { return static_cast<std::ptrdiff_t>(pairs.size()); }
  const double* at(int point) const { return values.data() + point * row(); }
};

/// Lagrange's weights of the values at 0, 1, 2, 3.
std::array<double, 4> cubic_weights(double x) {
  return {-(x - 1) * (x - 2) * (x - 3) / 6, x * (x - 2) * (x - 3) / 2, -x * (x - 1) * (x - 3) / 2,
          x * (x - 1) * (x - 2) / 6};
}

void fill_point(const DrivenLevels& driven, DenseTable& table, int point, double slowness) {
  driven.put_probabilities(slowness, table.values.data() + point * table.row());
}

DenseTable empty_table(const DrivenLevels& driven, double from, double to, int points) {
  DenseTable table;
  table.pairs = driven.connected();
  table.first = from;
  table.step = points > 1 ? (to - from) / (points - 1) : 0;
  table.points = points;
  table.values.resize(static_cast<std::size_t>(points) * table.pairs.size());
  return table;
}

/// The largest difference between the table and the odd points of one twice as fine.
double largest_error(const DenseTable& table, const DenseTable& fine) {
  const std::ptrdiff_t size = table.row();
  double largest = 0;
  for (int k = 0; k + 1 < table.points; ++k) {
    const int start = std::clamp(k - 1, 0, table.points - 4);
    const std::array<double, 4> w = cubic_weights(k + 0.5 - start);
    const double *p = table.at(start), *exact = fine.at(2 * k + 1);
    for (std::ptrdiff_t n = 0; n < size; ++n) {
      const double between =
          w[0] * p[n] + w[1] * p[n + size] + w[2] * p[n + 2 * size] + w[3] * p[n + 3 * size];
      largest = std::max(largest, std::abs(between - exact[n]));
    }
  }
  return largest;
}

/// The largest error at a few places that no regular pattern hits: a fast oscillation that looks slow at the
/// points and midway between them shows here.
double error_at_odd_places(const DrivenLevels& driven, const DenseTable& table) {
  constexpr int places = 16;
  constexpr double golden = 0.6180339887498949;
  std::vector<double> exact(table.pairs.size());
  double largest = 0;
  for (int k = 1; k <= places; ++k) {
    const double share = k * golden - std::floor(k * golden);
    const double slowness = table.first + share * table.step * (table.points - 1);
    driven.put_probabilities(slowness, exact.data());
    const double x = share * (table.points - 1);
    const int start = std::clamp(static_cast<int>(x) - 1, 0, table.points - 4);
    const std::array<double, 4> w = cubic_weights(x - start);
    const double* p = table.at(start);
    for (std::ptrdiff_t n = 0; n < table.row(); ++n) {
      double between = 0;
      for (int i = 0; i < 4; ++i) between += w[i] * p[n + i * table.row()];
      largest = std::max(largest, std::abs(between - exact[n]));
    }
  }
  return largest;
}

DenseTable fill(const DrivenLevels& driven, double from, double to, double tolerance, int most_points) {
  if (!(to > from)) {
    DenseTable table = empty_table(driven, from, from, 1);
    fill_point(driven, table, 0, from);
    return table;
  }
  constexpr int least_points = 17, points_of_cycle = 8;
  const int most_at_first = std::max(least_points, (most_points + 1) / 2);
  const double wanted = std::min(points_of_cycle * driven.fastest() * (to - from), double{1 << 28});
  const int points = std::clamp(static_cast<int>(wanted), least_points, most_at_first);
  DenseTable table = empty_table(driven, from, to, points);
  for (int k = 0; k < points; ++k) fill_point(driven, table, k, from + k * table.step);

  for (double before = 0;;) {
    DenseTable fine = empty_table(driven, from, to, 2 * table.points - 1);
    const std::ptrdiff_t size = table.row();
    for (int k = 0; k < fine.points; ++k) {
      if (k % 2 == 0)
        std::copy_n(table.at(k / 2), size, fine.values.data() + k * size);
      else
        fill_point(driven, fine, k, from + k * fine.step);
    }
    // At an end of the table the largest error is 7 % above that at the midpoint. Where it has fallen as the
    // fourth power of the step, as far as a factor of 2, it does so once more.
    constexpr double aside = 1.1, fall = 8, few_places = 2;
    const double error = aside * largest_error(table, fine);
    fine.error = std::max(fall * error <= before ? error / fall : error,
                          few_places * error_at_odd_places(driven, fine));
    before = error;
    table = std::move(fine);
    if (table.error < tolerance || 2 * table.points - 1 > most_points) return table;
  }
}

/// What is less than half of 2^-40 in all of the table is nothing to a particle of 2^40 quanta.
TransitionTable without_zeros(const DenseTable& dense, int levels) {
  constexpr double nothing = 0x1p-41, rounding = 0x1p-24;
  std::vector<std::ptrdiff_t> kept;
  for (std::ptrdiff_t n = 0; n < dense.row(); ++n)
    for (int point = 0; point < dense.points; ++point)
      if (dense.at(point)[n] > nothing) {
        kept.push_back(n);
        break;
      }
  std::ranges::sort(kept, {}, [&](std::ptrdiff_t n) { return dense.pairs[n]; });
  TransitionTable table{levels, dense.first, dense.step, dense.points, {}, {}, {}, dense.error + rounding};
  table.begin.assign(static_cast<std::size_t>(levels) + 1, 0);
  for (const std::ptrdiff_t n : kept) {
    table.targets.push_back(dense.pairs[n].second);
    for (int from = dense.pairs[n].first; from < levels; ++from) ++table.begin[from + 1];
  }
  table.values.reserve(static_cast<std::size_t>(dense.points) * kept.size() + 8);
  for (int point = 0; point < dense.points; ++point)
    for (const std::ptrdiff_t n : kept) table.values.push_back(static_cast<float>(dense.at(point)[n]));
  table.values.resize(table.values.size() + 8, 0);
  return table;
}

}  // namespace

TransitionTable tabulate(const DrivenLevels& driven, double from, double to, double tolerance,
                         int most_points) {
  return without_zeros(fill(driven, from, to, tolerance, most_points), driven.levels());
}

}  // namespace rabiline
