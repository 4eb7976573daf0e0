#include "core/isa.hpp"

#include <gtest/gtest.h>

namespace rabiline::isa_test {
namespace {

TEST(InstructionSet, is_parsed_back_from_its_own_name) {
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) EXPECT_EQ(parse_isa(name_of(isa)), isa);
}

TEST(InstructionSet, of_another_name_is_not_accepted) {
  for (const char* name : {"", "AVX2", "avx", "avx512f", "best"}) EXPECT_FALSE(parse_isa(name)) << name;
}

TEST(InstructionSet, chosen_as_best_is_supported_and_the_baseline_always_is) {
  EXPECT_TRUE(supported(Isa::baseline));
  EXPECT_TRUE(supported(best_isa()));
}

TEST(InstructionSet, that_is_faster_implies_the_slower_ones) {
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512}) EXPECT_EQ(supported(isa), isa <= best_isa());
}

}  // namespace
}  // namespace rabiline::isa_test
