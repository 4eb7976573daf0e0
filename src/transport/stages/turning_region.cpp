#include "transport/stages/turning_region.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/describe_outlook.hpp"
#include "transport/plan_report.hpp"
#include "transport/stages/score.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

/// The sums of a region: left backwards, gave up, left a map, overflowed, stopped at each wall, stopped at
/// each edge, then one ScreenSums for each edge with a screen, then those of each sight: its census, its
/// tallies.
struct RegionSums {
  std::size_t walls, zones;
  explicit RegionSums(const TurningRegion& region)
      : walls(region.zones.size() + region.channels.size() + region.gaps.size()),
        zones(region.zones.size()) {}
  static std::size_t backwards() { return 0; }
  static std::size_t gave_up() { return 1; }
  static std::size_t left_map() { return 2; }
  static std::size_t overflowed() { return 3; }
  static std::size_t wall(std::size_t wall) { return 4 + wall; }
  std::size_t edge(std::size_t edge) const { return 4 + walls + edge; }
  std::size_t screens() const { return 4 + walls + zones; }
};

/// Where the sums of a region's sights begin among its own.
std::size_t sums_before_sights(const TurningRegion& region) {
  std::size_t sums = RegionSums(region).screens();
  for (const RegionEdge& edge : region.edges)
    if (edge.kind == EdgeKind::screen) sums += sums_of(edge.screen).size();
  return sums;
}

/// What a screen counts of a weight up to 2^40, as its kernel does.
std::uint64_t counted_of(const Screen& screen, std::uint64_t weight) {
  return static_cast<std::uint64_t>(std::floor(static_cast<double>(weight) * screen.efficiency));
}

/// Whether a particle is beyond what numbers carry. Who met a wall or a screen had a place there.
bool has_overflowed(const BatchView& batch, int i, std::uint64_t end) {
  double sum = batch.sx[i] + batch.sy[i] + batch.sz[i];
  if (end == region_end::forward || end == region_end::gave_up)
    sum += batch.x[i] + batch.z[i] + batch.t[i] + batch.vx[i] + batch.vy[i] + batch.vz[i];
  return !std::isfinite(sum);
}

/// Books the end of one particle's flight through a region; returns whether it flies on.
bool book(const TurningRegion& region, Sum* sums, BatchView& batch, int i) {
  const RegionSums layout(region);
  const std::uint64_t end = batch.scratch[i] & 0xffffffffULL, weight = batch.weight[i];
  if (has_overflowed(batch, i, end)) {
    sums[RegionSums::overflowed()] += weight;
    return false;
  }
  if (end == region_end::forward) return true;
  if (end == region_end::backwards) {
    sums[RegionSums::backwards()] += weight;
  } else if (end == region_end::gave_up) {
    sums[RegionSums::gave_up()] += weight;
  } else if (end == region_end::left_map) {
    sums[RegionSums::left_map()] += weight;
  } else if ((end & region_end::caught_at_edge) != 0) {
    const std::size_t edge = end & 0xffffULL;
    Sum* at = sums + layout.screens();
    for (std::size_t k = 0; k < edge; ++k)
      if (region.edges[k].kind == EdgeKind::screen) at += sums_of(region.edges[k].screen).size();
    const Screen& screen = region.edges[edge].screen;
    batch.weight[i] = counted_of(screen, weight);
    add_caught(sums_of(screen), at, batch.scratch[i] >> 32, batch.weight[i], batch.particle[i]);
    sums[layout.edge(edge)] += weight - batch.weight[i];
    batch.caught_by[i] = static_cast<std::uint64_t>(screen.part) + 1;
  } else if ((end & region_end::stopped_at_edge) != 0) {
    sums[layout.edge(end & 0xffffULL)] += weight;
  } else {
    sums[RegionSums::wall(end - region_end::at_wall)] += weight;
  }
  return false;
}

/// Batches for what a region's sights see, one for each; nobody is in them yet. A thread keeps their memory.
std::vector<Batch>& batches_for(const TurningRegion& region, const BatchView& batch) {
  thread_local std::vector<Batch> seen;
  if (seen.size() < region.sights.size()) seen.resize(region.sights.size());
  for (std::size_t k = 0; k < region.sights.size(); ++k) {
    BatchView& view = seen[k].view();
    view.count = batch.count;
    view.padded = batch.padded;
    view.y = region.sights[k].census.face.y;
    std::fill_n(view.flying, view.padded, 0);
  }
  return seen;
}

