#include "unit/transport/stage_samples.hpp"

#include <fmt/format.h>

#include <limits>

#include "constants.hpp"
#include "particle/species.hpp"
#include "plan/courses.hpp"
#include "spin/atoms.hpp"
#include "spin/driven_levels.hpp"
#include "spin/levels.hpp"
#include "spin/majorana.hpp"
#include "spin/moment_table.hpp"
#include "unit/transport/sample_parts.hpp"

namespace rabiline::test {
namespace {

using namespace sample;

constexpr int most = 4;
SpinPath spins(int levels, std::vector<SpinZone> zones) {
  return {.levels = levels, .zones = std::move(zones), .polynomials = majorana_table(most - 1).coefficients};
}
SpinPath of_two(std::vector<SpinZone> zones, bool from_level) {
  return {.levels = 2,
          .start = from_level ? std::optional(UnitVector{}) : std::nullopt,
          .zones = std::move(zones),
          .polynomials = majorana_table(1).coefficients};
}
/// Hydrogen between 1/2000 and 1/150 s/m, driven between the upper levels.
SpinPath of_atom() {
  static const DrivenLevels driven = [] {
    const CoupledSpins spins = coupled_spins(*find_atom("H"));
    RotatingTerm drive;
    drive.amplitude = 1e-7;
    drive.oscillator.frequency = transition_frequency(levels_at(spins, 1e-5), 1, 0);
    return DrivenLevels(spins, {{0, 0.1, 1e-5, drive}}, 7e-3);
  }();
  return {.levels = 4, .of_atom = true, .transitions = &driven};
}

}  // namespace

template <>
std::vector<StageSample> samples_of<Drift>() {
  return {{"on", Drift{0.4}}, {"back", Drift{0.05}}};
}

template <>
std::vector<StageSample> samples_of<Passage>() {
  Aperture ring = disc(1.5e-3), stop = disc(1e-3);
  ring.inner = 0.5e-3;
  stop.stops_inside = true;
  return {{"rectangle", Passage{rectangle(1e-3, 2e-3), part}},
          {"turned", Passage{rectangle(1e-3, 2e-3, 0.3), part}},
          {"ring", Passage{ring, part}},
          {"stop", Passage{stop, part}},
          {"channel", Passage{rectangle(1e-3, 2e-3), part, 0.05}},
          {"bore", Passage{disc(1e-3), part, 0.05}},
          {"beside others",
           Passage{rectangle(1e-3, 2e-3), part, start, {disc(1.2e-3), rectangle(2e-3, 0.7e-3)}}}};
}

template <>
std::vector<StageSample> samples_of<WallStop>() {
  // Nothing is marked, but for what counts as met by the part -2.
  return {{"all", WallStop{{-2, start}}}};
}

template <>
std::vector<StageSample> samples_of<Bounds>() {
  // Its field is not asked for.
  ShapedTerm box(MapShape{nullptr, {5, 5, 4}, {-2e-3, 0, -1.5e-3}, {1e3, 10, 1e3}, 1, MapOutside::error});
  RegionGap gap{{true, 0, 0, 1e-3, 2e-3, {}}, 0.2e-3, -0.1e-3, 0.3e-3, 0.8, 0.6};
  gap.walls.circles[0] = {0, -2e-3, 1.5e-3, 1};
  return {{"map", Bounds{{part, start}, 0.4, box}},
          {"gap", Bounds{{part, start}, 0.4, gap}},
          {"gap in a bore", Bounds{{part, start}, 0.4, gap, {disc(1.2e-3)}}}};
}

template <>
std::vector<StageSample> samples_of<Alignment>() {
  return {{"levels", Alignment{0.7, -1, {0, 0.6, 0.8}, 3, 0, 2, part, start}, 3},
          {"vectors", Alignment{0.7, 1, {0.6, 0, 0.8}, 0, 0, 0, part, start}}};
}

template <>
std::vector<StageSample> samples_of<Precession>() {
  std::vector<StageSample> samples;
  for (const NamedZones& named : all_zones()) samples.push_back({named.what, Precession{named.zones}});
  return samples;
}

template <>
std::vector<StageSample> samples_of<Filter>() {
  return {{"levels", Filter{{0, 0.6, 0.8}, 0.9, 0.2, true, part, start}, 2},
          {"vectors", Filter{{0.6, 0, 0.8}, 0.9, 0, false, part, start}}};
}

template <>
std::vector<StageSample> samples_of<FilterStop>() {
  return {{"outcome", FilterStop{part, start, 1}, 3}};
}

template <>
std::vector<StageSample> samples_of<LevelFilter>() {
  return {{"levels", LevelFilter{{0.9, 0, 0.3}, 2, part, start}, 3}};
}

template <>
std::vector<StageSample> samples_of<LevelProjection>() {
  std::vector<StageSample> samples{
      {"closed form", LevelProjection{part, start, false, of_two({zone(ZoneKind::rotating)}, true)}, 2},
      {"atom", LevelProjection{part, start, false, of_atom()}, 4}};
  for (const NamedZones& named : all_zones()) {
    samples.push_back({named.what, LevelProjection{part, start, false, spins(most, named.zones)}, most});
    samples.push_back({named.what, LevelProjection{part, start, false, of_two(named.zones, false)}, 2});
  }
  return samples;
}

template <>
std::vector<StageSample> samples_of<Deflection>() {
  Deflection d{.begin = start, .end = 0.4, .acceleration = 3e4, .along_x = 0.6, .along_z = 0.8, .part = part};
  Deflection gap = d;
  gap.levels = 3;
  gap.has_gap = true;
  gap.half_x = 2e-3;
  gap.half_z = 1.5e-3;
  Deflection in_chamber = gap;
  in_chamber.chamber = 1.8e-3;
  return {{"vectors", d}, {"levels in a gap", gap, 3}, {"levels in a gap and the chamber", in_chamber, 3}};
}

template <>
std::vector<StageSample> samples_of<Steering>() {
  static const MomentTable table(coupled_spins(*find_atom("Na-23")));
  std::vector<StageSample> samples;
  for (const MagnetKind kind : {MagnetKind::gradient, MagnetKind::two_wire, MagnetKind::multipole})
    for (const int power : {1, 2, 3}) {
      Steering s;
      s.begin = start;
      s.end = 0.3;
      s.mass = 23 * atomic_mass;
      s.moment = -bohr_magneton;
      s.part = part;
      s.x0 = 1e-4;
      s.cosine = 0.6;
      s.sine = 0.8;
      s.shape = {.kind = kind, .field = 0.3, .gradient = 60, .along_x = 0.6, .along_z = 0.8};
      s.shape.half_distance = 2e-3;
      s.shape.height = kind == MagnetKind::two_wire ? 2.4e-3 : 0;
      s.shape.power = power;
      s.shape.radius = 5e-3;
      s.walls.circles[0] = {0, s.shape.height, 4e-3, -1};
      const std::string what = std::to_string(static_cast<int>(kind)) + ", power " + std::to_string(power);
      samples.push_back({"vectors in " + what, s});
      s.levels = 8;
      samples.push_back({"levels in " + what, s, 8});
      samples.push_back({"levels beside the chamber in " + what, s, 8});
      std::get<Steering>(samples.back().stage).chamber = 1.8e-3;
      s.moment = table.largest();
      s.moments = {table.coefficients().data(), table.cells(), table.scale()};
      s.walls = {.rectangle = true, .half_x = 3e-3, .half_z = 3e-3, .circles = {}};
      s.walls.z = s.shape.height;
      samples.push_back({"atoms in " + what, s, 8});
      s.tolerance = 1e-10;
      samples.push_back({"atoms closely in " + what, s, 8});
      if (kind != MagnetKind::multipole) break;
    }
  return samples;
}

namespace {

/// A ring across the beam, and a field that grows.
TurningRegion shaped_region(ZoneKind kind) {
  TurningRegion r;
  RegionZone z{.field = zone(kind),
               .wall_radius = 5e-3,
               .wall_part = part,
               .step = 1e-5,
               .course = ZoneCourse::through_field,
               .table = {},
               .shaped_end = 2,
               .longest = 0.02};
  r.zones = {z};
  ShapedTerm loop(LoopShape{1e-5, 0.02});
  loop.y = 0.2;
  ShapedTerm linear(LinearShape{{0, 0, 1e-3}, {-0.4, 0, 0, 0, 0, 0, 0, 0, 0.4}});
  r.shaped = {loop, linear};
  r.feels.spin_per_tesla = -gamma_n;
  r.feels.turn_per_tesla = kind == ZoneKind::precession ? -gamma_n : 0;
  r.feels.pull = 5;
  r.feels.gravity[2] = -9.81;
  r.feels.tolerance = 1e-3;  // long steps, whose ends are sought for longer
  r.most_way = 3;
  return r;
}

}  // namespace

template <>
std::vector<StageSample> samples_of<SortingField>() {
  static const MomentTable table(coupled_spins(*find_atom("Na-23")));
  SortingField constant{shaped_region(ZoneKind::general), part};
  constant.region.feels.turn_per_tesla = 0;
  constant.region.feels.follows_level = true;
  constant.region.feels.levels = 8;
  for (RegionZone& z : constant.region.zones) z.field.drives = 0, z.field.turn_rate = 0;
  SortingField atom = constant;
  atom.region.feels.mass = 23 * atomic_mass;
  atom.region.feels.moments = {table.coefficients().data(), table.cells(), table.scale()};
  return {{"levels", constant, 8}, {"atoms", atom, 8}};
}

template <>
std::vector<StageSample> samples_of<TurningRegion>() {
  // Fields in which the slowest go round in circles of a few cm, and leave through the walls or backwards.
  const auto region = [](ZoneKind kind, EdgeKind edge_kind, bool take_off) {
    TurningRegion r;
    RegionZone first{.field = zone(kind),
                     .wall_radius = 5e-3,
                     .wall_part = part,
                     .step = 1e-5,
                     .sights_passed = 1,
                     .table = {}};
    RegionZone second = first;
    first.field.end = second.field.begin = 0.2;
    second.field.end = 0.3;
    second.wall_radius = std::numeric_limits<double>::infinity();
    r.zones = {first, second};
    RegionEdge edge{edge_kind, disc(2e-3), poor_screen(), {0.7, 1, {0, 0, 1}, 0, 0, 0, part, 0.2}, part};
    edge.plate.y = edge.screen.y = 0.2;
    r.edges = {edge};
    Census census{disc(4e-3), part, 0};
    census.face.y = 0.15;
    Histogram tally{.part = part,
                    .face = census.face,
                    .axes = {{Quantity::angle_x, -1, 1, 9}},
                    .mass = neutron_mass,
                    .spins = {}};
    r.sights = {{census, {tally}}};
    r.take_off_spin_component = take_off;
    r.most_way = 3;
    return r;
  };
  std::vector<StageSample> samples;
  for (const ZoneKind kind :
       {ZoneKind::precession, ZoneKind::rotating, ZoneKind::profiled, ZoneKind::general})
    for (const EdgeKind edge : {EdgeKind::open, EdgeKind::plate, EdgeKind::screen, EdgeKind::align})
      samples.push_back({"zone " + std::to_string(static_cast<int>(kind)) + ", edge " +
                             std::to_string(static_cast<int>(edge)),
                         region(kind, edge, edge == EdgeKind::open || edge == EdgeKind::align)});
  const auto in_channel = [](TurningRegion r) {
    r.channels = {{1e-4, 0, 3e-3, 2e-3, 0.6, 0.8}};
    r.zones.back().channel_end = 1;
    return r;
  };
  samples.push_back({"channel", in_channel(region(ZoneKind::general, EdgeKind::plate, false))});
  samples.push_back({"channel in a field that grows", in_channel(shaped_region(ZoneKind::precession))});
  const struct {
    const char* what;
    ZoneCourse course;
    ZoneKind kind;
    double span;
    bool take_off;
    double kappa = 1;
  } courses[] = {{"a charge", ZoneCourse::constant, ZoneKind::precession, 5e-4, false},
                 {"torque in a uniform field", ZoneCourse::constant, ZoneKind::precession, 5e-4, true},
                 {"larmor in a rotating field", ZoneCourse::constant, ZoneKind::rotating, 5e-4, false},
                 {"joint turns", ZoneCourse::joint_turns, ZoneKind::rotating, 1e-4, true},
                 {"slow turns", ZoneCourse::slow_turns, ZoneKind::rotating, 4e-4, true},
                 {"slow axis", ZoneCourse::slow_turns, ZoneKind::rotating, 4e-4, true, 0.3}};
  for (const auto& c : courses)
    for (const bool along_z : {true, false}) {
      TurningRegion r = region(c.kind, EdgeKind::align, c.take_off);
      for (RegionZone& z : r.zones) {
        if (!along_z) z.field = turned(z.field);
        z.course = c.course;
        z.field.turn_rate = c.kappa * z.field.spin_rate;
        z.field.drive[0].turn_rate = c.kappa * z.field.drive[0].spin_rate;
        z.table = span_table(z.field, c.span, c.course);
      }
      samples.push_back({fmt::format("{}{}", c.what, along_z ? "" : ", turned"), r});
    }
  for (const ZoneKind kind :
       {ZoneKind::precession, ZoneKind::rotating, ZoneKind::profiled, ZoneKind::general}) {
    TurningRegion r = shaped_region(kind);
    samples.push_back({fmt::format("through a field, zone {}", static_cast<int>(kind)), r});
    r.feels.levels = 3;
    samples.push_back({fmt::format("levels through a field, zone {}", static_cast<int>(kind)), r, 3});
  }
  return samples;
}

template <>
std::vector<StageSample> samples_of<Score>() {
  Screen round = screen();
  round.radius = 2e-3;
  return {{"plain", Score{screen()}}, {"poor", Score{poor_screen()}}, {"round", Score{round}}};
}

template <>
std::vector<StageSample> samples_of<Exit>() {
  return {{"exit", Exit{}}};
}

template <>
std::vector<StageSample> samples_of<SpinStretch>() {
  std::vector<StageSample> samples{
      {"closed form", SpinStretch{part, true, of_two({zone(ZoneKind::rotating)}, true)}, 2},
      {"atom", SpinStretch{part, true, of_atom()}, 4}};
  for (const NamedZones& named : all_zones()) {
    samples.push_back({named.what, SpinStretch{part, true, spins(most, named.zones)}, most});
    samples.push_back({named.what, SpinStretch{part, true, of_two(named.zones, false)}, 2});
    samples.push_back({named.what, SpinStretch{part, false, of_two(named.zones, false)}});
  }
  return samples;
}

template <>
std::vector<StageSample> samples_of<Census>() {
  return {{"disc", Census{disc(2e-3), part, 0}}, {"turned", Census{rectangle(1e-3, 2e-3, 0.3), part, 1}}};
}

template <>
std::vector<StageSample> samples_of<Histogram>() {
  std::vector<StageSample> samples;
  const auto add = [&](const std::string& what, const HistogramAxis& axis, const SpinPath& path,
                       bool caught) {
    Histogram h{.part = part,
                .caught = caught,
                .face = disc(3e-3),
                .axes = {axis},
                .mass = neutron_mass,
                .spins = path};
    h.pulse = {PulseKind::gaussian, 1e-5};
    samples.push_back({what, h, path.levels});
  };
  for (const QuantityRow& row : quantity_rows) {
    HistogramAxis axis{
        row.quantity, std::max(row.limits.low, -4.0), std::min(row.limits.high, 4.0), 11, {0.6, 0, 0.8}};
    if (row.dimension == Dimension::length && row.quantity != Quantity::y) axis.low = -(axis.high = 4e-3);
    if (row.quantity == Quantity::wavelength) axis.low = -(axis.high = 4e-9);
    if (row.quantity == Quantity::time_of_flight || row.quantity == Quantity::start_time)
      axis.low = -(axis.high = 1e-2);
    if (row.quantity == Quantity::speed) axis.high = 1000;
    if (row.quantity == Quantity::energy) axis.high = 1e-20;
    if (row.categorical) axis = {row.quantity, 0, 1, most, {0, 0, 1}};
    for (const NamedZones& named : all_zones()) {
      const std::string what = std::string(row.word) + " behind " + named.what;
      for (const bool caught : {false, true}) {
        if (!row.categorical) add(what, axis, {.levels = 0, .zones = named.zones}, caught);
        if (!row.of_vector_spin) add(what + ", levels", axis, spins(most, named.zones), caught);
      }
      if (!row.of_spin) break;
    }
    if (row.of_spin && !row.of_vector_spin) {
      axis.direction[0] = 0;
      axis.direction[2] = 1;
      add(std::string(row.word) + " of an atom", axis, of_atom(), true);
    }
  }
  return samples;
}

template <>
std::vector<StageSample> samples_of<Attenuation>() {
  return {{"gas", Attenuation{{part, start}, 0.7, 0.2}},
          {"gas in a bore", Attenuation{{part, start}, 0.7, 0.2, {disc(1e-3)}}}};
}

template <>
std::vector<StageSample> samples_of<Chopping>() {
  return {{"shutter", Chopping{{part, start}, 0.4, 3e3, 0.1}}};
}

template <>
std::vector<StageSample> samples_of<VelocitySelection>() {
  return {{"band", VelocitySelection{{part, start}, 500, 0.6, 0.8}}};
}

}  // namespace rabiline::test
