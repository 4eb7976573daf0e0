// From parts to stages: parts contribute terms to sections, and each section gets the cheapest exact stage.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "plan/geometry.hpp"
#include "plan/level_questions.hpp"
#include "plan/magnets.hpp"
#include "plan/plan.hpp"
#include "plan/spin_history.hpp"
#include "plan/tally_plan.hpp"
#include "plan/zones.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Steps per turn in a region. The path's error over the length of the flight was measured against an
/// independent integration as 1e-4 tip^2 (turns/58) (24/steps)^4, tip the largest sine of the angle between
/// spin and field; the steps are chosen to keep it, and that of the direction at the end, around 1e-7 to 1e-6
/// (tests/physics/dorado_test.cpp holds the path to 1e-6).
double steps_per_turn_of_path(double tip, double turns) {
  return std::clamp(32 * std::pow(500 * tip * tip * turns / 58, 0.25), 8.0, 1000.0);
}

/// A parallel beam from inside the chamber.
bool stays_where_it_starts(const Source& source) {
  return std::holds_alternative<ParallelDirection>(source.direction) && source.tilt == SourceTilt{} &&
         !std::holds_alternative<GaussianSpot>(source.opening);
}

Sections sections_of(const Beamline& beamline) {
  Wall chamber;
  if (beamline.chamber) chamber.radius = beamline.chamber->radius;
  SectionBuilder builder(chamber);
  for (std::size_t i = 0; i < beamline.parts.size(); ++i) {
    builder.begin_part(static_cast<int>(i));
    std::visit([&](const auto& part) { contribute(part, beamline.parts[i].placement, builder); },
               beamline.parts[i].part);
  }
  Sections sections = builder.build();
  if (!deflects(beamline.law))
    std::erase_if(sections.planes, [](const Plane& p) { return std::holds_alternative<MagnetTerm>(p.term); });
  return sections;
}

/// Compiles one chain; each member function adds stages for one thing.
class Compiler {
 public:
  Compiler(const Beamline& beamline, const Species& species, const ScreenGrids& grids, SampledTables& tables)
      : beamline_(beamline),
        grids_(grids),
        tables_(tables),
        species_(species),
        sections_(sections_of(beamline)),
        quantum_(std::holds_alternative<QuantumLaw>(beamline.law)),
        turning_(turning_of(beamline.law, species)),
        zones_(species, beamline.species.front().species, turning_,
               mean_speed(beamline.source.speed, species.mass), latest_start(beamline.source.pulse)),
        spins_(sections_, zones_, beamline.source),
        straight_(turning_.rate_per_tesla == 0),
        questions_(beamline, species, sections_, spins_, straight_, tables),
        may_reach_chamber_(!stays_where_it_starts(beamline.source)) {
    if (spins_along_z(beamline.source.spin, quantum_)) tip_ = 0;
  }

  std::vector<Stage> compile() {
    fly();
    chain_.push_back(Exit{});
    tally_detectors(false);
    for (const Plane& plane : sections_.planes)
      if (std::holds_alternative<ScreenTerm>(plane.term)) chain_.push_back(questions_.at_detector(plane));
    tally_detectors(true);
    split_projections(beamline_.law, chain_);
    return std::move(chain_);
  }

 private:
  int levels() const { return quantum_ ? species_.levels() : 0; }

  // ---- fields as the species sees them ----

  double speed() const { return mean_speed(beamline_.source.speed, species_.mass); }
  void require_one_moment(int part) const {
    if (quantum_ && species_.structure)
      throw std::invalid_argument(
          fmt::format("`{}` prepares spins of one moment, and {} has the levels of two spins",
                      beamline_.parts[static_cast<std::size_t>(part)].placement.name, species_.name));
  }
  Alignment alignment_of(const AlignTerm& term, int part) const {
    require_one_moment(part);
    const double spin_along_field = species_.gyromagnetic_ratio < 0 ? -1 : 1;  // mu = gamma S
    return {term.probability,
            spin_along_field * term.field_sign,
            {term.axis.x, term.axis.y, term.axis.z},
            levels(),
            part};
  }

  // ---- planes ----

  Screen screen_at(const Plane& plane) const {
    const std::string& name = beamline_.parts[static_cast<std::size_t>(plane.part)].placement.name;
    return screen_of(plane.y, plane.part, std::get<ScreenTerm>(plane.term), grids_.at(name));
  }

