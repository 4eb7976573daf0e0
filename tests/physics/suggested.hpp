#pragma once
// The suggested experiment as a beamline built in code, and small helpers to run it.
#include <string>

#include "constants.hpp"
#include "plan/plan.hpp"
#include "simulation/field_check.hpp"
#include "simulation/finish.hpp"
#include "simulation/run.hpp"

namespace rabiline::test {

inline Species neutron() { return {"neutron", neutron_mass, 0, {1}, gamma_n, "CODATA 2022"}; }

inline PlacedPart place(const std::string& name, double at, Part part) {
  return {{name, at, {}}, std::move(part)};
}

inline GradientMagnet magnet(double length, double gradient, decltype(GradientMagnet::gap) gap = {}) {
  GradientMagnet part;
  part.length = length;
  part.field = 1;
  part.gradient = gradient;
  part.gap = gap;
  return part;
}

/// An axis of a tally.
inline TallyAxis axis(Quantity quantity, double from, double to, std::uint64_t bins) {
  return {quantity, AxisEnd{from}, AxisEnd{to}, bins, {}};
}

/// B' 0.10-0.20 m, B 0.30-0.55 m, H0 0.35-0.55 m, a screen of 4 x 4 mm at 1.2 m, neutrons of 1000 m/s.
inline Beamline suggested(double frequency, double amplitude = 0.3e-6) {
  Beamline b;
  b.title = "suggested";
  b.species = {{neutron(), 1}};
  b.law = DoradoLaw{};
  b.source = {GaussianSpeed{1000, 10}, Rectangle{0.2e-3, 1e-3}, ParallelDirection{}};
  b.chamber = Chamber{0.05};
  RotatingField h0;
  h0.length = 0.2;
  h0.amplitude = amplitude;
  h0.frequency = frequency;
  h0.sense = Sense::co;
  h0.phase = {Phase::Kind::random, 0};
  b.parts = {place("B_prime", 0.10, Polarizer{0.10, 10e-3, 1, {}}),
             place("B", 0.30, UniformField{0.25, 10e-3, {}}), place("H0", 0.35, h0),
             place("screen", 1.2, Detector{Rectangle{4e-3, 4e-3}, {80, 80}, {}})};
  b.particles = 10000;
  b.seed = 1938;
  return b;
}

inline Result run_points(std::vector<Beamline> points, RunOptions options = {}) {
  Experiment e;
  e.points = std::move(points);
  if (options.isa == Isa::baseline) options.isa = best_isa();
  const Plan plan = make_plan(e);
  return finish(e, plan, run(plan, options).sums);
}

/// What the field check of a run finds.
inline std::optional<FieldCheck> check_of(const Beamline& b) {
  Experiment e;
  e.points = {b};
  return check_fields(make_plan(e), best_isa());
}

}  // namespace rabiline::test