void tally(const TurningRegion& region, std::vector<Batch>& seen, StageContext& context) {
  Sum* sums = context.sums + sums_before_sights(region);
  for (std::size_t k = 0; k < region.sights.size(); ++k) {
    StageContext there{context.isa, context.key, seen[k], sums};
    region.sights[k].census.pass(there);
    there.sums += region.sights[k].census.sums();
    for (const Histogram& tally : region.sights[k].tallies) {
      tally.pass(there);
      there.sums += tally.sums();
    }
    sums = there.sums;
  }
}

/// The fields of a zone as a particle of that speed meets them on the axis, on average, and the side of what
/// drives turn about that the static one is on.
SpinZone on_axis(const TurningRegion& region, const RegionZone& zone, double speed) {
  constexpr int places = 64;
  SpinZone out = zone.field;
  if (zone.shaped_begin == zone.shaped_end) return out;
  const double share = region.feels.spin_per_tesla / places;
  const auto length_of = [](const FieldHere<double>& f) {
    return portable::hypot(f.field[0], f.field[1], f.field[2]);
  };
  double along = 0, size = 0;
  for (int i = 0; i < places; ++i) {
    const double y = out.begin + (out.end - out.begin) * (i + 0.5) / places;
    FieldHere<double> here{}, peaks[most_drives]{};
    for (int k = 0; k < 3; ++k) here.field[k] = zone.uniform[k];
    for (int k = zone.shaped_begin; k < zone.shaped_end; ++k) {
      const ShapedTerm& term = region.shaped[static_cast<std::size_t>(k)];
      if (term.drive < 0)
        add_field_at<HostMaths>(term, 0.0, y, 0.0, y / speed, here);
      else
        add_field<HostMaths>(term, 0.0, y, 0.0, peaks[term.drive]);
    }
    for (int k = 0; k < out.drives; ++k) out.drive[k].spin_rate += share * length_of(peaks[k]);
    along +=
        share * (here.field[0] * out.frame[6] + here.field[1] * out.frame[7] + here.field[2] * out.frame[8]);
    size += share * length_of(here);
  }
  out.spin_rate = out.drives > 0 && along * size < 0 ? -size : size;
  out.turned = out.turned && out.drives > 0 && std::abs(along) > 0.99 * std::abs(size);
  return out;
}

void explain_course(const RegionZone& zone, PlanReport& report) {
  const double rate = std::max(std::abs(zone.field.spin_rate), std::abs(zone.field.turn_rate)),
               turns = rate * zone.table.span / (2 * std::numbers::pi);
  if (zone.course == ZoneCourse::through_field)
    return report.line(
        "{:>16}each particle in steps of its own length, {} at most; the field told here is the mean on its "
        "axis",
        "", pretty_quantity(zone.longest, Dimension::length));
  if (rate == 0) return;
  switch (zone.course) {
    case ZoneCourse::constant:
      return report.line("{:>16}flown in closed form", "");
    case ZoneCourse::joint_turns:
      return report.line(
          "{:>16}velocity in closed form, place by quadrature over {}, {:.2g} turns, at a time", "",
          pretty_quantity(zone.table.span, Dimension::time), turns);
    case ZoneCourse::slow_turns:
      return report.line("{:>16}steps of {}, {:.4g} turns, that follow the slow angles", "",
                         pretty_quantity(zone.table.span, Dimension::time), turns);
    case ZoneCourse::through_field:
      return;
    case ZoneCourse::steps:
      return report.line("{:>16}steps of {}, {:.0f} per turn", "",
                         pretty_quantity(zone.step, Dimension::time),
                         2 * std::numbers::pi / (rate * zone.step));
  }
}

/// Under `torque` tipped spins keep turning the path in every field until something aligns them again, and
/// a large tip deflects nearly everything.
void warn_of_tips(const TurningRegion& region, PlanReport& report) {
  constexpr double large_tip = 0.05;  // [rad]
  if (!region.take_off_spin_component) return;
  std::string tipped_by;
  for (std::size_t i = 0; i < region.zones.size(); ++i) {
    const SpinZone& zone = region.zones[i].field;
    if (report.tip > 0 && zone.drives == 0 && zone.turn_rate != 0)
      report.warn(
          report.field_at((zone.begin + zone.end) / 2), "length",
          fmt::format(
              "behind what drives the spins a uniform field goes on to {:.4g} m: under closure torque "
              "it keeps turning the path of tipped spins",
              zone.end));
    const bool before = report.tip > large_tip;
    for (int k = 0; k < zone.drives; ++k)
      report.tip += std::abs(zone.drive[k].spin_rate) * report.flight.time(zone.begin, zone.end);
    if (report.tip > large_tip && !before) tipped_by = report.field_at((zone.begin + zone.end) / 2);
    if (i < region.edges.size() && region.edges[i].kind == EdgeKind::align) report.tip = 0;
  }
  if (!tipped_by.empty())
    report.warn(
        tipped_by, "amplitude",
        fmt::format("the tip angle on resonance, {:.3g} deg, is large: under closure torque nearly all "
                    "frequencies then deflect, and the resonance is far wider than 1/T",
                    report.tip * 180 / std::numbers::pi));
}

}  // namespace

