// Charges with spin under the laws of the beam: the ratio of radii that measurements decide upon.
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::test::charges_test {
namespace {

/// Half of the diameter of the half circle by which a charge of 1000 m/s leaves a wide field of 1 mT again
/// [m].
double radius(const Species& species, const Law& law) {
  Beamline b = suggested(1e6);
  b.law = law;
  b.species = {{species, 1}};
  b.chamber.reset();
  b.source.speed = SingleSpeed{1000};
  b.source.opening = Rectangle{0, 0};
  b.parts = {place("B", 0.1, UniformField{0.1, 1e-3, {}}),
             place("screen", 1.2, Detector{Rectangle{4e-3, 4e-3}, {1, 1}, {}})};
  const Track track = trace(b, 0, best_isa());
  EXPECT_EQ(track.fate, "left_backwards");
  return (track.x.back() - track.x.front()) / 2;
}

/// A proton with a g of its own.
Species proton_with(double g) {
  Species s = *find_species("proton");
  s.name = "own";
  s.gyromagnetic_ratio = gyromagnetic_ratio(GFactor{g}, s.charge, s.mass);
  return s;
}

TEST(RadiiOfAProton, HaveTheRatioOfHalfItsGFactor) {
  const Species proton = *find_species("proton");
  const double standard = radius(proton, ClassicalLaw{}),
               larmor = radius(proton, DoradoLaw{Closure::larmor, 1});
  const auto lorentz = [&](double s) { return proton.mass * 1000 / (s * proton.charge * 1e-3); };
  expect_agreement(standard, lorentz, 1e-8 * lorentz(1), "m v/(q B)");
  // g = 5.5856946893, CODATA 2022.
  const auto paper = [&](double s) {
    return 2 * proton.mass * 1000 / (s * 5.5856946893 * proton.charge * 1e-3);
  };
  expect_agreement(larmor, paper, 1e-8 * paper(1), "2 m v/(g q B), eq. 37");
  expect_agreement(
      standard / larmor, [](double s) { return s * 5.5856946893 / 2; }, 1e-8 * 2.8, "g/2");
  EXPECT_EQ(radius(proton, QuantumLaw{}), standard);
}

TEST(RadiiOfACharge, HaveTheRatioOfHalfAnyGFactorAndAreEqualForTwo) {
  for (const double g : {0.5, 2.0, 2.2, 7.0}) {
    const Species own = proton_with(g);
    const double ratio = radius(own, ClassicalLaw{}) / radius(own, DoradoLaw{Closure::larmor, 1});
    expect_agreement(
        ratio, [&](double s) { return s * g / 2; }, 1e-8 * g / 2, "g/2");
  }
}

TEST(RadiiOfACharge, TurnToTheOtherSideForANegativeGUnderLarmorAlone) {
  const Species own = proton_with(-3);
  const double standard = radius(own, ClassicalLaw{}), larmor = radius(own, DoradoLaw{Closure::larmor, 1});
  EXPECT_GT(standard, 0);
  expect_agreement(
      larmor / standard, [](double s) { return -2 / (3 * s); }, 1e-8, "g");
}

}  // namespace
}  // namespace rabiline::test::charges_test
