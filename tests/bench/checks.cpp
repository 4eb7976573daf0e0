#include "bench/checks.hpp"

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

#include "bench/experiments.hpp"
#include "physics/suggested.hpp"
#include "simulation/trace.hpp"

namespace rabiline::bench {
namespace {

void expect_near(double limit, double program, double tolerance, const char* what) {
  if (!(std::abs(limit - program) <= tolerance))
    throw std::logic_error(fmt::format("{}: the limit finds {}, the program {}", what, limit, program));
}

/// The fraction of flipped spins of an open beamline, over a scan.
void check_beam() {
  constexpr std::uint64_t particles = 8192;
  constexpr int points = 5;
  Experiment experiment = two_level_beamline(points, particles, true);
  std::vector<Beamline> opened(experiment.points.begin(), experiment.points.end());
  for (Beamline& beamline : opened)
    for (PlacedPart& placed : beamline.parts)
      if (auto* slit = std::get_if<Slit>(&placed.part)) slit->opening = Rectangle{1, 1};
  experiment.points = std::move(opened);
  const Plan plan = make_plan(experiment);
  const std::vector<RabiLine> lines = lines_of(plan);
  FlipSums scan[points];
  scan_of_normal_beam(emission_of(plan), lines, particles, scan);
  RunOptions options;
  options.isa = best_isa();
  const Result result = finish(experiment, plan, run(plan, options).sums);
  for (std::size_t i = 0; i < points; ++i) {
    const double flipped = result.detectors.at(0).levels.at(2 * i);  // B' leaves the lower level
    expect_near(scan[i].p / particles, flipped, 1e-9, "scan of a beam");
    for (const auto beam : {normal_beam, paired_normal_beam})
      expect_near(beam(emission_of(plan), lines[i], particles).p / particles, flipped, 1e-9, "beam");
  }
}

/// The fraction of spins that a whole oscillating field flips.
void check_period() {
  constexpr std::uint64_t particles = 8192;
  const Experiment experiment = oscillating_field(particles);
  const Plan plan = make_plan(experiment);
  const SpinZone& zone = zone_of(plan, ZoneKind::periodic);
  const DriveTerm& drive = zone.drive[0];
  const PeriodTable table(zone.spin_rate, drive.spin_rate, drive.omega);
  RunOptions options;
  options.isa = best_isa();
  const Result result = finish(experiment, plan, run(plan, options).sums);
  expect_near(
      oscillating_beam(emission_of(plan), table, drive, zone.begin, zone.end, particles).p / particles,
      result.detectors.at(0).levels.at(1), 1e-6, "whole oscillating field");
}

/// A few steps of one particle in the suggested experiment's fields.
void check_flight() {
  Beamline beamline = suggested_experiment(1, 1).points.front();
  for (PlacedPart& placed : beamline.parts)
    if (auto* rotating = std::get_if<RotatingField>(&placed.part))
      rotating->phase = {Phase::Kind::angle, 0.7};
  Experiment experiment;
  experiment.points = {beamline};
  const Plan plan = make_plan(experiment);
  const RegionZone& zone = region_of(plan).zones.back();
  const Track track = trace(beamline, 0, best_isa());
  std::size_t begin = 0;
  while (track.y.at(begin) < zone.field.begin) ++begin;
  constexpr int steps = 40;
  const std::size_t end = begin + steps;
  const auto particle_at = [&](std::size_t i) {
    return Particle{{track.x.at(i), track.y.at(i), track.z.at(i)},
                    {track.vx.at(i), track.vy.at(i), track.vz.at(i)},
                    {track.sx.at(i), track.sy.at(i), track.sz.at(i)}};
  };
  const Particle program = particle_at(end);
  const Particle limit =
      turning_flight(zone.field, zone.step, track.t.at(begin), particle_at(begin), steps, 2);
  for (int k = 0; k < 3; ++k) {
    expect_near(limit.place[k], program.place[k], 1e-12, "place in a turning field");
    expect_near(limit.velocity[k], program.velocity[k], 1e-8, "velocity in a turning field");
    expect_near(limit.spin[k], program.spin[k], 1e-9, "spin in a turning field");
  }
}

/// Steps that the program does not take in this form: a spin against Rabi's formula, and a path between wires
/// against the kernels' function.
void check_steps() {
  const double w0 = 1.8e5, w1 = 3e3, omega = 1.83e5, stay = 1e-3, rate = std::hypot(w0 - omega, w1),
               flipped = std::pow(w1 / rate * std::sin(rate * stay / 2), 2);
  expect_near(magnus_spin(w0, w1, omega, stay / 2000, 2000, 2), 1 - 2 * flipped, 1e-7,
              "spin by Magnus' steps");
  expect_near(wires_by_hand(two_wires(), 142, 1e-3, 6e-3, 1e-6, 100, 4),
              wires_as_flown(two_wires(), 142, 1e-3, 6e-3, 1e-6, 100, 4), 1e-15, "place between two wires");
}

/// The path through a map.
void check_map() {
  const FieldMap map = map_of_64();
  const MapShape shape = map.shape(1, MapOutside::zero);
  expect_near(leapfrog_by_hand(shape, 100, 1), leapfrog_as_flown(shape, 100, 1), 1e-15, "place in a map");
}

}  // namespace

void check_limits() {
  check_map();
  check_steps();
  check_beam();
  check_period();
  check_flight();
}

}  // namespace rabiline::bench
