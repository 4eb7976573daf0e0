// From parts to stages: parts contribute terms to sections, and each section gets the cheapest exact stage.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <stdexcept>

#include <fmt/format.h>

#include "plan/geometry.hpp"
#include "plan/plan.hpp"
#include "plan/tally_plan.hpp"
#include "section/section_builder.hpp"
#include "spin/majorana.hpp"

namespace rabiline {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Steps per turn of the fastest rotation where several fields drive a spin at once.
constexpr double steps_per_turn_of_spin = 24;

/// Steps per turn in a region. The path's error over the length of the flight was measured against an
/// independent integration as 1e-4 tip^2 (turns/58) (24/steps)^4, tip the largest sine of the angle between
/// spin and field; the steps are chosen to keep it, and that of the direction at the end, around 1e-7 to 1e-6
/// (tests/physics/dorado_test.cpp holds the path to 1e-6).
double steps_per_turn_of_path(double tip, double turns) {
  return std::clamp(32 * std::pow(500 * tip * tip * turns / 58, 0.25), 8.0, 1000.0);
}

/// What turns the velocity under a law: dv/dt = W x v with W = rate_per_tesla B.
struct Turning {
  double rate_per_tesla = 0;  // [rad/(s T)]
  bool take_off_spin_component = false;
};

Turning turning_of(const Law& law, const Species& species) {
  // Lorentz: m dv/dt = q v x B, so W = -(q/m) B.
  const auto* dorado = std::get_if<DoradoLaw>(&law);
  if (dorado == nullptr) return {-species.charge / species.mass, false};
  return {-dorado->kappa * species.gyromagnetic_ratio, dorado->closure == Closure::torque};
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
  return builder.build();
}

/// Compiles one chain; each member function adds stages for one thing.
class Compiler {
 public:
  Compiler(const Beamline& beamline, const Species& species, const ScreenGrids& grids)
      : beamline_(beamline),
        grids_(grids),
        species_(species),
        sections_(sections_of(beamline)),
        quantum_(std::holds_alternative<QuantumLaw>(beamline.law)),
        turning_(turning_of(beamline.law, species)),
        straight_(turning_.rate_per_tesla == 0),
        may_reach_chamber_(!std::holds_alternative<ParallelDirection>(beamline.source.direction)) {}

  std::vector<Stage> compile() {
    fly();
    chain_.push_back(Exit{});
    tally_detectors(false);
    for (const Plane& plane : sections_.planes)
      if (std::holds_alternative<ScreenTerm>(plane.term)) chain_.push_back(stretch_to(plane));
    tally_detectors(true);
    return std::move(chain_);
  }

 private:
  int levels() const { return quantum_ ? species_.spin.twice + 1 : 0; }

  // ---- fields as the species sees them ----

  SpinZone zone_of(const Section& section) const {
    SpinZone zone;
    zone.begin = section.begin;
    zone.end = section.end;
    zone.spin_rate = -species_.gyromagnetic_ratio * section.field;
    zone.turn_rate = turning_.rate_per_tesla * section.field;
    if (section.rotating.size() > static_cast<std::size_t>(most_drives))
      throw std::invalid_argument("more than 8 rotating fields overlap at one place");
    for (const RotatingTerm& term : section.rotating)
      if (term.amplitude != 0) zone.drive[zone.drives++] = drive_of(term);
    require_known_phases(zone);
    if (zone.drives > 1) zone.step = two_pi / (steps_per_turn_of_spin * rate_of(zone));
    return zone;
  }
  DriveTerm drive_of(const RotatingTerm& term) const {
    DriveTerm drive;
    drive.spin_rate = -species_.gyromagnetic_ratio * term.amplitude;
    drive.turn_rate = turning_.rate_per_tesla * term.amplitude;
    drive.omega = term.omega(species_.gyromagnetic_ratio);
    drive.phase = term.phase;
    drive.oscillator = term.random_phase ? term.oscillator : -1;
    return drive;
  }
  /// The fastest turning in a zone [rad/s], of field, spin or velocity.
  static double rate_of(const SpinZone& zone) {
    double spin = std::abs(zone.spin_rate), turn = std::abs(zone.turn_rate), fastest = 0;
    for (int i = 0; i < zone.drives; ++i) {
      spin += std::abs(zone.drive[i].spin_rate);
      turn += std::abs(zone.drive[i].turn_rate);
      fastest = std::max(fastest, std::abs(zone.drive[i].omega));
    }
    return std::max({spin, turn, fastest});
  }
  /// Beyond this a phase omega t is not known well enough, and the kernels' sine has no digits left
  /// (core/lanes.hpp).
  void require_known_phases(const SpinZone& zone) const {
    constexpr double most = 1e8;  // [rad]: ten times slower particles still stay within 1e9
    const double phase = rate_of(zone) * zone.end / speed();
    if (!(phase <= most))
      throw std::invalid_argument(
          fmt::format("{} would turn by {:.2g} radians before a particle leaves the field at {:.4g} m: more "
                      "than {:.0e}, where its "
                      "phase is no longer known\n  help: make the field or the frequency smaller, or the "
                      "particles faster",
                      species_.name, phase, zone.end, most));
  }
  double speed() const { return mean_speed(beamline_.source.speed); }
  Alignment alignment_of(const AlignTerm& term, int part) const {
    const double spin_along_field = species_.gyromagnetic_ratio < 0 ? -1 : 1;  // mu = gamma S
    return {term.probability, spin_along_field * term.field_sign, levels(), part};
  }

  // ---- planes ----