int part_of_wall(const TurningRegion& region, std::size_t wall) {
  const std::size_t zones = region.zones.size(), channels = region.channels.size();
  if (wall < zones) return region.zones[wall].wall_part;
  return wall < zones + channels ? region.channels[wall - zones].part
                                 : region.gaps[wall - zones - channels].part;
}

Region view_of(const TurningRegion& region, const RandomKey& key) {
  Region view;
  view.key = key;
  view.zones = region.zones.data();
  view.edges = region.edges.data();
  view.zone_count = static_cast<int>(region.zones.size());
  view.channel_count = static_cast<int>(region.channels.size());
  view.take_off_spin_component = region.take_off_spin_component;
  view.shaped = region.shaped.data();
  view.gaps = region.gaps.data();
  view.channels = region.channels.data();
  view.feels = region.feels;
  view.most_way = region.most_way;
  view.most_visits = 64 + 4 * region.zones.size();
  return view;
}

std::string describe_between(const StretchOutlook& outlook) {
  return fmt::format(
      "the field splits the paths of the levels by {}, where the smallest slit, bin or spot is {}, and "
      "spreads their phases by {:.2g} turns: too far apart for one path, too alike in phase for several; "
      "here levels {}, by "
      "`outcomes` of the law",
      pretty_quantity(outlook.splitting, Dimension::length),
      pretty_quantity(outlook.feature, Dimension::length), outlook.turns,
      outlook.sorts ? "are sorted" : "stay coherent");
}

std::string describe_levels(const StretchOutlook& outlook, bool flies_straight) {
  return fmt::format(
      "levels {}: their paths come apart by {} (smallest slit, bin or spot {}), their phases by {:.3g} turns",
      outlook.sorts    ? "are sorted"
      : flies_straight ? "stay coherent, and atoms fly straight here"
                       : "stay coherent",
      pretty_quantity(outlook.splitting, Dimension::length),
      pretty_quantity(outlook.feature, Dimension::length), outlook.turns);
}

void explain_levels(const TurningRegion& region, PlanReport& report) {
  const StretchOutlook& outlook = region.outlook;
  if (outlook.splitting == 0) return;
  report.line("{:>16}{}", "", describe_levels(outlook, false));
  if (outlook.between)
    report.warn(report.field_at((region.y() + region.zones.back().field.end) / 2), "kind",
                describe_between(outlook));
}

double cost_of(const RegionZone& zone, double speed) {
  const double stay = zone.detour * (zone.field.end - zone.field.begin) / speed;
  const auto spans = [&] { return std::ceil(stay / zone.table.span); };
  switch (zone.course) {
    case ZoneCourse::constant:
      return cost::crossing;
    case ZoneCourse::joint_turns:
      return cost::crossing + spans() * cost::joint_span;
    case ZoneCourse::slow_turns:
      return cost::crossing +
             spans() * (zone.field.turn_rate == zone.field.spin_rate ? cost::slow_span : 2 * cost::slow_span);
    case ZoneCourse::through_field:  // asked of the region
    case ZoneCourse::steps:
      break;
  }
  const bool one_rotates = zone.field.kind == ZoneKind::precession || zone.field.kind == ZoneKind::rotating;
  if (!one_rotates || (zone.field.turned && zone.field.drive[0].twist == 0))
    return stay / zone.step * cost::laboratory_step;
  return stay / zone.step * (zone.field.drive[0].twist != 0 ? cost::twisted_step : cost::step);
}

std::size_t TurningRegion::sums() const {
  std::size_t sums = sums_before_sights(*this);
  for (const Sight& sight : sights) {
    sums += sight.census.sums();
    for (const Histogram& tally : sight.tallies) sums += tally.sums();
  }
  return sums;
}

void TurningRegion::pass(StageContext& context) const {
  BatchView& batch = context.batch.view();
  std::vector<Batch>& seen = batches_for(*this, batch);
  std::vector<BatchView> views;
  views.reserve(sights.size());
  for (std::size_t k = 0; k < sights.size(); ++k) views.push_back(seen[k].view());
  Region view = view_of(*this, context.key);
  view.seen = views.data();
  view.sight_count = static_cast<int>(views.size());
  kernel::turn(context.isa)(view, batch, context.recorder);
  tally(*this, seen, context);
  for (int i = 0; i < batch.count; ++i)
    if (batch.flying[i] != 0 && !book(*this, context.sums, batch, i)) batch.flying[i] = 0;
}

