// One bit rule: a batch comes out of every kind of stage with the same bits, and leaves the same sums, on
// each instruction set and however its particles are divided into batches.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>

#include "unit/transport/readers.hpp"
#include "unit/transport/stage_samples.hpp"

namespace rabiline::same_bits_test {
namespace {

using test::StageSample;

constexpr RandomKey key{1938, 2};

/// Particles of 150 to 1000 m/s, a few mm and mm/m about the beam. Some have ended, some of these were caught
/// by part 3.
void fill(BatchView& v, int levels) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> even(-1, 1);
  for (int i = 0; i < Batch::capacity; ++i) {
    v.x[i] = 2e-3 * even(random);
    v.z[i] = 2e-3 * even(random);
    v.vx[i] = 3 * even(random);
    v.vy[i] = 575 + 425 * even(random);
    v.vz[i] = 3 * even(random);
    v.t[i] = 1e-3 * (1 + even(random));
    v.sz[i] = even(random);
    const double across = std::sqrt(1 - v.sz[i] * v.sz[i]), angle = 4 * even(random);
    v.sx[i] = across * std::cos(angle);
    v.sy[i] = across * std::sin(angle);
    v.slowness[i] = 1 / v.vy[i];
    v.level[i] = levels > 0 ? random() % static_cast<unsigned>(levels) : 0;
    v.prepared[i] = levels > 0 ? random() % static_cast<unsigned>(levels) : 0;
    v.weight[i] = i % 3 == 0 ? quanta_per_particle : random() % quanta_per_particle;
    v.particle[i] = static_cast<std::uint64_t>(5000 + 3 * i);
    v.flying[i] = i % 5 == 0 ? 0 : ~std::uint64_t{0};
    v.caught_by[i] = i % 10 == 0 ? 4 : i % 10 == 5 ? 2 : 0;
    v.scratch[i] = 0;
  }
}

void copy_rows(const BatchView& from, int first, BatchView& to, int at, int count) {
  for (const auto column : real_columns) std::copy_n(from.*column + first, count, to.*column + at);
  for (const auto column : word_columns) std::copy_n(from.*column + first, count, to.*column + at);
}

struct Passed {
  Batch batch;
  Sums sums;
};

/// The first `particles` pass in batches of `size`; sums add up.
Passed passed(const StageSample& sample, Isa isa, int size, int particles) {
  Batch start, here;
  fill(start.view(), sample.levels);
  Passed out{{}, Sums(sums_needed(sample.stage))};
  for (int first = 0; first < particles; first += size) {
    BatchView& v = here.view();
    v.count = std::min(size, particles - first);
    v.padded = (v.count + 7) / 8 * 8;
    v.y = test::start;
    copy_rows(start.view(), first, v, 0, v.count);
    copy_rows(start.view(), 0, v, v.count, v.padded - v.count);
    for (int i = v.count; i < v.padded; ++i) v.flying[i] = v.weight[i] = v.caught_by[i] = 0;
    StageContext context{isa, key, here, out.sums.data()};
    advance(sample.stage, context);
    copy_rows(v, 0, out.batch.view(), first, v.count);
    out.batch.view().y = v.y;
  }
  return out;
}

int different(const Passed& a, const Passed& b) {
  const BatchView &p = a.batch.view(), &q = b.batch.view();
  int count = p.y == q.y ? 0 : 1;
  for (const auto column : real_columns)
    for (int i = 0; i < Batch::capacity; ++i)
      count += std::bit_cast<std::uint64_t>((p.*column)[i]) != std::bit_cast<std::uint64_t>((q.*column)[i]);
  for (const auto column : word_columns)
    for (int i = 0; i < Batch::capacity; ++i) count += (p.*column)[i] != (q.*column)[i];
  for (std::size_t i = 0; i < a.sums.size(); ++i) count += a.sums[i] != b.sums[i];
  return count;
}

void expect_same(const StageSample& sample) {
  constexpr int all = Batch::capacity, few = 40;  // five registers of the widest, and many small batches
  const Passed reference = passed(sample, Isa::baseline, all, all);
  const Passed few_of_them = passed(sample, Isa::baseline, few, few);
  Passed untouched{{}, Sums(sums_needed(sample.stage))};
  fill(untouched.batch.view(), sample.levels);
  untouched.batch.view().y = test::start;
  EXPECT_GT(different(reference, untouched), 0) << sample.what << " does nothing";
  for (const auto column : real_columns)
    for (int i = 0; i < Batch::capacity; ++i)
      ASSERT_TRUE(std::isfinite((reference.batch.view().*column)[i])) << sample.what;
  for (const Isa isa : test::instruction_sets()) {
    for (const int size : {1, 2, 3, 4, 5, 6, 7, 8, 9, 11, 16, 31})
      EXPECT_EQ(different(few_of_them, passed(sample, isa, size, few)), 0)
          << sample.what << " on " << name_of(isa) << " in batches of " << size;
    for (const int size : {64, 100, 511, 512})
      EXPECT_EQ(different(reference, passed(sample, isa, size, all)), 0)
          << sample.what << " on " << name_of(isa) << " in batches of " << size;
  }
}

struct Kind {
  std::string name;
  std::vector<StageSample> (*samples)();
};
template <class... Kinds>
std::vector<Kind> kinds_of(std::type_identity<std::variant<Kinds...>>) {
  const auto name = [](std::string full) { return full.substr(full.rfind(':') + 1); };
  return {Kind{name(testing::internal::GetTypeName<Kinds>()), test::samples_of<Kinds>}...};
}

class StageBits : public testing::TestWithParam<Kind> {};
TEST_P(StageBits, AreTheSameOnEachInstructionSetInBatchesOfAnySize) {
  const std::vector<StageSample> samples = GetParam().samples();
  EXPECT_FALSE(samples.empty());
  for (const StageSample& sample : samples) expect_same(sample);
}
TEST_P(StageBits, SayWhereSpinsAreNoLongerUp) {
  for (const StageSample& sample : GetParam().samples()) {
    Batch batch;
    BatchView& v = batch.view();
    fill(v, sample.levels);
    v.count = v.padded = Batch::capacity;
    v.y = test::start;
    std::fill_n(v.sx, Batch::capacity, 0.0);
    std::fill_n(v.sy, Batch::capacity, 0.0);
    std::fill_n(v.sz, Batch::capacity, 1.0);
    v.up = true;
    Sums sums(sums_needed(sample.stage));
    StageContext context{best_isa(), key, batch, sums.data()};
    advance(sample.stage, context);
    for (int i = 0; i < Batch::capacity; ++i)
      ASSERT_TRUE(!v.up || (v.sx[i] == 0 && v.sy[i] == 0 && v.sz[i] == 1)) << sample.what;
  }
}
INSTANTIATE_TEST_SUITE_P(Of, StageBits, testing::ValuesIn(kinds_of(std::type_identity<Stage>())),
                         [](const auto& tested) { return tested.param.name; });

}  // namespace
}  // namespace rabiline::same_bits_test
