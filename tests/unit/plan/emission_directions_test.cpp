// Every law of places, directions, spins and times as the plan hands it to the kernels, drawn and held
// against its distribution.
#include <set>

#include "constants.hpp"
#include "unit/plan/drawn.hpp"

namespace rabiline::emission_directions_test {
namespace {

using test::beam;
using test::Cdf;
using test::Drawn;
using test::emitted;
using test::expect_law;
using test::expect_mean;
using test::p_value;
using test::particles;
using test::pi;
using test::speed_of;
using test::two_pi;

// ---- places and directions ----

TEST(GaussianSpot, IsNormalAboutTheOffset) {
  Beamline b = beam(SingleSpeed{1000});
  b.source.opening = GaussianSpot{1e-3, 2e-3};
  b.source.offset = {5e-3, -1e-3};
  const Drawn drawn(b);
  expect_law(drawn([](const BatchView& v, int i) { return v.x[i]; }),
             [](double x, double s) { return gsl_cdf_gaussian_P(x - 5e-3, s * 1e-3); });
  expect_law(drawn([](const BatchView& v, int i) { return v.z[i]; }),
             [](double z, double s) { return gsl_cdf_gaussian_P(z + 1e-3, s * 2e-3); });
}

TEST(Emission, MovesEveryOpeningByTheOffset) {
  Beamline b = beam(SingleSpeed{1000});
  b.source.offset = {5e-3, 0};
  expect_law(Drawn(b)([](const BatchView& v, int i) { return v.x[i]; }),
             [](double x, double s) { return std::clamp((x - 5e-3) / (s * 1e-3) + 0.5, 0.0, 1.0); });
}

double cosine_of(const BatchView& b, int i) { return b.vy[i] / speed_of(b, i); }
double sine2_of(const BatchView& b, int i) {
  return (b.vx[i] * b.vx[i] + b.vz[i] * b.vz[i]) / std::pow(speed_of(b, i), 2);
}

TEST(CosineDirection, IsDrawnByLambertsLawUpToItsLimit) {
  expect_law(Drawn(beam(SingleSpeed{1000}, CosineDirection{}))(cosine_of),
             [](double c, double s) { return 1 - std::min(1.0, s * s * (1 - c * c)); });
  const double limit = std::pow(std::sin(0.4), 2);
  expect_law(Drawn(beam(SingleSpeed{1000}, CosineDirection{0.4}))(sine2_of),
             [&](double s2, double s) { return std::min(1.0, s2 / (s * limit)); });
}

TEST(BoxDirection, HasUniformSlopesOfEachHalfWidth) {
  const Drawn drawn(beam(SingleSpeed{1000}, BoxDirection{2e-3, 5e-3}));
  expect_law(drawn([](const BatchView& b, int i) { return b.vx[i] / b.vy[i]; }),
             [](double slope, double s) { return (slope / (s * 2e-3) + 1) / 2; });
  expect_law(drawn([](const BatchView& b, int i) { return b.vz[i] / b.vy[i]; }),
             [](double slope, double s) { return (slope / (s * 5e-3) + 1) / 2; });
  for (const double v : drawn(speed_of)) ASSERT_NEAR(v, 1000, 1e-9);
}

// A length that is off by 2 % changes the law so little that it takes millions to see.
TEST(ChannelDirection, IsDrawnByClausingsLaw) {
  constexpr double length = 2;
  const auto law = [](const ChannelFlow& f) {
    return Cdf([&](double theta) { return f.angular(std::tan(theta)) * std::sin(2 * theta); }, 0, pi / 2);
  };
  const Cdf right = law(ChannelFlow(length)), wrong = law(ChannelFlow(1.02 * length));
  const Drawn drawn(beam(SingleSpeed{1000}, ChannelDirection{length * 1e-3, 1e-3}));
  const std::vector<double> angles = emitted(
      drawn.emission,
      [](const BatchView& b, int i) { return std::atan2(std::hypot(b.vx[i], b.vz[i]), b.vy[i]); }, 8000000);
  EXPECT_GT(p_value(angles, [&](double a) { return right(a); }), 0.001);
  EXPECT_LT(p_value(angles, [&](double a) { return wrong(a); }), 0.001);
}

TEST(ChannelDirection, OfALongTubeIsDrawnByClausingsLaw) {
  const ChannelFlow flow(20);
  const Cdf cdf([&](double theta) { return flow.angular(std::tan(theta)) * std::sin(2 * theta); }, 0, pi / 2);
  EXPECT_GT(
      p_value(Drawn(beam(SingleSpeed{1000}, ChannelDirection{20e-3, 1e-3}))([](const BatchView& b, int i) {
                return std::atan2(std::hypot(b.vx[i], b.vz[i]), b.vy[i]);
              }),
              [&](double a) { return cdf(a); }),
      0.001);
}

TEST(ChannelShape, IsReadToAPartInAHundredThousand) {
  SampledTables tables;
  Beamline b = beam(SingleSpeed{1000}, AimedDirection{"screen", ChannelDirection{7e-3, 1e-3}});
  std::get<Detector>(b.parts.back().part) = {Rectangle{40.0, 40.0}, {1, 1}, {}};
  const ChannelFlow flow(7);
  Batch batch;
  batch.view().count = batch.view().padded = 512;
  kernel::emit(best_isa())(emission_of(b, b.species.front(), {1, 0}, tables), 0, batch.view());
  for (int i = 0; i < 512; ++i) {
    const double c = cosine_of(batch.view(), i);
    const double expected = std::pow(c, 4) * flow.angular(std::sqrt(1 - c * c) / c);
    ASSERT_NEAR(static_cast<double>(batch.view().weight[i]) / static_cast<double>(quanta_per_particle),
                expected, 1e-5 * expected + 1e-11);
  }
}

TEST(SourceTilt, TurnsTheAxisOfTheDirections) {
  Beamline b = beam(SingleSpeed{1000});
  b.source.tilt = {0.1, 0.2};
  Batch batch;
  batch.view().count = batch.view().padded = 8;
  kernel::emit(best_isa())(Drawn(b).emission, 0, batch.view());
  // +y about x by a: (0, cos a, sin a); then about z by b: (-sin b cos a, cos b cos a, sin a).
  EXPECT_NEAR(batch.view().vx[0], -1000 * std::sin(0.2) * std::cos(0.1), 1e-9);
  EXPECT_NEAR(batch.view().vy[0], 1000 * std::cos(0.2) * std::cos(0.1), 1e-9);
  EXPECT_NEAR(batch.view().vz[0], 1000 * std::sin(0.1), 1e-9);
}

TEST(SourceTilt, KeepsALawAboutItsNewAxis) {
  Beamline b = beam(SingleSpeed{1000}, ConeDirection{0.3});
  b.source.tilt = {0.1, -0.2};
  const double nx = std::sin(0.2) * std::cos(0.1), ny = std::cos(0.2) * std::cos(0.1), nz = std::sin(0.1);
  expect_law(Drawn(b)([&](const BatchView& v, int i) {
               return (v.vx[i] * nx + v.vy[i] * ny + v.vz[i] * nz) / speed_of(v, i);
             }),
             [](double c, double s) { return std::max(0.0, 1 - (1 - c) / (1 - std::cos(s * 0.3))); });
}

TEST(SourceTilt, WeighsAnAimedSourceByTheAngleToItsAxis) {
  Beamline b = beam(SingleSpeed{1000}, AimedDirection{"screen", CosineEmission{}});
  b.source.tilt = {0.5, 0};
  for (const double off : Drawn(b)([](const BatchView&v, int i) {
         const double along = (v.vy[i] * std::cos(0.5) + v.vz[i] * std::sin(0.5)) / speed_of(v, i);
         return static_cast<double>(v.weight[i]) / static_cast<double>(quanta_per_particle) -
                std::max(0.0, along) * std::pow(cosine_of(v, i), 3);
       }))
    ASSERT_NEAR(off, 0, 1e-11);
}

// ---- spins and times ----

TEST(PolarisedSpin, PointsAlongItsAxisInTheShareOfItsDegree) {
  Beamline b = beam(SingleSpeed{1000});
  b.law = ClassicalLaw{};
  b.source.spin = PolarisedSpin{{0.6, 0, 0.8}, 0.5};
  const std::vector<double> along =
      Drawn(b)([](const BatchView& v, int i) { return 0.6 * v.sx[i] + 0.8 * v.sz[i]; }, 400000);
  for (const double a : along) ASSERT_NEAR(std::abs(a), 1, 1e-12);
  expect_mean(along, 0.5);
}

TEST(PolarisedSpin, IsInTheOuterLevelsOfItsAxis) {
  Beamline b = beam(SingleSpeed{1000});
  b.species[0].species.spin = {3};
  b.source.spin = PolarisedSpin{{-1, 0, 0}, 0.5};
  const Drawn drawn(b);
  double top = 0;
  for (const double level : drawn([](const BatchView&v, int i) { return static_cast<double>(v.level[i]); })) {
    ASSERT_TRUE(level == 0 || level == 3);
    top += level == 0 ? 1 : 0;
  }
  // Levels are counted along +x.
  EXPECT_NEAR(top, 0.25 * particles, 4 * std::sqrt(particles * 0.1875));
  for (const double sx : drawn([](const BatchView&v, int i) { return v.sx[i]; })) ASSERT_NEAR(sx, 1, 1e-15);
}

TEST(PopulatedSpin, HasTheSameLevelsByEitherEndOfItsAxis) {
  Beamline up = beam(SingleSpeed{1000});
  up.species[0].species.spin = {2};
  up.source.spin = PopulatedSpin{{0.6, 0, 0.8}, {0.5, 0.3, 0.2}};
  Beamline down = up;
  down.source.spin = PopulatedSpin{{-0.6, 0, -0.8}, {0.2, 0.3, 0.5}};
  for (const auto column : {&BatchView::level, &BatchView::prepared}) {
    const auto of = [&](const BatchView& v, int i) { return static_cast<double>((v.*column)[i]); };
    EXPECT_EQ(Drawn(up)(of), Drawn(down)(of));
  }
}

TEST(PopulatedSpin, HasItsSharesInLevelsAndAsComponents) {
  Beamline b = beam(SingleSpeed{1000});
  b.species[0].species.spin = {3};
  b.source.spin = PopulatedSpin{{0, 0, 1}, {0.1, 0.2, 0.3, 0.4}};
  std::vector<double> counts(4, 0.0);
  for (const double level :
       Drawn(b)([](const BatchView&v, int i) { return static_cast<double>(v.level[i]); }))
    counts[static_cast<std::size_t>(level)] += 1;
  for (std::size_t k = 0; k < 4; ++k) {
    const double share = 0.1 * static_cast<double>(k + 1);
    EXPECT_NEAR(counts[k], share * particles, 4 * std::sqrt(particles * share * (1 - share)));
  }
  b.law = ClassicalLaw{};
  std::set<long> seen;
  for (const double sz : Drawn(b)([](const BatchView&v, int i) { return v.sz[i]; }))
    seen.insert(std::lround(3e6 * sz));
  EXPECT_EQ(seen, (std::set<long>{3000000, 1000000, -1000000, -3000000}));
  b.source.spin = PopulatedSpin{{0, 0, 1}, {0, 1, 0, 0}};
  expect_law(Drawn(b)([](const BatchView& v, int i) { return std::atan2(v.sy[i], v.sx[i]); }),
             [](double phi, double s) { return std::clamp(phi / (s * two_pi) + 0.5, 0.0, 1.0); });
}

TEST(Pulse, SpreadsTheStartingTimes) {
  const auto time = [](const BatchView& v, int i) { return v.t[i]; };
  Beamline b = beam(SingleSpeed{1000});
  b.source.pulse = RectanglePulse{10e-6};
  expect_law(Drawn(b)(time), [](double t, double s) { return std::min(1.0, t / (s * 10e-6)); });
  b.source.pulse = GaussianPulse{3e-6};
  expect_law(Drawn(b)(time), [](double t, double s) { return gsl_cdf_gaussian_P(t, s * 3e-6); });
}

TEST(Emission, OfEveryLawIsTheSameOnEveryInstructionSet) {
  Beamline b = beam(SupersonicSpeed{300, 5.0 / 3, 3}, ChannelDirection{5e-3, 1e-3});
  b.source.opening = GaussianSpot{1e-3, 1e-3};
  b.source.tilt = {0.1, 0.1};
  b.source.spin = PopulatedSpin{{0.6, 0, 0.8}, {0.5, 0.5}};
  b.source.pulse = GaussianPulse{1e-6};
  std::vector<Beamline> beams(6, b);
  beams[1].source.speed = MaxwellSpeed{300};
  beams[1].source.direction = CosineDirection{};
  beams[1].law = ClassicalLaw{};
  beams[2].source.speed = EffusiveSpeed{300};
  beams[2].source.direction = BoxDirection{0.1, 0.2};
  beams[3].source.speed = GaussianSpeed{{4e-10, Dimension::length}, {3e-10, Dimension::length}};
  beams[3].source.direction = AimedDirection{"screen", ChannelDirection{5e-3, 1e-3}};
  beams[4].source.speed = GaussianSpeed{{4e-21, Dimension::energy}, {3e-21, Dimension::energy}};
  beams[4].source.direction = AimedDirection{"screen", CosineEmission{}};
  beams[5].source.speed = LineSpeeds{{{500.0, 1}, {900.0, 2}}};
  for (const Beamline& each : beams) {
    const Drawn drawn(each);
    Batch reference, other;
    reference.view().count = reference.view().padded = 512;
    kernel::emit(Isa::baseline)(drawn.emission, 5000, reference.view());
    for (const Isa isa : {Isa::avx2, Isa::avx512}) {
      if (!supported(isa)) continue;
      other.view().count = other.view().padded = 512;
      kernel::emit(isa)(drawn.emission, 5000, other.view());
      const BatchView &r = reference.view(), &o = other.view();
      for (int i = 0; i < 512; ++i) {
        ASSERT_EQ(r.x[i], o.x[i]);
        ASSERT_EQ(r.vx[i], o.vx[i]);
        ASSERT_EQ(r.vy[i], o.vy[i]);
        ASSERT_EQ(r.vz[i], o.vz[i]);
        ASSERT_EQ(r.t[i], o.t[i]);
        ASSERT_EQ(r.sx[i], o.sx[i]);
        ASSERT_EQ(r.sy[i], o.sy[i]);
        ASSERT_EQ(r.weight[i], o.weight[i]);
        ASSERT_EQ(r.level[i], o.level[i]);
      }
    }
  }
}

}  // namespace
}  // namespace rabiline::emission_directions_test
