#include "field/field_map.hpp"

#include <gtest/gtest.h>

#include <complex>
#include <functional>
#include <random>

#include "checks.hpp"
#include "field/lane_maths.hpp"

namespace rabiline::test::field_map_test {
namespace {

using Field = std::function<Vector3(const Vector3&)>;

// A rectangle of current: two wires of 12 mm, 10 mm apart, and their ends; the box begins 5 mm beside it.
constexpr double wire_y = 0.006, wire_z = 0.005, nearest = 0.005, side = 0.016;
constexpr Vector3 corner{0.005, -0.008, -0.008};

template <class T>
std::array<T, 3> field_of_rectangle(const std::array<T, 3>& r) {
  const double y[] = {-wire_y, wire_y, wire_y, -wire_y, -wire_y},
               z[] = {-wire_z, -wire_z, wire_z, wire_z, -wire_z};
  std::array<T, 3> sum{};
  for (std::size_t s = 0; s < 4; ++s) {  // Biot and Savart along a straight piece
    const std::array<T, 3> a{r[0], r[1] - y[s], r[2] - z[s]}, b{r[0], r[1] - y[s + 1], r[2] - z[s + 1]};
    const T m = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    const T n = std::sqrt(b[0] * b[0] + b[1] * b[1] + b[2] * b[2]);
    const T f = 1e-3 * (m + n) / (m * n * (m * n + a[0] * b[0] + a[1] * b[1] + a[2] * b[2]));
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
      sum[i] += f * (a[j] * b[k] - a[k] * b[j]);
    }
  }
  return sum;
}
Vector3 rectangle(const Vector3& r) {
  const auto b = field_of_rectangle<double>({r.x, r.y, r.z});
  return {b[0], b[1], b[2]};
}
Here exact(const Vector3& r) {
  const double at[] = {r.x, r.y, r.z};
  Here out{};
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<std::complex<double>, 3> z;
    for (std::size_t i = 0; i < 3; ++i) z[i] = {at[i], i == k ? 1e-30 : 0};
    const auto b = field_of_rectangle(z);
    for (std::size_t i = 0; i < 3; ++i) {
      out.field[i] = b[i].real();
      out.slope[3 * i + k] = b[i].imag() * 1e30;
    }
  }
  return out;
}

MapNodes nodes_of(const Field& field, const Vector3& begin, const Vector3& step, std::array<int, 3> n) {
  MapNodes nodes;
  nodes.axes = {{n[0], begin.x, step.x}, {n[1], begin.y, step.y}, {n[2], begin.z, step.z}};
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j)
      for (int k = 0; k < n[2]; ++k) {
        const Vector3 b = field(begin + Vector3{i * step.x, j * step.y, k * step.z});
        nodes.field.insert(nodes.field.end(), {b.x, b.y, b.z});
      }
  return nodes;
}
FieldMap map_of_rectangle(int n) {
  const double h = side / (n - 1);
  return {nodes_of(rectangle, corner, {h, h, h}, {n, n, n}), {}, "map"};
}
ShapedTerm term_of(const FieldMap& map, MapOutside outside = MapOutside::zero) {
  return ShapedTerm(map.shape(1, outside));
}

struct Errors {
  double field = 0, slopes = 0, divergence = 0;  // rms, relative to |B| and |B|/d
};
template <class At>
Errors errors_of(At at) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> uniform;
  Errors sum;
  constexpr int n = 4000;
  for (int q = 0; q < n; ++q) {
    const Vector3 r =
        corner + Vector3{side * uniform(random), side * uniform(random), side * uniform(random)};
    const Here is = at(r), should = exact(r);
    const double size = std::hypot(should.field[0], should.field[1], should.field[2]), slope = size / nearest;
    for (int i = 0; i < 3; ++i) sum.field += std::pow((is.field[i] - should.field[i]) / size, 2) / n;
    for (int i = 0; i < 9; ++i) sum.slopes += std::pow((is.slope[i] - should.slope[i]) / slope, 2) / n;
    sum.divergence += std::pow(divergence(is) / slope, 2) / n;
  }
  return {std::sqrt(sum.field), std::sqrt(sum.slopes), std::sqrt(sum.divergence)};
}
Errors errors_of(int n) {
  const FieldMap map = map_of_rectangle(n);
  return errors_of([&](const Vector3& r) { return field_at(term_of(map), r); });
}
/// What a trilinear map of the same nodes has for a divergence.
Here trilinear(const Vector3& r, int n) {
  const double h = side / (n - 1);
  const double at[] = {(r.x - corner.x) / h, (r.y - corner.y) / h, (r.z - corner.z) / h};
  int cell[3];
  double t[3];
  for (int a = 0; a < 3; ++a) {
    cell[a] = std::min(static_cast<int>(at[a]), n - 2);
    t[a] = at[a] - cell[a];
  }
  Here out{};
  for (int corner_number = 0; corner_number < 8; ++corner_number) {
    double w[3], d[3];
    Vector3 node = corner;
    double* place[] = {&node.x, &node.y, &node.z};
    for (int a = 0; a < 3; ++a) {
      const int up = corner_number >> a & 1;
      w[a] = up ? t[a] : 1 - t[a];
      d[a] = (up ? 1 : -1) / h;
      *place[a] += h * (cell[a] + up);
    }
    const Vector3 b = rectangle(node);
    const double of[] = {b.x, b.y, b.z};
    for (int i = 0; i < 3; ++i) {
      out.field[i] += of[i] * w[0] * w[1] * w[2];
      out.slope[3 * i] += of[i] * d[0] * w[1] * w[2];
      out.slope[3 * i + 1] += of[i] * w[0] * d[1] * w[2];
      out.slope[3 * i + 2] += of[i] * w[0] * w[1] * d[2];
    }
  }
  return out;
}

