#pragma once
// B on a regular grid: a cubic B-spline of each component, which gives the field and its slopes from one
// polynomial.
#include "field/field_here.hpp"

namespace rabiline {

enum class MapOutside { zero, error, clamp };

/// A view of a FieldMap's table. Its frame has the grid's axes.
struct MapShape {
  const double*
      table;     // coefficient of component m at node (i, j, k): ((i N_y + j) N_z + k) 4 + m, N = n + 2
  int nodes[3];  // n along each axis, at least 4
  double begin[3], scale[3];  // [m] first node, [1/m] one over the distance of nodes
  double factor;              // of all components
  MapOutside outside;
  bool operator==(const MapShape&) const = default;
};
/// The same of a field about an axis: B_r and B_z on nodes in r, from -R to R, and z.
struct RoundMapShape {
  const double* table;  // coefficient of B_r and B_z at node (i, k): (i N_z + k) 2 + m
  int nodes[2];         // along r and z
  double begin[2], scale[2];
  double factor;
  MapOutside outside;
  bool operator==(const RoundMapShape&) const = default;
};

/// The cell of a grid that a place is in, and the weights of the four nodes around it.
template <class Number>
struct SplineCell {
  Number first;                // number of the cell: of the first of the four coefficients
  Number weight[4], slope[4];  // of the value, and of its derivative by the place
  Number inside;               // 1 in the grid, else 0
};

/// Weights of a uniform cubic B-spline (C. de Boor, A Practical Guide to Splines) and their derivatives.
/// Beyond the grid: those of its edge, without slope.
template <class Maths, class Number>
[[gnu::always_inline]] inline SplineCell<Number> spline_cell(Number place, double begin, double scale,
                                                             int nodes) {
  const Number s = (place - begin) * scale, none = s - s, last = none + (nodes - 1.0);
  SplineCell<Number> cell;
  const auto below = s<none, above = s> last;
  const Number at = Maths::select(below, none, Maths::select(above, last, s));
  const Number floor = Maths::floor(at), most = none + (nodes - 2.0);
  cell.first = Maths::select(floor > most, most, floor);
  cell.inside = Maths::select(below, none, Maths::select(above, none, none + 1.0));
  const Number t = at - cell.first, u = 1.0 - t, steepness = scale * cell.inside;
  cell.weight[0] = u * u * u * (1.0 / 6);
  cell.weight[1] = t * t * (0.5 * t - 1.0) + 2.0 / 3;
  cell.weight[2] = u * u * (0.5 * u - 1.0) + 2.0 / 3;
  cell.weight[3] = t * t * t * (1.0 / 6);
  cell.slope[0] = steepness * (u * u * -0.5);
  cell.slope[1] = steepness * (t * (1.5 * t - 2.0));
  cell.slope[2] = steepness * (u * (2.0 - 1.5 * u));
  cell.slope[3] = steepness * (t * t * 0.5);
  return cell;
}

/// A few numbers at once, elementwise, wherever they stand in memory: as many as the processor has lanes,
/// since compilers take more apart through memory.
template <int width>
struct MapPiece {
  typedef double Numbers __attribute__((vector_size(8 * width)));
  typedef double InMemory __attribute__((vector_size(8 * width), aligned(8), may_alias));
};

/// Weights and cells are worked out for all lanes together, the sums then particle by particle along rows of
/// the table: four nodes along z with four numbers each, in pieces. Each number is summed up in the same
/// order whatever the pieces.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const MapShape& map, Number x, Number y, Number z) {
  constexpr int lanes = Maths::lanes;
  const Number none = x - x, place[3] = {x, y, z};
  alignas(64) double weight[3][4][lanes], slope[3][4][lanes], first[3][lanes], out[12][lanes];
  Number share = none + map.factor;
  for (int a = 0; a < 3; ++a) {
    const SplineCell<Number> cell = spline_cell<Maths>(place[a], map.begin[a], map.scale[a], map.nodes[a]);
    Maths::store(first[a], cell.first);
    for (int i = 0; i < 4; ++i) {
      Maths::store(weight[a][i], cell.weight[i]);
      Maths::store(slope[a][i], cell.slope[i]);
    }
    if (map.outside == MapOutside::zero) share = share * cell.inside;
  }
  const long row = 4L * (map.nodes[2] + 2), layer = row * (map.nodes[1] + 2);
  constexpr int width = lanes == 1 ? 2 : lanes;
  constexpr long half = 8 / width;  // pieces of two nodes
  using Piece = typename MapPiece<width>::Numbers;
  using PieceInMemory = typename MapPiece<width>::InMemory;
  for (int p = 0; p < lanes; ++p) {
    const double* corner = map.table + static_cast<long>(first[0][p]) * layer +
                           static_cast<long>(first[1][p]) * row + static_cast<long>(first[2][p]) * 4;
    Piece value[2 * half], by_x[2 * half], by_y[2 * half];
#pragma GCC unroll 8
    for (long q = 0; q < 2 * half; ++q) {
      Piece v{}, x_slope{}, y_slope{};
#pragma GCC unroll 4
      for (int i = 0; i < 4; ++i) {
        Piece sum{}, by{};
#pragma GCC unroll 4
        for (int j = 0; j < 4; ++j) {
          const Piece c = *reinterpret_cast<const PieceInMemory*>(corner + i * layer + j * row + q * width);
          sum += c * weight[1][j][p];
          by += c * slope[1][j][p];
        }
        v += sum * weight[0][i][p];
        x_slope += sum * slope[0][i][p];
        y_slope += by * weight[0][i][p];
      }
      value[q] = v;
      by_x[q] = x_slope;
      by_y[q] = y_slope;
    }
    const auto weighed = [&](const Piece& piece, const double(*w)[lanes], long q) {
      if constexpr (width < 8) {
        return piece * w[q * width / 4][p];
      } else {
        const double a = w[2 * q][p], b = w[2 * q + 1][p];
        return piece * Piece{a, a, a, a, b, b, b, b};
      }
    };
    alignas(64) double along[4][8];  // of B, and of its slopes: along even nodes, and along odd ones
#pragma GCC unroll 4
    for (long q = 0; q < half; ++q) {
      const auto store = [&](double* to, const Piece* of, const double(*w)[lanes]) {
        *reinterpret_cast<PieceInMemory*>(to + q * width) =
            weighed(of[q], w, q) + weighed(of[q + half], w, q + half);
      };
      store(along[0], value, weight[2]);
      store(along[1], by_x, weight[2]);
      store(along[2], by_y, weight[2]);
      store(along[3], value, slope[2]);
    }
#pragma GCC unroll 3
    for (int m = 0; m < 3; ++m) {
      out[m][p] = along[0][m] + along[0][4 + m];
#pragma GCC unroll 3
      for (int k = 0; k < 3; ++k) out[3 + 3 * m + k][p] = along[1 + k][m] + along[1 + k][4 + m];
    }
  }
  FieldHere<Number> here;
  for (int i = 0; i < 3; ++i) here.field[i] = share * Maths::load(out[i]);
  for (int i = 0; i < 9; ++i) here.slope[i] = share * Maths::load(out[3 + i]);
  return here;
}

