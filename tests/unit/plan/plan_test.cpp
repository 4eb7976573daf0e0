#include "plan/plan.hpp"

#include <gtest/gtest.h>

#include "physics/suggested.hpp"
#include "plan/explain.hpp"
#include "rules/warnings.hpp"

namespace rabiline::plan_test {
namespace {

using test::place;
using test::suggested;

/// How many stages of each sort a chain has, as letters: D drift, P passage, A alignment, R region, S score,
/// E exit, L spins on levels, W steps in a magnet, M a monitor's count, H a tally, G gas, O a chopper, U a
/// velocity selector, X what a filter stops, N levels that a filter lets through.
std::string letters(const std::vector<Stage>& chain) {
  std::string text;
  for (const Stage& stage : chain) text += "DPACFXNVBWRSELMHGOU"[stage.index()];
  return text;
}
std::vector<Stage> chain_of(const Beamline& b) {
  SampledTables tables;
  return compile(b, b.species.front(), screen_grids({b}), tables);
}
/// What `check` tells: the plan in words and the warnings.
std::string told(const Experiment& e) {
  const Plan plan = make_plan(e);
  std::string text = explain(e, plan);
  for (const Fault& fault : warnings_of(e, plan)) text += "warning: " + fault.message + "\n";
  return text;
}
std::string compiled(const Beamline& b) { return letters(chain_of(b)); }

std::size_t nodes_of(const std::vector<PlanNode>& nodes) {
  std::size_t count = nodes.size();
  for (const PlanNode& node : nodes) count += nodes_of(node.next);
  return count;
}
Experiment scan(std::vector<Beamline> points) {
  Experiment e;
  e.points = std::move(points);
  return e;
}

TEST(Compile, GivesTheHypothesisARegionOnlyWhereFieldsCanTurnTheVelocity) {
  EXPECT_EQ(compiled(suggested(291e3)), "ADRPSEL");  // none for B': its spins stand along it
  Beamline larmor = suggested(291e3);
  larmor.law = DoradoLaw{Closure::larmor, 1};
  EXPECT_EQ(compiled(larmor), "ADRPDRPSEL");
}

TEST(Compile, FliesStraightUnderStandardLawsAndForKappaZero) {
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}, Law{DoradoLaw{Closure::larmor, 0}}}) {
    Beamline b = suggested(291e3);
    b.law = law;
    EXPECT_EQ(compiled(b), "ASEL");
  }
}

TEST(Compile, AsksForTheChamberWhereADivergentBeamMeetsSomething) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.source.direction = GaussianDirection{1e-3, 1e-3};
  EXPECT_EQ(compiled(b), "PAPSEL");
  b.chamber.reset();
  EXPECT_EQ(compiled(b), "ASEL");
}

TEST(Compile, CutsARegionAtSlitsAndScreensInsideIt) {
  Beamline b = suggested(291e3);
  b.parts.insert(b.parts.begin() + 3, place("S", 0.45, Slit{Disc{1e-3}, {}}));
  b.parts.insert(b.parts.begin() + 4, place("inner", 0.45, Detector{Rectangle{1e-3, 1e-3}, {2, 2}, {}}));
  const auto chain = chain_of(b);
  const auto& region = std::get<TurningRegion>(chain.at(2));
  ASSERT_EQ(region.zones.size(), 4U);  // 0.30-0.35, 0.35-0.45, a zone of no length, 0.45-0.55
  ASSERT_EQ(region.edges.size(), 3U);
  EXPECT_EQ(region.edges[0].kind, EdgeKind::open);
  EXPECT_EQ(region.edges[1].kind, EdgeKind::plate);
  EXPECT_EQ(region.edges[2].kind, EdgeKind::screen);
  EXPECT_EQ(region.zones[2].field.begin, region.zones[2].field.end);
}

TEST(MakePlan, SharesWhatAFrequencyScanHasInCommon) {
  std::vector<Beamline> points;
  for (int i = 0; i < 7; ++i) points.push_back(suggested(290e3 + i * 1e3));
  const Plan hypothesis = make_plan(scan(points));
  ASSERT_EQ(hypothesis.trees.size(), 1U);
  EXPECT_EQ(nodes_of(hypothesis.trees[0].next), 2 + 7 * 5U);
  for (Beamline& b : points) b.law = QuantumLaw{};
  EXPECT_EQ(nodes_of(make_plan(scan(points)).trees[0].next),
            3 + 1U);                            // only the spins differ: moments serve all
  for (Beamline& b : points) b.particles = 10;  // for whom moments are the longer way
  EXPECT_EQ(nodes_of(make_plan(scan(points)).trees[0].next), 3 + 7U);
}