TEST(FieldMap, ConvergesAsTheThirdPowerOfTheStepOrFaster) {
  const Errors coarse = errors_of(32), fine = errors_of(64);
  const double halving = std::log2(63.0 / 31);
  EXPECT_GT(std::log2(coarse.field / fine.field) / halving, 3.9);
  EXPECT_GT(std::log2(coarse.slopes / fine.slopes) / halving, 2.9);
  EXPECT_LT(fine.field, 6e-7);
  EXPECT_LT(fine.slopes, 4e-5);
}

TEST(FieldMap, HasAFiveHundredthOfTheDivergenceOfATrilinearMap) {
  const Errors plain = errors_of([](const Vector3& r) { return trilinear(r, 64); });
  EXPECT_GT(plain.divergence / errors_of(64).divergence, 500);
}

TEST(FieldMap, IsExactForCubicFieldsUpToItsFaces) {
  const Field cubic = [](const Vector3& r) {
    return Vector3{1 + r.x * r.x * r.x - r.y * r.z * r.z, r.x * r.y * r.z, r.z * r.z * r.z * r.y + 2 * r.x};
  };
  const FieldMap map(nodes_of(cubic, {-1, 0.5, 2}, {0.5, 0.25, 0.125}, {5, 4, 7}), {}, "map");
  for (const Vector3& r : {Vector3{-1, 0.5, 2}, {-0.7, 0.8, 2.3}, {1, 1.25, 2.75}, {0.99, 0.6, 2.01}}) {
    const Here f = field_at(term_of(map), r);
    const Vector3 b = cubic(r);
    EXPECT_NEAR(f.field[0], b.x, 1e-12);
    EXPECT_NEAR(f.field[1], b.y, 1e-12);
    EXPECT_NEAR(f.field[2], b.z, 1e-11);
    EXPECT_NEAR(f.slope[0], 3 * r.x * r.x, 1e-11);
    EXPECT_NEAR(f.slope[2], -2 * r.y * r.z, 1e-11);
    EXPECT_NEAR(f.slope[8], 3 * r.z * r.z * r.y, 1e-10);
  }
}

TEST(FieldMap, HasTheSlopesOfItsOwnField) {
  const FieldMap map = map_of_rectangle(16);
  const ShapedTerm term = turned_elsewhere(term_of(map));
  for (const Vector3& own : {Vector3{0.0071, 0.0013, -0.0022}, {0.013, -0.0061, 0.0055}})
    EXPECT_LT(slope_error(term, in_laboratory(term, own), 1e-7),
              1e-6 * largest(field_at(term, in_laboratory(term, own)).slope));
}

TEST(FieldMap, EndsAsItIsToldOutside) {
  const FieldMap map = map_of_rectangle(8);
  const Vector3 inside{0.005, 0.001, 0.002}, outside{0.004, 0.001, 0.002};
  EXPECT_EQ(field_at(term_of(map), outside).field[2], 0);
  EXPECT_EQ(field_at(term_of(map), outside).slope[2], 0);
  const Here held = field_at(term_of(map, MapOutside::clamp), outside);
  EXPECT_EQ(held.field[2], field_at(term_of(map), inside).field[2]);
  EXPECT_EQ(held.slope[6], 0);
  EXPECT_NE(held.slope[7], 0);
  const ShapedTerm wall = turned_elsewhere(term_of(map, MapOutside::error));
  const auto lost = [&](const Vector3& own) {
    const Vector3 r = in_laboratory(wall, own);
    return is_lost<HostMaths>(wall, r.x, r.y, r.z);
  };
  EXPECT_EQ(lost(inside + Vector3{1e-6, 0, 0}), 0);
  EXPECT_EQ(lost(outside), 1);
  EXPECT_EQ(is_lost<HostMaths>(term_of(map), outside.x, outside.y, outside.z), 0);
}

