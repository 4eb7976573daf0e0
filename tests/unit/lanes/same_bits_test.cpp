// One bit rule: every function of core/lanes.hpp gives the same bits on all instruction sets.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <limits>
#include <memory>
#include <random>

#include "core/portable_math.hpp"
#include "lanes_kernels.hpp"

namespace rabiline::same_bits_test {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr double edges[] = {0.0,         -0.0,
                            1.0,         -1.0,
                            0.5,         -0.5,
                            1.5,         2.5,
                            1e-300,      1e300,
                            -1e300,      5e-324,
                            -5e-324,     0x1p-53,
                            0x1p52,      -0x1p51,
                            infinity,    1e9,
                            -infinity,   0x1p-1022,
                            0x1.fp-1023, 1.570796326794896619,
                            3.5,         -2.5};

/// A quarter each: any exponent, angles, (0, 1), small integers and halves; the edges first.
std::unique_ptr<Column> numbers(unsigned seed) {
  auto column = std::make_unique<Column>();
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> unit(0, 1), angle(-1e6, 1e6);
  std::uniform_int_distribution<int> small(-9, 9), exponent(-1074, 1023);
  for (int i = 0; i < Column::length; ++i) {
    double& x = column->value[i];
    switch (i % 4) {
      case 0:
        x = std::ldexp(2 * unit(generator) - 1, exponent(generator));
        break;
      case 1:
        x = angle(generator);
        break;
      case 2:
        x = unit(generator);
        break;
      default:
        x = small(generator) / 2.0;
        break;
    }
  }
  std::shuffle(column->value, column->value + Column::length, generator);
  for (std::size_t i = 0; i < std::size(edges); ++i)
    column->value[i] = edges[(i * (2 * seed + 1) + seed) % std::size(edges)];
  return column;
}

class SameBits : public testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!supported(GetParam())) GTEST_SKIP() << "this processor has no " << name_of(GetParam());
  }

  /// call(kernels, output, second output) on the baseline and on this instruction set. A NaN equals any NaN.
  template <class Call>
  void expect_same(const char* what, const Call& call) {
    const auto y0 = std::make_unique<Column>(), z0 = std::make_unique<Column>();
    const auto y1 = std::make_unique<Column>(), z1 = std::make_unique<Column>();
    call(lanes_kernels_for(Isa::baseline), *y0, *z0);
    call(lanes_kernels_for(GetParam()), *y1, *z1);
    int different = 0;
    const auto same = [](double p, double q) {
      return std::bit_cast<std::uint64_t>(p) == std::bit_cast<std::uint64_t>(q) ||
             (std::isnan(p) && std::isnan(q));
    };
    for (int i = 0; i < Column::length; ++i)
      different += !same(y0->value[i], y1->value[i]) || !same(z0->value[i], z1->value[i]);
    EXPECT_EQ(different, 0) << what;
  }
};

TEST_P(SameBits, come_from_every_function_of_one_number) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto x = numbers(seed);
    expect_same("sin_squared", [&](auto& k, Column& y, Column&) { k.sin_squared(*x, y); });
    expect_same("log", [&](auto& k, Column& y, Column&) { k.log(*x, y); });
    expect_same("exp", [&](auto& k, Column& y, Column&) { k.exp(*x, y); });
    expect_same("atan", [&](auto& k, Column& y, Column&) { k.atan(*x, y); });
    expect_same("sqrt", [&](auto& k, Column& y, Column&) { k.sqrt(*x, y); });
    expect_same("abs", [&](auto& k, Column& y, Column&) { k.abs(*x, y); });
    expect_same("round", [&](auto& k, Column& y, Column&) { k.round_to_nearest(*x, y); });
    expect_same("sincos", [&](auto& k, Column& s, Column& c) { k.sincos(*x, s, c); });
    expect_same("rotation", [&](auto& k, Column& S, Column& C) { k.rotation_coefficients(*x, S, C); });
  }
}

TEST_P(SameBits, come_from_every_function_of_several_numbers) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto a = numbers(seed), b = numbers(100 + seed), c = numbers(200 + seed);
    expect_same("fma", [&](auto& k, Column& y, Column& z) {
      k.fma(*a, *b, *c, y);
      k.fnma(*a, *b, *c, z);
    });
    expect_same("min, max", [&](auto& k, Column& y, Column& z) {
      k.min(*a, *b, y);
      k.max(*a, *b, z);
    });
    expect_same("select", [&](auto& k, Column& y, Column&) { k.choose(*a, *b, *c, 0, y); });
  }
}

TEST_P(SameBits, come_from_the_random_numbers) {
  const auto particle = std::make_unique<WordColumn>();
  std::mt19937_64 generator(3);
  for (std::uint64_t& p : particle->value) p = generator();
  expect_same("uniforms", [&](auto& k, Column& y, Column& z) {
    k.uniforms(*particle, 0x0123456789abcdefULL, 65535, 17, 4294967295U, y, z);
  });
}