TEST(MakePlan, SharesTheSourceAcrossLawsThatEmitAlike) {
  Beamline classical = suggested(291e3), hypothesis = classical;
  classical.law = ClassicalLaw{};
  const Plan plan = make_plan(scan({classical, hypothesis}));
  ASSERT_EQ(plan.trees.size(), 1U);
  EXPECT_EQ(plan.trees[0].next.size(), 1U);
  EXPECT_EQ(plan.trees[0].next[0].next.size(), 2U);
}

TEST(MakePlan, GivesEachSpeciesItsOwnTreeAndSharesOutEveryParticle) {
  Beamline b = suggested(291e3);
  Species heavy = test::neutron();
  heavy.name = "heavy";
  heavy.gyromagnetic_ratio *= 2;
  b.species = {{test::neutron(), 1.0 / 3}, {heavy, 2.0 / 3}};
  b.particles = 1000;
  const Plan plan = make_plan(scan({b}));
  ASSERT_EQ(plan.trees.size(), 2U);
  EXPECT_EQ(plan.trees[0].last, plan.trees[1].first);
  EXPECT_EQ(plan.trees[0].last, 333U);
  EXPECT_EQ(plan.trees[1].last, 1000U);
}

TEST(MakePlan, KeepsIndependentPointsApartAndLargeScansInSeveralTrees) {
  std::vector<Beamline> points(5, suggested(291e3));
  Experiment e = scan(points);
  e.particles = ScanParticles::independent;
  EXPECT_EQ(make_plan(e).trees.size(), 5U);
  points.clear();
  for (int i = 0; i < 40; ++i) points.push_back(suggested(290e3 + i));
  EXPECT_GT(make_plan(scan(points), 1, 5e-5).trees.size(), 5U);
}

TEST(MakePlan, SharesASourceThatIsScannedInsideOfAFrequency) {
  std::vector<Beamline> points;
  for (int outer = 0; outer < 3; ++outer)
    for (int inner = 0; inner < 40; ++inner) {
      Beamline b = suggested(290e3 + outer);
      b.source.speed = SingleSpeed{SpeedQuantity{900.0 + inner, Dimension::speed}};
      points.push_back(b);
    }
  Experiment e = scan(points);
  e.axes = {{"H0.frequency", Dimension::frequency, {0, 1, 2}, {}},
            {"source.speed.mean", Dimension::speed, std::vector<double>(40), {}}};
  const Plan plan = make_plan(e, 1, 1e9);
  ASSERT_EQ(plan.trees.size(), 40U);
  for (const PlanTree& tree : plan.trees) EXPECT_EQ(tree.points.size(), 3U);
}

/// A monitor with one tally inside the fields, of a run under the hypothesis.
Experiment with_planes(std::uint64_t planes) {
  Beamline b = suggested(291e3);
  b.law = DoradoLaw{Closure::larmor, 1};
  Monitor monitor{Disc{5e-3}, {}};
  Tally tally;
  tally.name = "speeds";
  tally.axes = {TallyAxis{Quantity::speed, AxisEnd{900}, AxisEnd{1100}, 49, {}}};
  monitor.tallies = {tally};
  monitor.length = planes > 1 ? 0.1 : 0;
  monitor.planes = planes;
  b.parts.insert(b.parts.begin() + 3, place("M", 0.4, monitor));
  return scan({b});
}

TEST(Plan, CountsEachPlaneOfAMonitorAsWorkAndAsMemory) {
  const Plan none = make_plan(scan({with_planes(1).points.front()})), many = make_plan(with_planes(101));
  EXPECT_GT(bytes_of_stages(none), 0U);
  EXPECT_EQ(bytes_of_stages(many), 101 * bytes_of_stages(none));
  // Two numbers for each tally and one for each plane.
  EXPECT_GT(many.trees.at(0).cost, none.trees.at(0).cost + 100 * 2e-8);
  const auto sums_in = [](const Experiment& e) {
    const std::string text = explain(e, make_plan(e));
    const std::size_t end = text.find(" KiB of sums");
    return std::stod(text.substr(text.rfind(' ', end - 1)));
  };
  EXPECT_NEAR(sums_in(with_planes(101)) / sums_in(with_planes(1)), 101, 0.1);
}