TEST(FieldMap, GoesOnBehindItsPlanesOfSymmetry) {
  // The rectangle mirrors into itself with its currents reversed at y = 0 and at z = 0.
  const double h = side / 15;
  const FieldMap whole(nodes_of(rectangle, {0.005, -15 * h, -15 * h}, {h, h, h}, {16, 31, 31}), {}, "whole");
  const std::array<MapSymmetry, 3> planes{MapSymmetry::none, MapSymmetry::opposite_currents,
                                          MapSymmetry::opposite_currents};
  const FieldMap quarter(nodes_of(rectangle, {0.005, 0, -15 * h}, {h, h, h}, {16, 16, 16}), planes,
                         "quarter");
  ASSERT_EQ(quarter.axes(), whole.axes());
  for (const Vector3& r : {Vector3{0.011, 0.003, 0.004}, {0.011, -0.003, 0.004}, {0.011, -0.003, -0.004}}) {
    const Here a = field_at(term_of(whole), r), b = field_at(term_of(quarter), r);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(a.field[i], b.field[i], 1e-14);
  }
}

TEST(FieldMap, AboutAnAxisGoesOnBehindItsMiddlePlane) {
  // Two rings: of one sense their currents mirror into themselves at z = 0.
  for (const double sense : {1.0, -1.0}) {
    ShapedTerm ring(LoopShape{0.05, 1e-3}), other(LoopShape{0.05, sense * 1e-3});
    ring.z = 0.03, other.z = -0.03;
    constexpr double h = 0.5e-3;
    const auto rings = [&](int first) {
      MapNodes nodes;
      nodes.axes = {{21, 0, h}, {41 - first, first * h, h}};
      for (int i = 0; i < 21; ++i)
        for (int k = first; k < 41; ++k) {
          const Here a = field_at(ring, {i * h, 0, k * h}), b = field_at(other, {i * h, 0, k * h});
          nodes.field.insert(nodes.field.end(), {a.field[0] + b.field[0], a.field[2] + b.field[2]});
        }
      return nodes;
    };
    const FieldMap whole(rings(-40), {}, "whole"),
        half(rings(0),
             {MapSymmetry::none, MapSymmetry::none,
              sense > 0 ? MapSymmetry::same_currents : MapSymmetry::opposite_currents},
             "half");
    ASSERT_EQ(half.axes(), whole.axes());
    const ShapedTerm a(whole.round_shape(1, MapOutside::zero)), b(half.round_shape(1, MapOutside::zero));
    for (const Vector3& r : {Vector3{0.003, 0.001, 0.011}, {0.003, 0.001, -0.011}, {0.001, 0, -0.0003}})
      for (int i = 0; i < 3; ++i)
        EXPECT_NEAR(field_at(a, r).field[i], field_at(b, r).field[i], 1e-14) << sense << i;
  }
}

TEST(FieldMap, OfChargesGoesOnBehindItsPlanes) {
  // E_z of a plate's image in the plane z = 0 is even where charges change sign, and odd where they do not.
  MapNodes nodes{{{4, 0, 1e-3}, {4, 0, 1e-3}, {4, 0, 1e-3}}, {}, true};
  for (int n = 0; n < 64; ++n) nodes.field.insert(nodes.field.end(), {0, 0, 5});
  const auto behind = [&](MapSymmetry z) {
    const FieldMap map(nodes, {MapSymmetry::none, MapSymmetry::none, z}, "plate");
    return field_at(ShapedTerm(map.shape(1, MapOutside::zero)), {1e-3, 1e-3, -2e-3}).field[2];
  };
  EXPECT_NEAR(behind(MapSymmetry::opposite_charges), 5, 1e-12);
  EXPECT_NEAR(behind(MapSymmetry::same_charges), -5, 1e-12);
}

TEST(FieldMap, AboutAnAxisIsTheFieldOfItsLoop) {
  const ShapedTerm loop(LoopShape{0.05, 1e-3});
  MapNodes nodes;
  constexpr int nr = 41, nz = 81;
  constexpr double h = 0.5e-3;
  nodes.axes = {{nr, 0, h}, {nz, -40 * h, h}};
  for (int i = 0; i < nr; ++i)
    for (int k = 0; k < nz; ++k) {
      const Here f = field_at(loop, {i * h, 0, (k - 40) * h});
      nodes.field.insert(nodes.field.end(), {f.field[0], f.field[2]});
    }
  const FieldMap map(std::move(nodes), {}, "round");
  ASSERT_TRUE(map.is_round());
  const ShapedTerm term(map.round_shape(1, MapOutside::zero));
  for (const Vector3& r :
       {Vector3{0, 0, 0.003}, {1e-9, 0, 0.003}, {0.004, 0.007, -0.011}, {0.0006, -0.0001, 0.0123}}) {
    const Here is = field_at(term, r), should = field_at(loop, r);
    for (int i = 0; i < 3; ++i) EXPECT_NEAR(is.field[i], should.field[i], 1e-10);
    for (int i = 0; i < 9; ++i) EXPECT_NEAR(is.slope[i], should.slope[i], 2e-6);  // of 0.01 T/m
    EXPECT_LT(std::abs(divergence(is)), 2e-6);
  }
}

