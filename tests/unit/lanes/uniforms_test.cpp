#include <Random123/philox.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <random>
#include <vector>

#include "lanes_kernels.hpp"

namespace rabiline::uniforms_test {
namespace {

double uniform_of(std::uint32_t high, std::uint32_t low) {
  const std::uint64_t x = std::uint64_t{high} << 32 | low;
  return (static_cast<double>(x >> 12) + 0.5) * 0x1p-52;
}

TEST(Uniforms, equal_those_of_Random123_bit_for_bit_on_every_instruction_set) {
  std::mt19937_64 generator(2024);
  const auto particle = std::make_unique<WordColumn>();
  Column u0, u1, coarse[4];
  r123::Philox4x32 philox;
  for (int trial = 0; trial < 50; ++trial) {
    const bool extreme = trial < 2;
    const std::uint64_t ones = trial == 0 ? 0 : ~std::uint64_t{0};
    const std::uint64_t seed = extreme ? ones : generator();
    const auto purpose = static_cast<unsigned>((extreme ? ones : generator()) & 0xFFFF);
    const auto draw = static_cast<unsigned>((extreme ? ones : generator()) & 0xFFFF);
    const auto stream = static_cast<unsigned>(extreme ? ones : generator());
    for (std::uint64_t& p : particle->value) p = extreme ? ones : generator() >> (trial % 60);
    for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
      if (!supported(isa)) continue;
      lanes_kernels_for(isa).uniforms(*particle, seed, purpose, draw, stream, u0, u1);
      lanes_kernels_for(isa).coarse_uniforms(*particle, seed, purpose, draw, stream, coarse);
      for (int i = 0; i < Column::length; ++i) {
        const std::uint64_t p = particle->value[i];
        const auto word =
            philox({{static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(p >> 32), purpose << 16 | draw,
                     stream}},
                   {{static_cast<std::uint32_t>(seed), static_cast<std::uint32_t>(seed >> 32)}});
        ASSERT_EQ(u0.value[i], uniform_of(word[0], word[1])) << name_of(isa);
        ASSERT_EQ(u1.value[i], uniform_of(word[2], word[3])) << name_of(isa);
        for (std::size_t k = 0; k < 4; ++k)
          ASSERT_EQ(coarse[k].value[i], (static_cast<double>(word[k]) + 0.5) * 0x1p-32) << name_of(isa);
      }
    }
  }
}

TEST(Uniforms, lie_strictly_between_zero_and_one_even_at_the_ends) {
  EXPECT_EQ(uniform_of(0, 0), 0x1p-53);
  EXPECT_EQ(uniform_of(~0U, ~0U), 1.0 - 0x1p-53);
}

TEST(Lanes, AreInterleavedAndPackedOnEveryInstructionSet) {
  std::mt19937_64 generator(7);
  const auto words = std::make_unique<WordColumn>(), even = std::make_unique<WordColumn>();
  const auto a = std::make_unique<Column>(), b = std::make_unique<Column>(), low = std::make_unique<Column>(),
             high = std::make_unique<Column>();
  std::vector<std::uint64_t> expected;
  for (int i = 0; i < Column::length; ++i) {
    words->value[i] = generator();
    a->value[i] = i;
    b->value[i] = -i;
    if (words->value[i] % 2 == 0) expected.push_back(words->value[i]);
  }
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) {
    if (!supported(isa)) continue;
    const LanesKernels& kernels = lanes_kernels_for(isa);
    ASSERT_EQ(kernels.pack_even(*words, *even), static_cast<int>(expected.size()));
    EXPECT_TRUE(std::equal(expected.begin(), expected.end(), even->value)) << name_of(isa);
    kernels.interleave(*a, *b, *low, *high);
    for (int i = 0; i < Column::length; ++i) {
      const int first = i - i % kernels.lane_count, at = i % kernels.lane_count;
      const int from = first + at / 2, later = first + (kernels.lane_count + at) / 2;
      ASSERT_EQ(low->value[i], at % 2 == 0 ? from : -from) << name_of(isa);
      ASSERT_EQ(high->value[i], at % 2 == 0 ? later : -later) << name_of(isa);
    }
  }
}

}  // namespace
}  // namespace rabiline::uniforms_test