/// B_x = x B_r/r, and so on; on the axis B_r/r is dB_r/dr.
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const RoundMapShape& map, Number x, Number y,
                                                         Number z) {
  const Number r = Maths::root(x * x + y * y), none = r - r;
  constexpr int lanes = Maths::lanes;
  const Number place[2] = {r, z};
  alignas(64) double weight[2][4][lanes], slope[2][4][lanes], first[2][lanes], sums[6][lanes];
  Number share = none + map.factor;
  for (int a = 0; a < 2; ++a) {
    const SplineCell<Number> cell = spline_cell<Maths>(place[a], map.begin[a], map.scale[a], map.nodes[a]);
    Maths::store(first[a], cell.first);
    for (int i = 0; i < 4; ++i) {
      Maths::store(weight[a][i], cell.weight[i]);
      Maths::store(slope[a][i], cell.slope[i]);
    }
    if (map.outside == MapOutside::zero) share = share * cell.inside;
  }
  const long row = 2L * (map.nodes[1] + 2);
  for (int p = 0; p < lanes; ++p) {
    const double* corner =
        map.table + static_cast<long>(first[0][p]) * row + static_cast<long>(first[1][p]) * 2;
    for (int m = 0; m < 2; ++m) {
      double b = 0, slope_r = 0, slope_z = 0;
      for (int i = 0; i < 4; ++i) {
        double sum = 0, along = 0;
        for (int k = 0; k < 4; ++k) {
          const double c = corner[i * row + 2L * k + m];
          sum += c * weight[1][k][p];
          along += c * slope[1][k][p];
        }
        b += sum * weight[0][i][p];
        slope_r += sum * slope[0][i][p];
        slope_z += along * weight[0][i][p];
      }
      sums[m][p] = b;
      sums[2 + m][p] = slope_r;
      sums[4 + m][p] = slope_z;
    }
  }
  Number field[2], by_r[2], by_z[2];
  for (int m = 0; m < 2; ++m) {
    field[m] = share * Maths::load(sums[m]);
    by_r[m] = share * Maths::load(sums[2 + m]);
    by_z[m] = share * Maths::load(sums[4 + m]);
  }
  const auto near = r < none + 1e-3 / map.scale[0];
  const Number per_r = 1.0 / Maths::select(near, none + 1.0, r);
  const Number c = Maths::select(near, none, x * per_r), s = Maths::select(near, none, y * per_r);
  const Number out = Maths::select(near, by_r[0], field[0] * per_r), bend = by_r[0] - out;
  FieldHere<Number> here;
  here.field[0] = x * out;
  here.field[1] = y * out;
  here.field[2] = field[1];
  here.slope[0] = out + c * c * bend;
  here.slope[1] = here.slope[3] = c * s * bend;
  here.slope[4] = out + s * s * bend;
  here.slope[2] = c * by_z[0];
  here.slope[5] = s * by_z[0];
  here.slope[6] = c * by_r[1];
  here.slope[7] = s * by_r[1];
  here.slope[8] = by_z[1];
  return here;
}

}  // namespace rabiline
