#include "models/charged_particle.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "models/measure.hpp"
#include "physics/agreement.hpp"
#include "unit/models/findings.hpp"

namespace rabiline::charged_particle_test {
namespace {

using constants::elementary_charge;
using constants::speed_of_light;
using constants::two_pi;
using test::find;
using test::finding;

ChargedParticle particle(std::string_view species, double field, ParticleSpeed speed, double turns) {
  ChargedParticle model;
  model.species = {{*find_species(species), 1}};
  model.field = field;
  model.speed = speed;
  model.pitch = model.spin_angle = std::numbers::pi / 2;
  model.time = ForTurns{turns};
  model.samples = 200;
  return model;
}
/// Drifts are rounding, all else is its closed form.
void expect_as_expected(const ModelResult& result) {
  for (const Finding& f : result.findings)
    EXPECT_NEAR(f.value, f.expected, f.name.ends_with("_drift") ? 1e-12 : 1e-8 * std::abs(f.expected))
        << f.name;
}
const Motion& motion(const ModelResult& result, std::string_view name) {
  for (const Motion& m : result.motions)
    if (m.name == name) return m;
  throw std::out_of_range("no such motion");
}
Vector3 last(const Motion& m, std::size_t vector) { return m.vectors.at(vector).values.back(); }

ChargedParticle generic() {
  ChargedParticle model = particle("proton", -0.7, StartSpeed{1.2e8}, 3.3);
  model.pitch = 1.1;
  model.spin_angle = 0.6;
  model.spin_azimuth = 2.2;
  return model;
}

TEST(ChargedParticle, ConservesWhatAFieldConservesAndTurnsAsTheClosedFormsSay) {
  const ModelResult result = solve(generic());
  expect_as_expected(result);
  EXPECT_GE(result.findings.size(), 14U);
}

TEST(ChargedParticle, KeepsSpeedAndSpinForHundredsOfTurns) {
  ChargedParticle model = generic();
  model.time = ForTurns{300};
  for (const Finding& f : solve(model).findings) {
    EXPECT_NEAR(f.value, f.expected, f.name.ends_with("_drift") ? 2e-12 : 1e-8 * std::abs(f.expected))
        << f.name;
  }
}

TEST(ChargedParticle, CirclesWithMomentumOverChargeAndField) {
  const ModelResult result = solve(particle("proton", 0.5, StartLorentzFactor{1.5}, 2));
  const Species proton = *find_species("proton");
  const auto radius = [&](double s) {
    return proton.mass * speed_of_light * std::sqrt(1.5 * 1.5 - 1) / (s * proton.charge * 0.5);
  };
  test::expect_agreement(finding(result, "standard_radius").value, radius, 1e-8 * radius(1), "charge");
  EXPECT_LT(finding(result, "standard_frequency").value, 0);  // a positive charge turns left-handed about B
}

TEST(ChargedParticle, UnderLarmorHasTheRadiusOfTheLorentzForceTimesTwoOverG) {
  // The proton of a cyclotron: g = 5.5857, CODATA 2022.
  const ModelResult result = solve(particle("proton", 1.0, StartSpeed{1e6}, 3));
  const double slow = 1 / std::sqrt(1 - std::pow(1e6 / speed_of_light, 2));
  test::expect_agreement(
      finding(result, "radius_ratio").value / slow, [](double s) { return s * 5.5856946893 / 2; }, 1e-8, "g");
  EXPECT_NEAR(finding(result, "standard_spin_turns").value, 2.79284734463, 2e-5);  // 1.8 (v/c)^2/2
  EXPECT_NEAR(finding(result, "larmor_spin_turns").value, 1, 1e-11);
}

TEST(ChargedParticle, MovesAlikeByLorentzForceAndLarmorWhereGIsTwo) {
  ChargedParticle model = particle("electron", 0.01, StartSpeed{1e4}, 3);
  Species& electron = model.species.front().species;
  electron.gyromagnetic_ratio = electron.charge / electron.mass;  // eqs. 38, 41
  const ModelResult result = solve(model);
  EXPECT_NEAR(finding(result, "radius_ratio").value, 1, 1e-8);
  EXPECT_NEAR(finding(result, "standard_spin_turns").value, 1, 1e-8);
  const Motion &standard = motion(result, "standard"), &larmor = motion(result, "larmor");
  const double radius = finding(result, "standard_radius").value;
  for (std::size_t i = 0; i < standard.time.size(); ++i)
    EXPECT_LT(length_of(standard.position[i] - larmor.position[i]), 1e-7 * radius);
  // The electron as it is: g/2 = 1.00116.
  const ModelResult real = solve(particle("electron", 0.01, StartSpeed{1e4}, 3));
  EXPECT_NEAR(finding(real, "radius_ratio").value, 1.00115965, 1e-8);
}

TEST(ChargedParticle, UnderTorqueFollowsItsClosedForm) {
  // v(t) = R_z(w t) R_S0(-w cos(theta) t) v0 with w = -gamma B.
  const ChargedParticle model = generic();
  const ModelResult result = solve(model);
  const Motion& torque = motion(result, "torque");
  const auto v = [&](double s) {
    const double angle =
        -s * model.species.front().species.gyromagnetic_ratio * model.field * torque.time.back();
    const Vector3 s0 = torque.vectors.at(1).values.front(), v0 = torque.vectors.at(0).values.front();
    return turned_about({0, 0, 1}, angle, turned_about(s0, -angle * s0.z, v0)).x / length_of(v0);
  };
  test::expect_agreement(last(torque, 0).x / length_of(last(torque, 0)), v, 1e-8, "gamma");
}

TEST(ChargedParticle, UnderTorqueFliesStraightWithTheSpinAlongTheFieldAndAsLarmorAcrossIt) {
  ChargedParticle model = generic();
  model.spin_angle = 0;
  const ModelResult along = solve(model);
  expect_as_expected(along);
  for (const Vector3& v : motion(along, "torque").vectors.at(0).values)
    EXPECT_EQ(v, motion(along, "torque").vectors.at(0).values.front());
  model.spin_angle = std::numbers::pi / 2;
  const ModelResult across = solve(model);
  EXPECT_LT(length_of(last(motion(across, "torque"), 0) - last(motion(across, "larmor"), 0)), 1e-10 * 1.2e8);
}

TEST(Anomaly, IsAQBOverMAtEveryEnergy) {
  const Species muon = *find_species("muon+");
  const double a = muon.gyromagnetic_ratio * muon.mass / muon.charge - 1;
  EXPECT_NEAR(a, 1.16592062e-3, 5e-8);  // CODATA 2022; moment and mass leave 3e-8
  for (const double lorentz : {1.001, 2.0, 29.3, 300.0}) {
    const ModelResult result = solve(particle("muon+", 1.4513, StartLorentzFactor{lorentz}, 4));
    const auto expected = [&](double s) { return s * a * muon.charge * 1.4513 / muon.mass / two_pi; };
    test::expect_agreement(finding(result, "anomalous_frequency").value, expected, 1e-8 * expected(1), "a");
    EXPECT_NEAR(expected(1), 229.1e3, 0.2e3);  // G. Bennett et al., Phys. Rev. D 73, 072003 (2006)
  }
}

TEST(Anomaly, IsNothingForGOfTwo) {
  ChargedParticle model = particle("muon-", 1.0, StartLorentzFactor{5}, 4);
  Species& s = model.species.front().species;
  s.gyromagnetic_ratio = s.charge / s.mass;
  const ModelResult result = solve(model);
  EXPECT_EQ(find(result, "anomalous_frequency"), nullptr);
  const std::vector<double>& angle = motion(result, "standard").numbers.at(2).values;
  EXPECT_LT(largest_change(angle), 1e-11);
}

TEST(SpinOfAChargedParticle, TurnsWithGammaBToFirstOrderInTheSpeed) {
  // The spin of standard physics makes 1 + gamma (g/2 - 1) turns of period 2 pi gamma m/(q B): compared with
  // gamma_gyro B that is (1/gamma + a)/(1 + a), 1 - (v/c)^2/(1 + a)/2 to second order.
  double before = 0;
  for (const double beta : {0.02, 0.01, 0.005}) {
    const ModelResult result = solve(particle("deuteron", 1.0, StartSpeed{beta * speed_of_light}, 3));
    const double rate =
        finding(result, "standard_spin_turns").value * finding(result, "standard_frequency").value;
    const double paper = finding(result, "larmor_frequency").value;
    const double difference = 1 - rate / paper;
    const double half_g = 0.8569875;  // 0.8574382 m_d/(2 m_p)
    EXPECT_NEAR(difference / (beta * beta), 0.5 / half_g, 2e-4);
    if (before != 0) {
      EXPECT_NEAR(before / difference, 4, 2e-3);
    }
    before = difference;
  }
}

TEST(ElectricField, AddsNothingToTheAnomalyAtTheMagicEnergy) {
  const Species muon = *find_species("muon+");
  const double a = muon.gyromagnetic_ratio * muon.mass / muon.charge - 1, magic = std::sqrt(1 + 1 / a);
  EXPECT_NEAR(magic, 29.3, 0.01);
  const auto share = [&](double lorentz) {
    ChargedParticle model = particle("muon+", 1.4513, StartLorentzFactor{lorentz}, 0.1);
    model.electric_field = 1e6;
    const ModelResult result = solve(model);
    return finding(result, "electric_share").value;
  };
  EXPECT_LT(std::abs(share(magic)), 1e-8 * std::abs(share(3)));
  EXPECT_GT(std::abs(share(1.01 * magic)), 1e-5 * std::abs(share(3)));
}

TEST(ElectricField, LeavesTheAngleOfTheSpinToTheMomentumAloneAtTheMagicEnergyAsItFlies) {
  const Species muon = *find_species("muon+");
  const double a = muon.gyromagnetic_ratio * muon.mass / muon.charge - 1, magic = std::sqrt(1 + 1 / a);
  // What E across v adds to the angle that the field alone turns, in a thousandth of a turn.
  const auto added = [](double lorentz) {
    double angle[2];
    for (const bool electric : {false, true}) {
      ChargedParticle model = particle("muon+", 1.4513, StartLorentzFactor{lorentz}, 1e-3);
      model.spin_azimuth = 1;
      model.electric_field = electric ? 1e6 : 0;
      angle[electric] = motion(solve(model), "standard").numbers.at(2).values.back();
    }
    return std::abs(angle[1] - angle[0]);
  };
  EXPECT_LT(added(magic), 1e-4 * added(3));
}

TEST(ElectricField, LetsAParticleFlyStraightThatTheMagneticFieldBendsBack) {
  // Wien's filter, E = -v x B: v along +y, B along +z, v x B along +x. The spin turns with gamma_gyro
  // B/gamma^2.
  const double beta = 0.6;
  ChargedParticle model = particle("proton", 0.2, StartSpeed{beta * speed_of_light}, 3);
  model.electric_field = -beta * speed_of_light * 0.2;
  const ModelResult result = solve(model);
  const Motion& standard = motion(result, "standard");
  for (const Vector3& r : standard.position) EXPECT_NEAR(r.x, 0, 1e-8);
  EXPECT_LT(finding(result, "standard_energy_drift").value, 1e-12);
  const double turn = angles_about({0, 0, 1}, standard.vectors.at(1).values).back();
  const double gamma = model.species.front().species.gyromagnetic_ratio;
  const auto expected = [&](double s) { return -s * gamma * 0.2 * (1 - beta * beta) * standard.time.back(); };
  test::expect_agreement(turn, expected, 1e-8 * std::abs(expected(1)), "gamma");
}

TEST(ElectricField, SpeedsAChargeUpAsRelativityHasIt) {
  // From v across E: p along E is q E t, and the energy follows.
  ChargedParticle model = particle("electron", 0, StartSpeed{1e8}, 1);
  model.time = ForDuration{2e-9};
  model.electric_field = 1e6;
  const ModelResult result = solve(model);
  const Species electron = *find_species("electron");
  const double lorentz = 1 / std::sqrt(1 - std::pow(1e8 / speed_of_light, 2));
  const auto v = [&](double s) {
    const double along = s * electron.charge * 1e6 * 2e-9, across = electron.mass * lorentz * 1e8;
    return along / std::hypot(electron.mass, along / speed_of_light, across / speed_of_light);
  };
  test::expect_agreement(last(motion(result, "standard"), 0).x, v, 1e-8 * std::abs(v(1)), "charge");
  EXPECT_LT(finding(result, "standard_energy_drift").value, 1e-11);
}

TEST(ChargedParticle, FliesStraightWithoutFieldsWithoutChargeAndAlongTheField) {
  ChargedParticle model = generic();
  model.field = 0;
  model.time = ForDuration{1e-6};
  const ModelResult nothing = solve(model);
  for (const Motion& m : nothing.motions)
    EXPECT_LT(length_of(m.position.back() - 1e-6 * m.vectors.at(0).values.front()), 1e-12 * 120) << m.name;
  expect_as_expected(nothing);

  model.field = 2;
  model.species = {{*find_species("neutron"), 1}};
  const ModelResult neutral = solve(model);
  const Motion& straight = motion(neutral, "standard");
  EXPECT_LT(length_of(straight.position.back() - 1e-6 * straight.vectors.at(0).values.front()), 1e-12 * 120);
  expect_as_expected(neutral);
  EXPECT_GT(std::abs(finding(neutral, "larmor_frequency").value), 1e6);

  for (const double pitch : {0.0, std::numbers::pi}) {
    ChargedParticle along = generic();
    along.pitch = pitch;
    const ModelResult result = solve(along);
    expect_as_expected(result);
    EXPECT_EQ(find(result, "standard_radius"), nullptr);
    for (const Vector3& r : motion(result, "larmor").position) EXPECT_EQ(r.x, 0);
  }
}

TEST(ChargedParticle, WritesAsManyTimesAsAskedForHoweverManyTurnsItMakes) {
  ChargedParticle model = generic();
  model.samples = 5;
  model.time = ForTurns{40};
  const ModelResult result = solve(model);
  EXPECT_EQ(motion(result, "standard").time.size(), 5U);
  EXPECT_EQ(motion(result, "torque").numbers.at(0).values.size(), 5U);
  EXPECT_EQ(motion(result, "standard").time.front(), 0);
  expect_as_expected(result);
}

TEST(ChargedParticle, NamesTheKeyToBlameForWhatHasNoMeaning) {
  const auto fault = [](const ChargedParticle& model) {
    EXPECT_THROW(solve(model), std::invalid_argument);
    const std::vector<Fault> faults = faults_of(model);
    return faults.size() == 1 ? faults[0].key + ": " + faults[0].message : "nothing";
  };
  EXPECT_TRUE(faults_of(generic()).empty());
  ChargedParticle model = generic();
  model.species.push_back(model.species.front());
  EXPECT_EQ(fault(model),
            "species: the model `charged_particle` has one particle, and here a mixture of species stands");
  model.species = {{*find_species("Cs-133 atom"), 1}};
  EXPECT_EQ(fault(model),
            "species: `Cs-133 atom` has levels, but this model needs a particle with one moment");
  model = generic();
  model.field = 0;
  EXPECT_EQ(fault(model),
            "turns: `turns` counts those of a charge in a magnetic field, and here nothing turns");
  model = generic();
  model.time = ForDuration{1};
  EXPECT_EQ(fault(model),
            "duration: spin or velocity turns 2.98e+07 times here, more than 100000 can be followed");
}

TEST(ChargedParticle, TellsRatesAndRadiiBeforeItIsRun) {
  std::string text;
  for (const Fact& fact : facts_of(particle("proton", 1, StartSpeed{1e6}, 1)))
    text += fact.name + " = " + fact.value + "; ";
  EXPECT_EQ(text,
            "v/c = 0.00333564; cyclotron = -15.25 MHz; larmor = -42.58 MHz; anomaly = 27.33 MHz; "
            "r standard = 10.44 mm; r larmor = 3.738 mm; g = 5.58569469; ");
}

}  // namespace
}  // namespace rabiline::charged_particle_test