TEST(FieldMap, IsTheSameToTheBitInLanes) {
  using namespace isa_baseline;
  const FieldMap map = map_of_rectangle(12);
  const ShapedTerm term = turned_elsewhere(term_of(map));
  const Vector3 places[] = {in_laboratory(term, {0.007, 0.001, 0.002}),
                            in_laboratory(term, {0.004, 0.001, 0.003})};
  real x, y, z;
  for (int p = 0; p < lane_count; ++p) {
    set_lane(x, p, places[p % 2].x);
    set_lane(y, p, places[p % 2].y);
    set_lane(z, p, places[p % 2].z);
  }
  FieldHere<real> many{};
  add_field<LaneMaths>(term, x, y, z, many);
  for (int p = 0; p < 2; ++p) {
    const Here one = field_at(term, places[p]);
    for (int i = 0; i < 3; ++i) EXPECT_EQ(lane(many.field[i], p), one.field[i]);
    for (int i = 0; i < 9; ++i) EXPECT_EQ(lane(many.slope[i], p), one.slope[i]);
  }
}

TEST(FieldMap, EstimatesItsErrorFromEverySecondNode) {
  const FieldMap map = map_of_rectangle(33);
  const MapQuality quality = quality_of(map);
  double squares = 0, largest_field = 0;
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> uniform;
  constexpr int n = 4000;
  for (int q = 0; q < n; ++q) {
    const Vector3 r =
        corner + Vector3{side * uniform(random), side * uniform(random), side * uniform(random)};
    const Here is = field_at(term_of(map), r), should = exact(r);
    for (int i = 0; i < 3; ++i) squares += std::pow(is.field[i] - should.field[i], 2) / n;
    largest_field = std::max(largest_field, std::hypot(should.field[0], should.field[1], should.field[2]));
  }
  ASSERT_TRUE(quality.halved);
  EXPECT_FALSE(quality.noisy);
  EXPECT_NEAR(quality.largest_field / largest_field, 1, 0.05);
  const double ratio = quality.error.rms / (std::sqrt(squares) / quality.largest_field);
  EXPECT_GT(ratio, 0.5);
  EXPECT_LT(ratio, 3);
  EXPECT_LT(quality.divergence.rms, 1e-5);
  EXPECT_LT(quality.curl.rms, 1e-5);
}

TEST(FieldMap, TellsNoiseAndWrongComponents) {
  std::mt19937_64 random(3);
  std::normal_distribution<double> noise(0, 1e-4);
  const double h = side / 32;
  const Field noisy = [&](const Vector3& r) {
    return rectangle(r) + Vector3{noise(random), noise(random), noise(random)};
  };
  const MapQuality with_noise =
      quality_of(FieldMap(nodes_of(noisy, corner, {h, h, h}, {33, 33, 33}), {}, "n"));
  EXPECT_TRUE(with_noise.noisy);
  EXPECT_NEAR(with_noise.error.rms * with_noise.largest_field / (1e-4 * std::sqrt(3)), 1.2, 0.6);
  const Field swapped = [](const Vector3& r) {
    const Vector3 b = rectangle(r);
    return Vector3{b.y, b.x, b.z};
  };
  const MapQuality wrong = quality_of(FieldMap(nodes_of(swapped, corner, {h, h, h}, {33, 33, 33}), {}, "s"));
  EXPECT_GT(wrong.divergence.rms + wrong.curl.rms, 1e-2);
}

TEST(MapAxis, IsEvenToAMillionthOfAStep) {
  std::string why;
  EXPECT_EQ(even_axis({0, 1e-3, 2e-3, 3e-3}, "x", why), (MapAxis{4, 0, 1e-3}));
  EXPECT_FALSE(even_axis({0, 1e-3, 2.001e-3, 3e-3}, "x", why));
  EXPECT_EQ(why, "the steps along x differ: from 1 mm to 2.001 mm it is 1.001 mm, elsewhere 1 mm");
  EXPECT_FALSE(even_axis({0, 2e-3, 1e-3, 3e-3}, "x", why));
  EXPECT_EQ(why, "the places along x do not ascend: 1 mm follows 2 mm");
}

}  // namespace
}  // namespace rabiline::test::field_map_test