  Screen screen_at(const Plane& plane) const {
    const std::string& name = beamline_.parts[static_cast<std::size_t>(plane.part)].placement.name;
    return screen_of(plane.y, plane.part, std::get<ScreenTerm>(plane.term), grids_.at(name));
  }

  /// Walls are asked about at planes: a straight flight that left the chamber never comes back into it.
  void stop_at_wall(double y, const Wall& wall) {
    if (std::isfinite(wall.radius))
      chain_.push_back(Passage{aperture_of(y, Disc{wall.radius}, {}), wall.part});
  }
  void stop_at_chamber(double y) {
    if (beamline_.chamber && may_reach_chamber_) stop_at_wall(y, {beamline_.chamber->radius, chamber_number});
  }
  void add_plane(const Plane& plane) {
    if (const auto* align = std::get_if<AlignTerm>(&plane.term)) {
      chain_.push_back(alignment_of(*align, plane.part));
      tip_ = 0;
      return;
    }
    stop_at_chamber(plane.y);
    if (const auto* monitor = std::get_if<MonitorTerm>(&plane.term)) {
      add_monitor(plane, *monitor);
      return;
    }
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term))
      chain_.push_back(Passage{aperture_of(plane.y, plate->opening, plate->offset, plate->tilt), plane.part});
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
      if (of_spin && straight_) histogram.zones = zones_seen_by(histogram, plane);
      chain_.push_back(std::move(histogram));
    }
  }
  std::vector<SpinZone> zones_seen_by(const Histogram& histogram, const Plane& plane) const {
    const bool along_z = std::all_of(histogram.axes.begin(), histogram.axes.end(), [](const auto& axis) {
      return axis.quantity != Quantity::spin || (axis.direction[0] == 0 && axis.direction[1] == 0);
    });
    return quantum_ && along_z ? driven_part(zones_before(plane)) : zones_before(plane);
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
    const auto driven = [](const Section& s) {
      return std::any_of(s.rotating.begin(), s.rotating.end(),
                         [](const RotatingTerm& t) { return t.amplitude != 0; });
    };
    const bool any_driven = std::any_of(touching.begin(), touching.end(), driven);
    const bool any_field =
        std::any_of(touching.begin(), touching.end(), [](const Section& s) { return s.field != 0; });
    const bool spins_along_field = turning_.take_off_spin_component && tip_ == 0;
    return turning_.rate_per_tesla != 0 && (any_driven || (any_field && !spins_along_field));
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
    zone.field = zone_of(section);
    zone.field.begin = begin;
    zone.field.end = end;
    zone.wall_radius = section.wall.radius;
    zone.wall_part = section.wall.part;
    const double stay = (section.end - section.begin) / speed(), turns = rate_of(zone.field) * stay / two_pi;
    tip_ = std::min(1.0, tip_ + tip_in(zone.field, stay));
    zone.step = stay / std::max(4.0, turns * steps_per_turn_of_path(tip_, turns));
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
      edge.plate = aperture_of(plane.y, plate->opening, plate->offset, plate->tilt);
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

  // ---- spins at a detector ----

  /// The fields between the last alignment before the detector, or the source, and the detector.
  std::vector<SpinZone> zones_before(const Plane& detector) const {
    double from = 0;
    for (const Plane& plane : sections_.planes) {
      if (&plane == &detector) break;  // what stands at the same place comes in the order of the list
      if (std::holds_alternative<AlignTerm>(plane.term)) from = plane.y;
    }
    std::vector<SpinZone> zones;
    for (const Section& section : sections_.sections) {
      SpinZone zone = zone_of(section);
      zone.begin = std::max(zone.begin, from);
      zone.end = std::min(zone.end, detector.y);
      if (zone.begin < zone.end && (zone.spin_rate != 0 || zone.drives > 0)) zones.push_back(zone);
    }
    return zones;
  }

  /// Levels along z and S_z do not see precession about z before the first and after the last drive.
  static std::vector<SpinZone> driven_part(const std::vector<SpinZone>& zones) {
    const auto driven = [](const SpinZone& zone) { return zone.drives > 0; };
    const auto first = std::find_if(zones.begin(), zones.end(), driven);
    const auto last = std::find_if(zones.rbegin(), zones.rend(), driven).base();
    return first < last ? std::vector<SpinZone>(first, last) : std::vector<SpinZone>{};
  }

  SpinStretch stretch_to(const Plane& detector) const {
    SpinStretch stretch;
    stretch.part = detector.part;
    stretch.majorana = quantum_;
    stretch.levels = quantum_ ? levels() : 2;
    if (straight_) stretch.zones = zones_before(detector);
    if (straight_ && quantum_) {
      stretch.zones = driven_part(stretch.zones);
      stretch.from_level = true;
    }
    if (stretch.levels > 2) stretch.polynomials = majorana_table(species_.spin.twice).coefficients;
    return stretch;
  }

  const Beamline& beamline_;
  const ScreenGrids& grids_;
  const Species& species_;
  const Sections sections_;
  const bool quantum_;
  const Turning turning_;
  const bool straight_;     // nothing in the whole beam turns the velocity
  bool may_reach_chamber_;  // a parallel beam that nothing has bent stays where it started
  std::size_t next_plane_ = 0;
  double tip_ = 1;  // how far spins may stand from the field so far; 1 for a beam that nothing has aligned
  std::vector<Stage> chain_;
};

}  // namespace

std::vector<Stage> compile(const Beamline& beamline, const Component& component, const ScreenGrids& grids) {
  return Compiler(beamline, component.species, grids).compile();
}

}  // namespace rabiline