void TurningRegion::list_sums(SumSink& sink) const {
  const RegionSums layout(*this);
  sink.fate(fate::left_backwards, no_part, RegionSums::backwards());
  sink.fate(fate::gave_up, no_part, RegionSums::gave_up());
  if (!shaped.empty()) sink.fate(fate::left_map, no_part, RegionSums::left_map());
  sink.fate(fate::overflowed, no_part, RegionSums::overflowed());
  for (std::size_t wall = 0; wall < layout.walls; ++wall)
    if (wall >= zones.size() || std::isfinite(zones[wall].wall_radius))
      sink.fate(fate::stopped, part_of_wall(*this, wall), RegionSums::wall(wall));
  std::size_t screen = layout.screens();
  for (std::size_t i = 0; i < edges.size(); ++i) {
    const RegionEdge& edge = edges[i];
    const bool loses =
        edge.kind == EdgeKind::screen && (edge.screen.efficiency != 1 || edge.screen.has_dead_area);
    if (edge.kind == EdgeKind::plate || loses) sink.fate(fate::stopped, edge.part, layout.edge(i));
    if (edge.kind == EdgeKind::screen) {
      list_screen(edge.screen, screen, sink);
      screen += sums_of(edge.screen).size();
    }
  }
  std::size_t at = sums_before_sights(*this);
  const auto list_next = [&](const auto& stage) {
    ShiftedSums shifted(sink, at);
    stage.list_sums(shifted);
    at += stage.sums();
  };
  for (const Sight& sight : sights) {
    list_next(sight.census);
    for (const Histogram& tally : sight.tallies) list_next(tally);
  }
}

double TurningRegion::y() const { return zones.front().field.begin; }

namespace {

/// Steps follow what changes: a field that grows evenly takes the fewest, others about as many as their bends
/// take, and precession and drives some for each turn. A trial and its two halves ask for the fields a dozen
/// times.
double cost_through_field(const TurningRegion& region, const RegionZone& zone, double speed) {
  constexpr double asked = 12, of_bends = 4, per_turn = 8, per_precession = 12;
  const double stay = zone.detour * (zone.field.end - zone.field.begin) / speed;
  double steps = stay * speed / zone.longest, each = cost::zone;
  for (int i = zone.shaped_begin; i < zone.electric_end; ++i) {
    const bool linear = region.shaped[static_cast<std::size_t>(i)].kind == ShapedKind::linear;
    if (!linear) steps = std::max(steps, of_bends * stay * speed / zone.longest);
    each += linear ? cost::linear_field : cost::shaped_field;
  }
  if (region.feels.follows_level) return steps * asked * each;
  steps += per_precession * std::abs(on_axis(region, zone, speed).spin_rate) * stay / (2 * std::numbers::pi);
  for (int i = 0; i < zone.field.drives; ++i)
    steps += per_turn * std::abs(zone.field.drive[i].omega) * stay / (2 * std::numbers::pi);
  return steps * asked * each;
}

}  // namespace

double TurningRegion::cost(double speed) const {
  double flight = 0, planes = 0;
  for (const RegionZone& zone : zones)
    flight += zone.course == ZoneCourse::through_field ? cost_through_field(*this, zone, speed)
                                                       : cost_of(zone, speed);
  for (const Sight& sight : sights) {
    planes += sight.census.cost(speed);
    for (const Histogram& tally : sight.tallies) planes += tally.cost(speed);
  }
  return flight + planes;
}

void TurningRegion::explain(PlanReport& report) const {
  report.line("{}  {}, to {}{}", PlanReport::metres(zones.front().field.begin),
              shaped.empty() ? "region that turns the velocity" : "flown through fields in steps",
              PlanReport::metres(zones.back().field.end), report.reuse);
  for (const RegionZone& zone : zones) {
    explain_zone(on_axis(*this, zone, report.flight.speed_between(zone.field.begin, zone.field.end)), report);
    explain_course(zone, report);
    explain_electric(*this, zone, report);
  }
  for (const Sight& sight : sights) {
    sight.census.explain(report);
    for (const Histogram& tally : sight.tallies) tally.explain(report);
  }
  explain_levels(*this, report);
  warn_of_tips(*this, report);
}

/// Velocities turn with spins.
bool TurningRegion::follows_paths() const { return false; }

std::size_t TurningRegion::own_memory() const { return sights.size() * Batch::bytes; }

}  // namespace rabiline
