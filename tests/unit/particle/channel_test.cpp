#include "particle/channel.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace rabiline::channel_test {
namespace {

constexpr double pi = std::numbers::pi;

TEST(ChannelFlow, TransmitsWhatClausingsTableSays) {
  EXPECT_NEAR(ChannelFlow(2).transmission(), 0.51423, 0.5e-5);
  EXPECT_NEAR(ChannelFlow(20).transmission(), 0.10932, 0.5e-5);
  // What the same equation gives on a mesh several times as fine.
  EXPECT_NEAR(ChannelFlow(1).transmission(), 0.6719839, 2e-6);
  EXPECT_NEAR(ChannelFlow(10).transmission(), 0.1909422, 2e-6);
  EXPECT_GT(std::abs(ChannelFlow(2.02).transmission() - 0.51423), 1e-3);
}

TEST(ChannelFlow, OfAHoleWithoutLengthPassesAllAndOfALongTubeGoesAsEightThirdsOfROverL) {
  EXPECT_NEAR(ChannelFlow(1e-3).transmission(), 1 - 0.5e-3, 1e-6);
  EXPECT_NEAR(ChannelFlow(1000).transmission() / (8.0 / 3 / 1000), 1, 0.02);
}

TEST(ChannelFlow, HitsTheWallAsOftenHereAsItMissesItAtTheMirroredPlace) {
  const ChannelFlow flow(5);
  for (double x = 0; x <= 5; x += 0.37) EXPECT_NEAR(flow.wall_rate(x) + flow.wall_rate(5 - x), 1, 1e-9);
  EXPECT_GT(flow.wall_rate(0), flow.wall_rate(1));
}

TEST(ChannelFlow, SendsThroughAllAnglesWhatItTransmits) {
  for (const double length : {0.5, 2.0, 20.0}) {
    const ChannelFlow flow(length);
    double sum = 0;
    constexpr int steps = 20000;
    for (int i = 0; i < steps; ++i) {
      const double theta = (i + 0.5) / steps * pi / 2;
      sum += flow.angular(std::tan(theta)) * std::sin(2 * theta) * pi / 2 / steps;
    }
    EXPECT_NEAR(sum, flow.transmission(), 2e-6) << length;
    EXPECT_EQ(flow.angular(0), 1);
    EXPECT_LT(flow.angular(1e3), flow.angular(0.1));
  }
}

/// A molecule's way through a tube of radius 1 with walls that send it on by the cosine law: the sine squared
/// of its angle to the axis at the exit, or -1 where it comes back.
class Molecule {
 public:
  explicit Molecule(double length) : length_(length) {}

  template <class Random>
  double fly(Random& random) {
    const double r = std::sqrt(uniform(random)), phi = 2 * pi * uniform(random);
    x_ = 0, y_ = r * std::cos(phi), z_ = r * std::sin(phi);
    leave(1, 0, 0, random);
    while (true) {
      // To the wall: (y + s v)^2 + (z + s w)^2 = 1.
      const double a = v_ * v_ + w_ * w_, b = y_ * v_ + z_ * w_, c = y_ * y_ + z_ * z_ - 1;
      const double s = (-b + std::sqrt(std::max(0.0, b * b - a * c))) / a;
      x_ += s * u_, y_ += s * v_, z_ += s * w_;
      if (x_ > length_) return a;
      if (x_ < 0) return -1;
      const double radius = std::hypot(y_, z_);
      y_ /= radius, z_ /= radius;
      leave(0, -y_, -z_, random);
    }
  }

 private:
  template <class Random>
  static double uniform(Random& random) {
    return std::uniform_real_distribution<double>(0, 1)(random);
  }
  /// By the cosine law about the normal.
  template <class Random>
  void leave(double nx, double ny, double nz, Random& random) {
    const double sine = std::sqrt(uniform(random)), cosine = std::sqrt(1 - sine * sine),
                 phi = 2 * pi * uniform(random);
    // Across the normal: along the tube or y, and the product of both.
    const double ax = nx == 0 ? 1 : 0, ay = 1 - ax;
    const double bx = -nz * ay, by = nz * ax, bz = nx * ay - ny * ax;
    u_ = cosine * nx + sine * (std::cos(phi) * ax + std::sin(phi) * bx);
    v_ = cosine * ny + sine * (std::cos(phi) * ay + std::sin(phi) * by);
    w_ = cosine * nz + sine * std::sin(phi) * bz;
  }

  double length_, x_ = 0, y_ = 0, z_ = 0, u_ = 0, v_ = 0, w_ = 0;
};

TEST(ChannelFlow, AgreesWithMoleculesFollowedFromWallToWall) {
  constexpr double length = 2;
  constexpr int molecules = 400000, cells = 40;
  std::mt19937_64 random(1932);
  std::vector<double> counts(cells, 0.0);
  double passed = 0;
  Molecule molecule(length);
  for (int i = 0; i < molecules; ++i) {
    const double sine2 = molecule.fly(random);
    if (sine2 < 0) continue;
    passed += 1;
    counts[std::min<std::size_t>(cells - 1, static_cast<std::size_t>(cells * sine2))] += 1;
  }
  const ChannelFlow flow(length), other(1.02 * length);
  const double error = std::sqrt(molecules * 0.25);
  EXPECT_NEAR(passed, molecules * flow.transmission(), 4 * error);
  EXPECT_GT(std::abs(passed - molecules * other.transmission()), 4 * error);
  // The flux per sin^2(theta) is j(theta).
  double chi2 = 0;
  for (int i = 0; i < cells; ++i) {
    double expected = 0;
    for (int k = 0; k < 64; ++k) {
      const double sine2 = (i + (k + 0.5) / 64) / cells;
      expected += flow.angular(std::sqrt(sine2 / (1 - sine2))) / 64;
    }
    expected *= static_cast<double>(molecules) / cells;
    const double count = counts[static_cast<std::size_t>(i)];
    chi2 += (count - expected) * (count - expected) / expected;
  }
  EXPECT_LT(chi2, cells + 4 * std::sqrt(2.0 * cells));
}

}  // namespace
}  // namespace rabiline::channel_test
