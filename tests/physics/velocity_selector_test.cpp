// A velocity selector: a triangle in the wavelength, its width at half maximum, its nominal value.
#include <gtest/gtest.h>

#include <cmath>

#include "core/constants.hpp"
#include "physics/agreement.hpp"
#include "physics/suggested.hpp"

namespace rabiline::test::velocity_selector_test {
namespace {

constexpr double nominal = 600, resolution = 0.12, peak = 0.8;

VelocitySelector selector(const SpeedQuantity& speed = nominal) { return {speed, resolution, peak}; }
double detected(const VelocitySelector& part, const SpeedLaw& speed, std::uint64_t particles = 64) {
  Beamline b = suggested(0);
  b.law = ClassicalLaw{};
  b.source.speed = speed;
  b.chamber.reset();
  b.particles = particles;
  b.parts = {place("selector", 0.5, part), place("screen", 1.2, Detector{Rectangle{4, 4}, {1, 1}, {}})};
  return run_points({b}).detectors.at(0).detected.at(0);
}

TEST(VelocitySelector, PassesATriangleInTheWavelength) {
  for (const double longer : {-0.1, -0.03, 0.0, 0.07, 0.11})  // than the nominal wavelength, relative
    expect_agreement(
        detected(selector(), SingleSpeed{nominal / (1 + longer)}),
        [&](double scale) { return scale * peak * (1 - std::abs(longer) / resolution); }, 1e-11,
        "transmission");
  for (const double longer : {-0.13, 0.13})
    EXPECT_EQ(detected(selector(), SingleSpeed{nominal / (1 + longer)}), 0);
}

TEST(VelocitySelector, HasItsResolutionAtHalfMaximum) {
  expect_agreement(
      detected(selector(), SingleSpeed{nominal / (1 + resolution / 2)}) / peak,
      [](double scale) { return 1 - scale / 2; }, 1e-11, "resolution");
}

TEST(VelocitySelector, TakesItsNominalSpeedAsAWavelength) {
  const double wavelength = constants::planck / (neutron().mass * nominal);
  EXPECT_NEAR(detected(selector({wavelength, Dimension::length}), SingleSpeed{nominal}), peak, 1e-11);
}

}  // namespace
}  // namespace rabiline::test::velocity_selector_test
