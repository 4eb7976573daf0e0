#include "models/bound_charge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "constants.hpp"
#include "core/constants.hpp"
#include "models/measure.hpp"
#include "physics/agreement.hpp"
#include "unit/models/findings.hpp"

namespace rabiline::bound_charge_test {
namespace {

using constants::two_pi;
using test::find;
using test::finding;

/// An electron in an orbit of 1 nm, with a field in which w/omega is about `ratio`.
BoundCharge electron(Binding binding, double ratio, double inclination, double orbits) {
  BoundCharge model;
  model.species = {{*find_species("electron"), 1}};
  model.binding = binding;
  model.inclination = inclination;
  model.orbits = orbits;
  model.samples = 101;
  const Species& s = model.species.front().species;
  double omega = 0;
  if (const auto* harmonic = std::get_if<HarmonicBinding>(&binding)) omega = two_pi * harmonic->frequency;
  if (const auto* coulomb = std::get_if<CoulombBinding>(&binding))
    omega = std::sqrt(8.9875517862e9 * coulomb->charge * test::elementary_charge / s.mass /
                      std::pow(coulomb->radius, 3));
  model.field = ratio * 2 * s.mass * omega / std::abs(s.charge);
  return model;
}
const HarmonicBinding spring{1e12, 1e-9};
const CoulombBinding nucleus{test::elementary_charge, 1e-9};

TEST(BoundCharge, ConservesEnergyAndCanonicalAngularMomentumAlongTheField) {
  for (const Binding& binding : {Binding(spring), Binding(nucleus)})
    for (const double ratio : {0.3, -0.01, 0.0}) {
      const ModelResult result = solve(electron(binding, ratio, 0.8, 40));
      EXPECT_LT(finding(result, "energy_drift").value, 2e-12);
      EXPECT_LT(finding(result, "canonical_drift").value, 2e-12);
    }
}

TEST(HarmonicallyBoundCharge, IsAnOscillatorInTheFrameThatTurnsWithHalfTheCyclotronRate) {
  // Weak, strong and stronger than the binding.
  for (const double ratio : {0.001, -0.2, 3.0}) {
    const ModelResult result = solve(electron(spring, ratio, 1.1, 30));
    EXPECT_LT(finding(result, "closed_form").value, 1e-9) << ratio;
  }
  // One place by hand, so that a constant off by 1 % shows: an orbit across the field, after 0.3 orbits.
  BoundCharge model = electron(spring, 0.2, 0, 0.3);
  const Vector3 end = solve(model).motions.at(0).position.back();
  const auto x = [&](double s) {
    const double w = s * 0.2, a = std::sqrt(1 + w * w), t = two_pi * 0.3;
    return std::cos(w * t) * std::cos(a * t) - std::sin(w * t) * (1 - w) / a * std::sin(a * t);
  };
  test::expect_agreement(end.x / 1e-9, x, 1e-8, "field");
}

TEST(BoundCharge, PrecessesWithHalfTheCyclotronRateToFirstOrder) {
  for (const Binding& binding : {Binding(spring), Binding(nucleus)})
    for (const double inclination : {0.4, 1.2, 2.5}) {
      const BoundCharge model = electron(binding, 1e-3, inclination, 100);
      const ModelResult result = solve(model);
      const Finding rate = finding(result, "precession");
      const Species& s = model.species.front().species;
      const double w = -s.charge * model.field / (2 * s.mass) / two_pi;
      EXPECT_GT(rate.value, 0);  // an electron turns right-handed about B
      // The third order in w/omega is left.
      test::expect_agreement(
          rate.value, [&](double scale) { return rate.expected + (scale - 1) * w; }, 3e-6 * w, "field");
      EXPECT_NEAR(rate.value / w, 1, 1e-3);
      EXPECT_NEAR(finding(result, "over_cyclotron").value, 0.5, 5e-4);
      EXPECT_NEAR(finding(result, "eq74_over_precession").value, 2, 2e-3);
      const Finding torque = finding(result, "mean_torque");
      EXPECT_NEAR(torque.value, torque.expected, 3e-5);
      EXPECT_NEAR(torque.expected, 0.5, 5e-3);
    }
}

TEST(BoundCharge, PrecessesBeyondThatInSecondOrderBySquareOfTheFieldTimesCosineOfTheInclination) {
  for (const Binding& binding : {Binding(spring), Binding(nucleus)})
    for (const double inclination : {0.5, 1.2, 2.4}) {
      const Finding small = finding(solve(electron(binding, 1e-3, inclination, 100)), "second_order");
      EXPECT_NEAR(small.value, small.expected, 0.01 * std::abs(small.expected)) << binding.index();
      const Finding large = finding(solve(electron(binding, 2e-3, inclination, 100)), "second_order");
      EXPECT_NEAR(large.value / small.value, 4, 0.05);
    }
}

TEST(BoundCharge, FollowsLarmorsTheoremToFirstOrderAndNotEquation74) {
  const auto distance = [](const ModelResult& result, std::size_t motion) {
    return length_of(result.motions.at(motion).position.back() - result.motions.at(0).position.back()) / 1e-9;
  };
  const ModelResult result = solve(electron(nucleus, 1e-3, 0.9, 20));
  EXPECT_EQ(result.motions.at(1).name, "larmor_theorem");
  EXPECT_EQ(result.motions.at(2).name, "eq74");
  EXPECT_LT(distance(result, 1), 1e-3);
  EXPECT_GT(distance(result, 2), 0.05);
  const ModelResult weaker = solve(electron(nucleus, 0.5e-3, 0.9, 20));
  EXPECT_NEAR(distance(result, 1) / distance(weaker, 1), 4, 0.1);
}

TEST(Equation74, TurnsTheAngularMomentumWithTheWholeCyclotronRate) {
  const BoundCharge model = electron(nucleus, 1e-3, 0.9, 20);
  const ModelResult result = solve(model);
  const Motion& eq74 = result.motions.at(2);
  const Species& s = model.species.front().species;
  const auto turn = [&](double scale) { return -scale * s.charge * model.field / s.mass * eq74.time.back(); };
  test::expect_agreement(angles_about({0, 0, 1}, eq74.vectors.at(1).values).back(), turn, 1e-10, "charge");
}

TEST(FreeCharge, TurnsWithTwiceLarmorsRate) {
  BoundCharge model = electron(NoBinding{1e5}, 0, 0.3, 5);
  model.field = -0.02;
  const ModelResult result = solve(model);
  EXPECT_EQ(result.motions.size(), 1U);
  const Species& s = model.species.front().species;
  const auto rate = [&](double scale) { return -scale * s.charge * -0.02 / s.mass / two_pi; };
  test::expect_agreement(finding(result, "turn").value, rate, 1e-8 * std::abs(rate(1)), "charge");
  EXPECT_NEAR(finding(result, "over_larmor").value, 2, 1e-10);
  EXPECT_LT(finding(result, "energy_drift").value, 1e-12);
  EXPECT_LT(finding(result, "canonical_drift").value, 1e-12);
}

TEST(BoundCharge, DoesNotPrecessWithoutAFieldOrAChargeOrAcrossTheField) {
  const ModelResult no_field = solve(electron(nucleus, 0, 0.7, 20));
  EXPECT_NEAR(finding(no_field, "precession").value / 2.5e12, 0, 1e-13);
  EXPECT_EQ(find(no_field, "mean_torque"), nullptr);

  BoundCharge neutral = electron(spring, 0.1, 0.7, 20);
  neutral.species = {{*find_species("neutron"), 1}};
  EXPECT_NEAR(finding(solve(neutral), "precession").value / 1e12, 0, 1e-13);

  for (const double inclination : {0.0, std::numbers::pi}) {
    const ModelResult across = solve(electron(nucleus, 0.01, inclination, 20));
    EXPECT_EQ(find(across, "precession"), nullptr);
    EXPECT_EQ(find(across, "mean_torque"), nullptr);
    for (const Vector3& l : across.motions.at(0).vectors.at(1).values) EXPECT_EQ(std::hypot(l.x, l.y), 0);
  }
  BoundCharge along = electron(NoBinding{1e5}, 0, std::numbers::pi / 2, 5);
  along.field = 0.1;
  EXPECT_LT(std::abs(solve(along).motions.at(0).position.back().x), 1e-15);
}

TEST(BoundCharge, NamesTheKeyToBlameForWhatHasNoMeaning) {
  const auto fault = [](const BoundCharge& model) {
    EXPECT_THROW(solve(model), std::invalid_argument);
    const std::vector<Fault> faults = faults_of(model);
    return faults.size() == 1 ? faults[0].key + ": " + faults[0].message : "nothing";
  };
  BoundCharge model = electron(nucleus, 0.01, 1, 10);
  EXPECT_TRUE(faults_of(model).empty());
  model.orbits = 1e6;
  EXPECT_EQ(fault(model), "orbits: it turns 1.02e+06 times, more than 100000 can be followed");
  model.species = {{*find_species("proton"), 1}};
  EXPECT_EQ(fault(model),
            "binding: the charges +1 e of `proton` and +1 e of the centre do not attract each other");
  model = electron(NoBinding{1e5}, 0, 1, 10);
  EXPECT_EQ(fault(model), "binding: a free charge turns in the field, and here nothing turns it");
  model.species.push_back(model.species.front());
  EXPECT_EQ(fault(model),
            "species: the model `bound_charge` has one particle, and here a mixture of species stands");
  model.species = {{*find_species("H atom"), 1}};
  EXPECT_EQ(fault(model), "species: `H atom` has levels, but this model needs a particle with one moment");
}

TEST(BoundCharge, TellsRatesBeforeItIsRun) {
  BoundCharge model = electron(spring, 0.01, 1, 10);
  model.species = {{*find_species("proton"), 1}};
  model.field = 1;
  std::string text;
  for (const Fact& fact : facts_of(model)) text += fact.name + " = " + fact.value + "; ";
  EXPECT_EQ(text,
            "orbit = 1 THz; v/c = 2.096e-05; larmor = -7.623 MHz; eq. 74 = -15.25 MHz; w/omega = 7.623e-06; "
            "eq. 75 = 2.79284734; ");
}

}  // namespace
}  // namespace rabiline::bound_charge_test
