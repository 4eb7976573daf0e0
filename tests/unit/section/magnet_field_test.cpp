#include "section/magnet_field.hpp"

#include <gtest/gtest.h>

#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"

namespace rabiline::magnet_field_test {
namespace {

FieldHere<double> field_in(const MagnetTerm& magnet, double x, double z) {
  FieldHere<double> sum{};
  for (const ShapedTerm& term : field_terms_of(magnet, 0.5)) add_field<HostMaths>(term, x, 0.6, z, sum);
  return sum;
}
MagnetTerm magnet(MagnetKind kind) {
  MagnetTerm term;
  term.end = 0.7;
  term.shape.kind = kind;
  term.shape.field = 0.3;
  term.shape.gradient = 50;
  term.shape.along_x = 0.6;
  term.shape.along_z = 0.8;
  term.offset = {0.001, -0.002};
  term.tilt.y = 0.4;
  if (kind == MagnetKind::two_wire) {
    term.shape.half_distance = 0.005;
    term.shape.height = 0.006;
  }
  if (kind == MagnetKind::multipole) {
    term.shape.power = 2;
    term.shape.radius = 0.01;
  }
  return term;
}

TEST(MagnetField, HasTheSizeAndTheGradientOfItsMagnetInItsTurnedFrame) {
  for (const MagnetKind kind : {MagnetKind::two_wire, MagnetKind::multipole}) {
    const MagnetTerm term = magnet(kind);
    const double c = std::cos(0.4), s = std::sin(0.4), x = 0.003, z = 0.001;
    const double dx = x - 0.001, dz = z + 0.002;
    const auto expected = field_size(term.shape, c * dx - s * dz, term.shape.height + s * dx + c * dz,
                                     [](double q) { return std::sqrt(q); });
    const FieldHere<double> f = field_in(term, x, z);
    const double size = std::hypot(f.field[0], f.field[1], f.field[2]);
    EXPECT_NEAR(size / expected.size, 1, 1e-13);
    double gradient[3] = {};
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) gradient[k] += f.field[i] * f.slope[3 * i + k] / size;
    EXPECT_NEAR(gradient[0], c * expected.along_x + s * expected.along_z, 1e-11 * expected.size / 0.001);
    EXPECT_NEAR(gradient[2], c * expected.along_z - s * expected.along_x, 1e-11 * expected.size / 0.001);
    EXPECT_NEAR(f.slope[0] + f.slope[8], 0, 1e-12);
    EXPECT_NEAR(f.slope[2] - f.slope[6], 0, 1e-12);
  }
}

TEST(MagnetField, OfWiresPointsUpwardsAtTheBeamOfItsFrame) {
  MagnetTerm term = magnet(MagnetKind::two_wire);
  term.tilt = {};
  const FieldHere<double> f = field_in(term, 0.001, -0.002);
  EXPECT_NEAR(f.field[2], 0.3, 1e-15);
  EXPECT_NEAR(f.field[0], 0, 1e-15);
}

TEST(MagnetField, OfAnEvenGradientTakesTheOtherComponentWithIt) {
  MagnetTerm term = magnet(MagnetKind::gradient);
  term.offset = {};
  term.tilt = {};
  const FieldHere<double> f = field_in(term, 0.001, 0.002);
  EXPECT_NEAR(f.field[2], 0.3 + 50 * (0.6 * 0.001 + 0.8 * 0.002), 1e-15);
  EXPECT_EQ(f.slope[2], f.slope[6]);
  EXPECT_EQ(f.slope[0], -f.slope[8]);
}

}  // namespace
}  // namespace rabiline::magnet_field_test