  /// Walls are asked about at planes: a straight flight that left the chamber never comes back into it.
  void stop_at_wall(double y, const Wall& wall) {
    if (std::isfinite(wall.radius))
      chain_.push_back(Passage{aperture_of(y, Disc{wall.radius}, wall.offset), wall.part});
  }
  void stop_at_chamber(double y) {
    if (beamline_.chamber && may_reach_chamber_) stop_at_wall(y, {beamline_.chamber->radius, chamber_number});
  }
  void add_magnet(const MagnetTerm& magnet, const Plane& plane) {
    stop_at_chamber(plane.y);
    chain_.push_back(Drift{plane.y});
    std::vector<SpinZone> zones = quantum_ ? std::vector<SpinZone>{} : spins_.zones_before(plane);
    if (!zones.empty()) chain_.push_back(Precession{std::move(zones)});
    if (auto asked = questions_.at_magnet(plane)) chain_.push_back(std::move(*asked));
    add_deflection(plane, magnet, species_, levels(), tables_, chain_);
    may_reach_chamber_ = true;
  }
  void aligned_along(const Vector3& axis) {
    tip_ = 0;
    aligned_ = axis;
  }
  /// The spin must be known where it is filtered: fields that a straight flight passed before act now.
  void add_filter(const FilterTerm& filter, const Plane& plane) {
    std::vector<SpinZone> zones = straight_ ? spins_.zones_before(plane) : std::vector<SpinZone>{};
    if (!zones.empty()) chain_.push_back(Precession{std::move(zones)});
    chain_.push_back(filter_of(filter, plane.part));
    tip_ = 1;
  }
  Filter filter_of(const FilterTerm& term, int part) const {
    require_one_moment(part);
    if (quantum_ && species_.spin.twice != 1)
      throw std::invalid_argument(
          fmt::format("`{}` filters spins 1/2 only, and {} has spin {}/2 under the law `quantum`\n  help: a "
                      "polarizer prepares a beam of any spin",
                      beamline_.parts[static_cast<std::size_t>(part)].placement.name, species_.name,
                      species_.spin.twice));
    return {{term.axis.x, term.axis.y, term.axis.z}, term.up, term.down, quantum_, part};
  }
  void add_plane(const Plane& plane) {
    if (const auto* align = std::get_if<AlignTerm>(&plane.term)) {
      chain_.push_back(alignment_of(*align, plane.part));
      aligned_along(align->axis);
      return;
    }
    if (const auto* magnet = std::get_if<MagnetTerm>(&plane.term)) {
      add_magnet(*magnet, plane);
      return;
    }
    if (const auto* filter = std::get_if<FilterTerm>(&plane.term)) {
      stop_at_chamber(plane.y);
      add_filter(*filter, plane);
      return;
    }
    stop_at_chamber(plane.y);
    if (const auto* monitor = std::get_if<MonitorTerm>(&plane.term)) {
      add_monitor(plane, *monitor);
      return;
    }
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term))
      chain_.push_back(Passage{aperture_of(plane.y, *plate), plane.part});
    else
      chain_.push_back(Score{screen_at(plane)});
  }

  // ---- tallies ----

  void add_monitor(const Plane& plane, const MonitorTerm& monitor) {
    Census census{aperture_of(plane.y, monitor.face, monitor.offset, monitor.tilt), plane.part};
    chain_.push_back(census);
    add_tallies(plane, monitor.tallies, census.face, false, false);
    add_tallies(plane, monitor.tallies, census.face, false, true);
  }
  /// Behind all else, since they read only what was caught: those that ask for no spin come first, so that
  /// scan points which differ in fields alone share them.
  void tally_detectors(bool of_spin) {
    for (const Plane& plane : sections_.planes)
      if (const auto* screen = std::get_if<ScreenTerm>(&plane.term))
        add_tallies(plane, screen->tallies, aperture_of(plane.y, Disc{}, {}), true, of_spin);
  }
  void add_tallies(const Plane& plane, const std::vector<Tally>& tallies, const Aperture& face, bool caught,
                   bool of_spin) {
    for (std::size_t i = 0; i < tallies.size(); ++i) {
      if (asks_for_spin(tallies[i]) != of_spin) continue;
      Histogram histogram = histogram_of(tallies[i], static_cast<int>(i), species_, levels());
      histogram.part = plane.part;
      histogram.caught = caught;
      histogram.face = face;
      if (of_spin && quantum_ && species_.structure) {
        histogram.of_atom = true;
        histogram.transitions = questions_.transitions_before(plane);
      } else if (of_spin && straight_) {
        histogram.zones = zones_seen_by(histogram, plane);
      }
      chain_.push_back(std::move(histogram));
    }
  }
  std::vector<SpinZone> zones_seen_by(const Histogram& histogram, const Plane& plane) const {
    const bool along_z = std::all_of(histogram.axes.begin(), histogram.axes.end(), [](const auto& axis) {
      return axis.quantity != Quantity::spin || (axis.direction[0] == 0 && axis.direction[1] == 0);
    });
    return quantum_ && along_z ? spins_.zones_before_levels(plane) : spins_.zones_before(plane);
  }

  // ---- from the source to the last part ----

  /// Sections that touch are passed together: as a region where they can turn the velocity, else straight.
  void fly() {
    const auto& sections = sections_.sections;
    for (std::size_t i = 0; i < sections.size();) {
      std::size_t end = i + 1;
      while (end < sections.size() && sections[end].begin == sections[end - 1].end) ++end;
      add_planes_up_to(sections[i].begin);
      const std::span<const Section> touching(&sections[i], end - i);
      if (turns_velocity(touching))
        fly_through_region(touching);
      else
        for (const Section& section : touching) fly_straight_through(section);
      i = end;
    }
    add_planes_up_to(std::numeric_limits<double>::infinity());
  }
  void add_planes_up_to(double y) {
    while (next_plane_ < sections_.planes.size() && sections_.planes[next_plane_].y <= y)
      add_plane(sections_.planes[next_plane_++]);
  }

  /// Under closure `torque` fields without a drive do nothing to spins along them.
  bool turns_velocity(std::span<const Section> touching) const {
    if (turning_.rate_per_tesla == 0) return false;
    const bool spins_aligned = turning_.take_off_spin_component && tip_ == 0;
    return std::any_of(touching.begin(), touching.end(), [&](const Section& s) {
      if (std::any_of(s.rotating.begin(), s.rotating.end(), [](const auto& t) { return t.amplitude != 0; }))
        return true;
      const Vector3 field = zones_.static_field(s);
      return field != Vector3{} && !(spins_aligned && is_parallel(field, aligned_));
    });
  }
  static bool is_parallel(const Vector3& a, const Vector3& b) {
    return length_of(cross(a, b)) <= 1e-12 * length_of(a) * length_of(b);
  }

  void fly_straight_through(const Section& section) {
    if (section.wall.part != chamber_number) stop_at_wall(section.begin, section.wall);
    add_planes_up_to(std::nextafter(section.end, section.begin));
    if (section.wall.part != chamber_number) stop_at_wall(section.end, section.wall);
  }

  // ---- where fields turn the velocity ----

  /// Largest sine of the angle that drives can open between spin and field in a zone: the tip of a spin that
  /// entered along the field; the drives' own turning where the velocity follows the field and not the spin.
  /// Where the path turns by much, the particle stays longer than straight flight would, and so can the tip.
  double tip_in(const SpinZone& zone, double stay) const {
    double tip = 0, most = 0;
    for (int i = 0; i < zone.drives; ++i) {
      const double w1 = std::abs(zone.drive[i].spin_rate),
                   rate = std::hypot(zone.drive[i].omega - zone.spin_rate, w1);
      most += rate > 0 ? 2 * w1 / rate : 0;
      tip += turning_.take_off_spin_component ? w1 * stay : std::abs(zone.drive[i].turn_rate) * stay;
    }
    if (!turning_.take_off_spin_component) return tip;
    const double turned = std::abs(zone.turn_rate) * stay * std::min(tip, most) * std::min(tip, most);
    return turned > 0.5 ? most : std::min(tip, most);
  }

  RegionZone region_zone(const Section& section, double begin, double end) {
    RegionZone zone;
    zone.field = zones_.zone_of(section);
    zones_.require_known_phases(zone.field);
    zone.field.begin = begin;
    zone.field.end = end;
    zone.wall_radius = section.wall.radius;
    zone.wall_part = section.wall.part;
    zone.wall_x = section.wall.offset.x;
    zone.wall_z = section.wall.offset.z;
    if (const Vector3 field = zones_.static_field(section);
        field != Vector3{} && !is_parallel(field, aligned_))
      tip_ = 1;
    const double stay = (section.end - section.begin) / speed(),
                 turns = zones_.rate_of(zone.field) * stay / two_pi;
    tip_ = std::min(1.0, tip_ + tip_in(zone.field, stay));
    zone.step = stay / std::max(4.0, turns * steps_per_turn_of_path(tip_, turns));
    if (zone.field.step > 0) zone.step = std::min(zone.step, zone.field.step);
    return zone;
  }
  RegionEdge region_edge(const Plane& plane) const {
    RegionEdge edge;
    edge.part = plane.part;
    if (const auto* align = std::get_if<AlignTerm>(&plane.term)) {
      edge.kind = EdgeKind::align;
      edge.align = alignment_of(*align, plane.part);
    } else if (const auto* plate = std::get_if<PlateTerm>(&plane.term)) {
      edge.kind = EdgeKind::plate;
      edge.plate = aperture_of(plane.y, *plate);
    } else if (std::holds_alternative<FilterTerm>(plane.term)) {
      throw std::invalid_argument(fmt::format(
          "`{}` stands where fields turn the path under the law {}, and can only be passed in one "
          "direction\n  "
          "help: move it out of the fields, or leave it away under this law",
          beamline_.parts[static_cast<std::size_t>(plane.part)].placement.name, describe(beamline_.law)));
    } else if (std::holds_alternative<MonitorTerm>(plane.term)) {
      refuse_monitor_in_region(beamline_, plane, species_);
    } else {
      edge.kind = EdgeKind::screen;
      edge.screen = screen_at(plane);
    }
    return edge;
  }

  /// A region under construction: `pending` stands before the zone that comes next.
  struct RegionInMaking {
    TurningRegion region;
    RegionEdge pending;
    void add(RegionZone zone) {
      if (!region.zones.empty()) region.edges.push_back(pending);
      pending = {};
      region.zones.push_back(zone);
    }
  };

  /// One section of a region, cut at the planes inside it; several planes at one place get zones of no length
  /// between them.
  void add_section(const Section& section, RegionInMaking& making) {
    double begin = section.begin;
    for (; next_plane_ < sections_.planes.size() && sections_.planes[next_plane_].y < section.end;
         ++next_plane_) {
      const Plane& plane = sections_.planes[next_plane_];
      if (plane.y > begin || making.pending.kind != EdgeKind::open) {
        making.add(region_zone(section, begin, plane.y));
        begin = plane.y;
      }
      making.pending = region_edge(plane);
    }
    making.add(region_zone(section, begin, section.end));
  }

  void fly_through_region(std::span<const Section> touching) {
    const double begin = touching.front().begin;
    stop_at_chamber(begin);
    chain_.push_back(Drift{begin});
    RegionInMaking making;
    for (const Section& section : touching) add_section(section, making);
    making.region.take_off_spin_component = turning_.take_off_spin_component;
    making.region.most_way =
        200 * (touching.back().end - touching.front().begin);  // what circles for longer gives up
    chain_.push_back(std::move(making.region));
    may_reach_chamber_ = true;
  }

  const Beamline& beamline_;
  const ScreenGrids& grids_;
  SampledTables& tables_;
  const Species& species_;
  const Sections sections_;
  const bool quantum_;
  const Turning turning_;
  const ZoneMaker zones_;
  const SpinHistory spins_;
  const bool straight_;  // nothing in the whole beam turns the velocity
  const LevelQuestions questions_;
  bool may_reach_chamber_;  // a parallel beam that nothing has bent stays where it started
  std::size_t next_plane_ = 0;
  Vector3 aligned_{0, 0, 1};  // what spins stand along where tip_ is 0
  double tip_ = 1;  // how far spins may stand from the field so far; 1 for a beam that nothing has aligned
  std::vector<Stage> chain_;
};

}  // namespace

std::vector<Stage> compile(const Beamline& beamline, const Component& component, const ScreenGrids& grids,
                           SampledTables& tables) {
  return Compiler(beamline, component.species, grids, tables).compile();
}

std::vector<SpinZone> zones_along(const Beamline& beamline, const Component& component) {
  if (std::holds_alternative<QuantumLaw>(beamline.law) && component.species.structure) return {};
  const ZoneMaker maker(
      component.species, beamline.species.front().species, turning_of(beamline.law, component.species),
      mean_speed(beamline.source.speed, component.species.mass), latest_start(beamline.source.pulse));
  std::vector<SpinZone> zones;
  for (const Section& section : sections_of(beamline).sections) zones.push_back(maker.zone_of(section));
  return zones;
}

}  // namespace rabiline
