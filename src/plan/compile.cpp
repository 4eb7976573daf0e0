// From parts to stages: parts contribute terms to sections, and each section gets the cheapest exact stage.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "plan/plan.hpp"
#include "section/section_builder.hpp"
#include "spin/majorana.hpp"

namespace rabiline {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

/// Steps per turn of the fastest rotation where several fields drive a spin at once.
constexpr double steps_per_turn_of_spin = 24;

/// Steps per turn in a region. The path's error over the length of the flight was measured against an
/// independent integration as 1e-4 tip^2 (turns/58) (24/steps)^4, tip the largest sine of the angle between
/// spin and field; the steps keep it below 2e-7 (tests/physics/dorado_test.cpp: below 1e-6).
double steps_per_turn_of_path(double tip, double turns) {
  return std::clamp(24 * std::pow(500 * tip * tip * turns / 58, 0.25), 8.0, 1000.0);
}

double mean_speed(const SpeedLaw& law) {
  if (const auto* single = std::get_if<SingleSpeed>(&law)) return single->value;
  return std::get<GaussianSpeed>(law).mean;
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

Aperture aperture_of(double y, const Opening& opening, const Offset& offset) {
  Aperture a;
  a.y = y;
  a.x0 = offset.x;
  a.z0 = offset.z;
  if (const auto* disc = std::get_if<Disc>(&opening)) {
    a.radius = disc->radius;
  } else {
    a.half_x = std::get<Rectangle>(opening).width / 2;
    a.half_z = std::get<Rectangle>(opening).height / 2;
  }
  return a;
}

Screen screen_of(double y, int part, const ScreenTerm& term) {
  Screen s;
  s.y = y;
  s.part = part;
  s.x0 = term.offset.x;
  s.z0 = term.offset.z;
  s.half_x = term.size.width / 2;
  s.half_z = term.size.height / 2;
  s.bins_x = term.bins_x;
  s.bins_z = term.bins_z;
  s.bins_per_x = term.bins_x / term.size.width;
  s.bins_per_z = term.bins_z / term.size.height;
  return s;
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
  Compiler(const Beamline& beamline, const Species& species)
      : beamline_(beamline),
        species_(species),
        sections_(sections_of(beamline)),
        quantum_(std::holds_alternative<QuantumLaw>(beamline.law)),
        turning_(turning_of(beamline.law, species)) {}

  std::vector<Stage> compile() {
    if (turning_.rate_per_tesla == 0)
      fly_straight();
    else
      fly_through_regions();
    chain_.push_back(Exit{});
    for (const Plane& plane : sections_.planes)
      if (std::holds_alternative<ScreenTerm>(plane.term)) chain_.push_back(stretch_to(plane));
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
    if (zone.drives > 1)
      zone.steps = static_cast<int>(std::ceil(steps_per_turn_of_spin * rate_of(zone) *
                                              (section.end - section.begin) / (two_pi * speed())));
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
  double speed() const { return mean_speed(beamline_.source.speed); }
  Alignment alignment_of(const AlignTerm& term, int part) const {
    const double spin_along_field = species_.gyromagnetic_ratio < 0 ? -1 : 1;  // mu = gamma S
    return {term.probability, spin_along_field * term.field_sign, levels(), part};
  }

  // ---- planes ----

  /// Walls are asked about at planes: a straight flight that left the chamber never comes back into it.
  void stop_at_wall(double y, const Wall& wall) {
    if (std::isfinite(wall.radius))
      chain_.push_back(Passage{aperture_of(y, Disc{wall.radius}, {}), wall.part});
  }
  void stop_at_chamber(double y) {
    if (beamline_.chamber) stop_at_wall(y, {beamline_.chamber->radius, chamber_number});
  }
  void add_plane(const Plane& plane) {
    if (const auto* align = std::get_if<AlignTerm>(&plane.term)) {
      chain_.push_back(alignment_of(*align, plane.part));
      tip_ = 0;
      return;
    }
    stop_at_chamber(plane.y);
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term))
      chain_.push_back(Passage{aperture_of(plane.y, plate->opening, plate->offset), plane.part});
    else
      chain_.push_back(Score{screen_of(plane.y, plane.part, std::get<ScreenTerm>(plane.term))});
  }

  // ---- nothing turns the velocity ----

  void fly_straight() {
    std::size_t next_plane = 0;
    const auto planes_up_to = [&](double y) {
      while (next_plane < sections_.planes.size() && sections_.planes[next_plane].y <= y)
        add_plane(sections_.planes[next_plane++]);
    };
    for (const Section& section : sections_.sections) {
      if (section.wall.part == chamber_number) continue;
      planes_up_to(section.begin);
      stop_at_wall(section.begin, section.wall);
      planes_up_to(std::nextafter(section.end, section.begin));
      stop_at_wall(section.end, section.wall);
    }
    planes_up_to(std::numeric_limits<double>::infinity());
    straight_ = true;
  }

  // ---- something does ----

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
    zone.field.steps = 1;
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
      edge.plate = aperture_of(plane.y, plate->opening, plate->offset);
    } else {
      edge.kind = EdgeKind::screen;
      edge.screen = screen_of(plane.y, plane.part, std::get<ScreenTerm>(plane.term));
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
  void add_section(const Section& section, std::size_t& next_plane, RegionInMaking& making) {
    double begin = section.begin;
    for (; next_plane < sections_.planes.size() && sections_.planes[next_plane].y < section.end;
         ++next_plane) {
      const double y = sections_.planes[next_plane].y;
      if (y > begin || making.pending.kind != EdgeKind::open) {
        making.add(region_zone(section, begin, y));
        begin = y;
      }
      making.pending = region_edge(sections_.planes[next_plane]);
    }
    making.add(region_zone(section, begin, section.end));
  }

  /// Sections that touch form one region.
  void fly_through_regions() {
    const auto& sections = sections_.sections;
    std::size_t next_plane = 0;
    const auto planes_up_to = [&](double y) {
      while (next_plane < sections_.planes.size() && sections_.planes[next_plane].y <= y)
        add_plane(sections_.planes[next_plane++]);
    };
    for (std::size_t i = 0; i < sections.size();) {
      const double begin = sections[i].begin;
      planes_up_to(begin);
      stop_at_chamber(begin);
      chain_.push_back(Drift{begin});
      RegionInMaking making;
      do add_section(sections[i++], next_plane, making);
      while (i < sections.size() && sections[i].begin == sections[i - 1].end);
      making.region.take_off_spin_component = turning_.take_off_spin_component;
      making.region.most_steps = most_steps(making.region);
      chain_.push_back(std::move(making.region));
    }
    planes_up_to(std::numeric_limits<double>::infinity());
  }

  /// Two hundred straight crossings of the longest zone: what circles for longer gives up.
  int most_steps(const TurningRegion& region) const {
    double most = 0;
    for (const RegionZone& zone : region.zones)
      most = std::max(most, (zone.field.end - zone.field.begin) / speed() / zone.step);
    return static_cast<int>(std::min(200 * most + 1000, 1e9));
  }

  // ---- spins at a detector ----

  /// The fields between the last alignment before the detector, or the source, and the detector.
  std::vector<SpinZone> zones_before(const Plane& detector) const {
    double from = 0;
    for (const Plane& plane : sections_.planes)
      if (std::holds_alternative<AlignTerm>(plane.term) && plane.y <= detector.y) from = plane.y;
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
  const Species& species_;
  const Sections sections_;
  const bool quantum_;
  const Turning turning_;
  bool straight_ = false;
  double tip_ = 1;  // how far spins may stand from the field so far; 1 for a beam that nothing has aligned
  std::vector<Stage> chain_;
};

const PlacedPart* find_part(const Beamline& beamline, const std::string& name) {
  for (const PlacedPart& part : beamline.parts)
    if (part.placement.name == name) return &part;
  return nullptr;
}

/// The opening that an aimed source is aimed at: a slit's hole or a detector's face.
Aperture target_of(const Beamline& beamline, const std::string& name) {
  const PlacedPart& target = *find_part(beamline, name);
  if (const auto* slit = std::get_if<Slit>(&target.part))
    return aperture_of(target.placement.at, slit->opening, slit->offset);
  const auto& detector = std::get<Detector>(target.part);
  return aperture_of(target.placement.at, Rectangle{detector.width, detector.height}, detector.offset);
}

}  // namespace

std::vector<Stage> compile(const Beamline& beamline, const Component& component) {
  return Compiler(beamline, component.species).compile();
}

Emission emission_of(const Beamline& beamline, const Component& component, RandomKey key) {
  Emission e;
  e.key = key;
  e.speed = mean_speed(beamline.source.speed);
  if (const auto* gaussian = std::get_if<GaussianSpeed>(&beamline.source.speed)) {
    e.speed_kind = SpeedKind::gaussian;
    e.speed_sigma = gaussian->sigma;
  }
  e.opening = aperture_of(0, beamline.source.opening, {});
  const DirectionLaw& direction = beamline.source.direction;
  if (const auto* gaussian = std::get_if<GaussianDirection>(&direction)) {
    e.direction = DirectionKind::gaussian;
    e.spread_x = gaussian->x;
    e.spread_z = gaussian->z;
  } else if (const auto* cone = std::get_if<ConeDirection>(&direction)) {
    e.direction = DirectionKind::cone;
    const double half = std::sin(cone->half_angle / 2);
    e.spread_x = 2 * half * half;
  } else if (const auto* aimed = std::get_if<AimedDirection>(&direction)) {
    e.direction = DirectionKind::aimed;
    e.target = target_of(beamline, aimed->target);
  }
  if (std::holds_alternative<QuantumLaw>(beamline.law)) e.levels = component.species.spin.twice + 1;
  return e;
}

}  // namespace rabiline