TEST(PortableMath, HasTheBitsOfTheKernels) {
  const LanesKernels& kernels = lanes_kernels_for(Isa::baseline);
  Column sine, cosine, exponential, logarithm, arc;
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const auto x = numbers(seed);
    kernels.sincos(*x, sine, cosine);
    kernels.exp(*x, exponential);
    kernels.log(*x, logarithm);
    kernels.atan(*x, arc);
    for (int i = 0; i < Column::length; ++i) {
      const double at = x->value[i];
      if (std::abs(at) <= 1e9) {
        ASSERT_EQ(portable::sin(at), sine.value[i]) << at;
        ASSERT_EQ(portable::cos(at), cosine.value[i]) << at;
      }
      if (std::abs(at) <= 700) {
        ASSERT_EQ(portable::exp(at), exponential.value[i]) << at;
      }
      if (at >= std::numeric_limits<double>::min() && at < infinity) {
        ASSERT_EQ(portable::log(at), logarithm.value[i]) << at;
      }
      ASSERT_EQ(portable::atan(at), arc.value[i]) << at;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(on, SameBits, testing::Values(Isa::avx2, Isa::avx512),
                         [](const auto& tested) { return std::string(name_of(tested.param)); });

class Lanes : public testing::TestWithParam<Isa> {
 protected:
  void SetUp() override {
    if (!supported(GetParam())) GTEST_SKIP() << "this processor has no " << name_of(GetParam());
  }
  const LanesKernels& kernels() const { return lanes_kernels_for(GetParam()); }
};

TEST_P(Lanes, compute_what_the_scalar_operation_computes) {
  const auto a = numbers(5), b = numbers(6), c = numbers(7);
  Column fused, negated, root, absolute, smaller, larger;
  kernels().fma(*a, *b, *c, fused);
  kernels().fnma(*a, *b, *c, negated);
  kernels().sqrt(*a, root);
  kernels().abs(*a, absolute);
  kernels().min(*a, *b, smaller);
  kernels().max(*a, *b, larger);
  for (int i = 0; i < Column::length; ++i) {
    const double x = a->value[i], y = b->value[i], z = c->value[i];
    const double expected = std::fma(x, y, z);
    if (!std::isnan(expected)) {
      ASSERT_EQ(fused.value[i], expected);
    }
    if (const double difference = std::fma(-x, y, z); !std::isnan(difference)) {
      ASSERT_EQ(negated.value[i], difference);
    }
    if (x >= 0) {
      ASSERT_EQ(root.value[i], std::sqrt(x));
    }
    ASSERT_EQ(std::bit_cast<std::uint64_t>(absolute.value[i]), std::bit_cast<std::uint64_t>(std::fabs(x)));
    ASSERT_EQ(smaller.value[i], std::fmin(x, y));
    ASSERT_EQ(larger.value[i], std::fmax(x, y));
  }
}

TEST_P(Lanes, round_to_the_nearest_integer_and_halves_to_the_even_one) {
  const auto x = numbers(8);
  Column y;
  kernels().round_to_nearest(*x, y);
  for (int i = 0; i < Column::length; ++i)
    if (std::fabs(x->value[i]) < 0x1p51) {
      ASSERT_EQ(y.value[i], std::nearbyint(x->value[i]));
    }
}

TEST_P(Lanes, choose_by_mask_and_count_the_first_ones_only) {
  const auto a = numbers(9), b = numbers(10), c = numbers(11);
  for (int n = 0; n <= kernels().lane_count; ++n) {
    Column y;
    kernels().choose(*a, *b, *c, n, y);
    for (int i = 0; i < Column::length; ++i) {
      const double p = a->value[i], q = b->value[i];
      const double chosen = p < q && !(p < 0) ? c->value[i] : p + q;
      if (std::isnan(chosen)) continue;
      ASSERT_EQ(y.value[i], i % kernels().lane_count < n ? -chosen : chosen) << i << " of " << n;
    }
  }
}

TEST_P(Lanes, tell_whether_any_and_all_of_a_comparison_hold) {
  const int lanes = kernels().lane_count;
  for (int below = 0; below <= lanes; ++below) {
    Column x;
    for (int i = 0; i < Column::length; ++i) x.value[i] = i % lanes < below ? -1.0 : 1.0;
    int count = -1;
    bool any = false, all = false;
    kernels().count_below(x, 0.0, count, any, all);
    EXPECT_EQ(count, below * (Column::length / lanes));
    EXPECT_EQ(any, below > 0);
    EXPECT_EQ(all, below == lanes);
  }
}

INSTANTIATE_TEST_SUITE_P(on, Lanes, testing::Values(Isa::baseline, Isa::avx2, Isa::avx512),
                         [](const auto& tested) {
                           return tested.param == Isa::baseline ? std::string("baseline")
                                                                : std::string(name_of(tested.param));
                         });

}  // namespace
}  // namespace rabiline::same_bits_test