TEST(Explain, TellsTheNumbersThatAPhysicistWants) {
  const Experiment e = scan({suggested(291.6e3)});
  const std::string text = told(e);
  for (const char* expected : {"Larmor 291.6 kHz", "58.33 turns", "tip angle 0.63 deg", "1/T = 5 kHz",
                               "FWHM of the line 4.429 kHz", "200 us"})
    EXPECT_NE(text.find(expected), std::string::npos) << expected << "\n" << text;
}

TEST(Explain, WarnsWhereTheFieldGoesOnBehindTheDrive) {
  Beamline b = suggested(291.6e3);
  std::get<UniformField>(b.parts[1].part).length = 0.4;
  Experiment e = scan({b});
  EXPECT_NE(told(e).find("goes on to 0.7 m"), std::string::npos);
  b = suggested(291.6e3);
  b.parts.insert(b.parts.end() - 1, place("guide", 0.6, UniformField{0.2, 1e-3, {}}));
  e = scan({b});
  EXPECT_NE(told(e).find("goes on to 0.8 m"), std::string::npos);
}

TEST(Explain, WarnsOfALargeTipEvenWhereASlitCutsTheField) {
  for (const bool cut : {false, true}) {
    Beamline b = suggested(291.6e3, 2e-6);
    if (cut) b.parts.insert(b.parts.begin() + 3, place("S", 0.45, Slit{Disc{1e-3}, {}}));
    const Experiment e = scan({b});
    EXPECT_NE(told(e).find("4.2 deg, is large"), std::string::npos);
  }
  const Experiment e = scan({suggested(291.6e3)});
  EXPECT_EQ(told(e).find("warning"), std::string::npos);
}

TEST(Explain, WarnsUnderEveryLawOfSpeedsThatNeedRelativity) {
  for (const Law& law : {Law{QuantumLaw{}}, Law{ClassicalLaw{}}, Law{DoradoLaw{Closure::larmor, 1}}}) {
    Beamline slow = suggested(291.6e3), fast = slow;
    slow.law = fast.law = law;
    slow.source.speed = SingleSpeed{9.4e6};  // (v/c)^2 = 0.98e-3
    EXPECT_EQ(told(scan({slow})).find("relativity"), std::string::npos);
    fast.source.speed = SingleSpeed{1.2e7};
    const Experiment e = scan({slow, fast});
    EXPECT_NE(told(e).find(
                  "warning: neutron flies at 1.2e+07 m/s, (v/c)^2 = 0.0016: no law here knows relativity, so "
                  "that a charge's radius in a field is too small by 0.0008 of itself"),
              std::string::npos);
  }
}

TEST(Explain, SaysUnderTheHypothesisThatMagnetsSeparateNoLevels) {
  Beamline b = suggested(291.6e3);
  GradientMagnet magnet;
  magnet.length = 0.1;
  magnet.field = 0.1;
  magnet.gradient = 10;
  b.parts.insert(b.parts.end() - 1, place("A", 0.7, magnet));
  const Experiment hypothesis = scan({b});
  EXPECT_NE(told(hypothesis).find("under dorado no levels are separated by `A`: "), std::string::npos);
  b.law = QuantumLaw{};
  const Experiment standard = scan({b});
  EXPECT_EQ(told(standard).find("separated"), std::string::npos);
}

TEST(Explain, WarnsOfAFieldThatTurnsAgainstThePrecession) {
  Beamline b = suggested(291.6e3);
  std::get<UniformField>(b.parts[1].part).field = -10e-3;
  const Experiment e = scan({b});
  EXPECT_NE(told(e).find("against the precession"), std::string::npos);
}

TEST(Compile, StepsInAMagnetWhoseForceDependsOnThePlaceAndNotUnderTheHypothesis) {
  Beamline b = suggested(291e3);
  b.law = QuantumLaw{};
  b.chamber.reset();
  MultipoleMagnet sextupole;
  sextupole.length = 0.1;
  sextupole.pole_field = 1;
  sextupole.radius = 5e-3;
  b.parts.insert(b.parts.begin(), place("S", 0, sextupole));
  EXPECT_EQ(compiled(b).substr(0, 2), "DW");
  b.law = DoradoLaw{};
  EXPECT_EQ(compiled(b).find('W'), std::string::npos);
}

TEST(SampledTables, MakeTheMomentsOfOneStructureOnce) {
  SampledTables tables;
  const Structure h = *find_species("H atom")->structure, cs = *find_species("Cs-133 atom")->structure;
  const MomentTable& first = tables.moments(h);
  EXPECT_NE(&tables.moments(cs), &first);
  EXPECT_EQ(&tables.moments(h), &first);
}

}  // namespace
}  // namespace rabiline::plan_test
