// From parts to stages: parts contribute terms to sections, and each section gets the cheapest exact stage.
#include <algorithm>
#include <cassert>
#include <cmath>
#include <span>

#include "plan/free_flight.hpp"
#include "plan/geometry.hpp"
#include "plan/level_questions.hpp"
#include "plan/magnets.hpp"
#include "plan/plan.hpp"
#include "plan/regions.hpp"
#include "plan/set_spins.hpp"
#include "plan/spin_history.hpp"
#include "plan/tally_plan.hpp"
#include "plan/zones.hpp"
#include "section/magnet_field.hpp"

namespace rabiline {
namespace {

/// Compiles one chain; each member function adds stages for one thing.
class Compiler {
 public:
  Compiler(const Beamline& beamline, const Species& species, const ScreenGrids& grids, SampledTables& tables)
      : beamline_(beamline),
        grids_(grids),
        tables_(tables),
        species_(species),
        sections_(sections_of(beamline)),
        quantum_(law_traits(beamline.law).has_levels),
        turning_(turning_of(beamline.law, species)),
        zones_(zone_maker(beamline, species)),
        stretches_(flown_in_steps(stretches_of(beamline, species, sections_), beamline.law, species)),
        spins_(sections_, zones_, beamline.source, stretches_),
        straight_(turning_.rate_per_tesla == 0),
        questions_(beamline, species, sections_, spins_, straight_, tables),
        flight_(beamline, sections_, chain_) {
    if (spins_along_z(beamline.source.spin, quantum_)) outlook_.tip = 0;
    tables.of_parts.insert(tables.of_parts.end(), sections_.tables.begin(), sections_.tables.end());
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
  bool is_atom() const { return quantum_ && species_.structure.has_value(); }

  // ---- fields as the species sees them ----

  double speed() const { return mean_speed(beamline_.source.speed, species_.mass); }
  double slowest_speed() const {
    return std::visit([&](const auto& law) { return law.speed_range(species_.mass).slowest; },
                      beamline_.source.speed);
  }
  // ---- planes ----

  Screen screen_at(const Plane& plane) const {
    const std::string& name = beamline_.parts[static_cast<std::size_t>(plane.part)].placement.name;
    return screen_of(plane.y, plane.part, std::get<ScreenTerm>(plane.term), grids_.at(name));
  }

  void add_magnet(const MagnetTerm& magnet, const Plane& plane) {
    chain_.push_back(Drift{plane.y});
    std::vector<SpinZone> zones = quantum_ ? std::vector<SpinZone>{} : spins_.zones_before(plane);
    if (!zones.empty()) chain_.push_back(Precession{std::move(zones)});
    if (auto asked = questions_.at_plane(plane, spin_axis(magnet))) chain_.push_back(std::move(*asked));
    add_deflection(plane, magnet, species_, levels(), law_traits(beamline_.law).tolerance,
                   beamline_.chamber ? beamline_.chamber->radius : std::numeric_limits<double>::infinity(),
                   tables_, chain_);
    flight_.skip_to(magnet.end);
  }
  void aligned_along(const Vector3& axis) {
    outlook_.tip = 0;
    outlook_.aligned = axis;
  }
  /// The spin must be known where it is filtered: fields that a straight flight passed before act now.
  void add_filter(const FilterTerm& filter, const Plane& plane) {
    if (is_atom()) {
      if (auto asked = questions_.at_plane(plane, {})) chain_.push_back(std::move(*asked));
      chain_.push_back(level_filter_of(filter, plane, species_));
      return;
    }
    std::vector<SpinZone> zones = straight_ ? spins_.zones_before(plane) : std::vector<SpinZone>{};
    if (!zones.empty()) chain_.push_back(Precession{std::move(zones)});
    chain_.push_back(filter_of(filter, plane, species_, quantum_));
    outlook_.tip = 1;
  }
  void add_own_stage(const Plane& plane) {
    std::visit(
        [&](const auto& part) {
          if constexpr (requires(const StageSite& site) { stage_of(part, site); }) {
            const auto stage = stage_of(part, StageSite{plane.y, plane.part, species_});
            if constexpr (std::is_same_v<decltype(stage), const Attenuation>)
              flight_.fill(stage);
            else
              chain_.push_back(stage);
          }
        },
        beamline_.parts[static_cast<std::size_t>(plane.part)].part);
  }
  void add_plane(const Plane& plane) {
    const double before = flight_.reached();
    flight_.reach(plane.y);
    if (const auto* align = std::get_if<AlignTerm>(&plane.term)) {
      chain_.push_back(alignment_of(*align, plane, species_, quantum_));
      aligned_along(align->axis);
      return;
    }
    if (const auto* magnet = std::get_if<MagnetTerm>(&plane.term)) {
      add_magnet(*magnet, plane);
      return;
    }
    if (const auto* filter = std::get_if<FilterTerm>(&plane.term)) {
      add_filter(*filter, plane);
      return;
    }
    if (std::holds_alternative<OwnStageTerm>(plane.term)) {
      add_own_stage(plane);
      return;
    }
    if (const auto* monitor = std::get_if<MonitorTerm>(&plane.term)) {
      add_monitor(plane, *monitor);
      return;
    }
    if (const auto* plate = std::get_if<PlateTerm>(&plane.term)) {
      const bool was_wall = plate->length > 0 && before < plane.y;  // up to here, and asked about
      if (!was_wall) chain_.push_back(Passage{aperture_of(plane.y, *plate), plane.part});
    } else {
      chain_.push_back(Score{screen_at(plane)});
    }
  }

  // ---- tallies ----

  static Census census_of(const Plane& plane, const MonitorTerm& monitor) {
    return {aperture_of(plane.y, monitor.face, monitor.offset, monitor.tilt), plane.part, monitor.plane};
  }
  void add_monitor(const Plane& plane, const MonitorTerm& monitor) {
    const Census census = census_of(plane, monitor);
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
  Histogram tally_at(const Plane& plane, const Tally& tally, std::size_t number, const Aperture& face) const {
    Histogram histogram = histogram_of(tally, static_cast<int>(number), species_, levels());
    histogram.part = plane.part;
    histogram.pulse = draw_of(beamline_.source.pulse);
    if (const auto* monitor = std::get_if<MonitorTerm>(&plane.term)) histogram.plane = monitor->plane;
    histogram.face = face;
    return histogram;
  }
  void add_tallies(const Plane& plane, const std::vector<Tally>& tallies, const Aperture& face, bool caught,
                   bool of_spin) {
    for (std::size_t i = 0; i < tallies.size(); ++i) {
      if (asks_for_spin(tallies[i]) != of_spin) continue;
      Histogram histogram = tally_at(plane, tallies[i], i, face);
      histogram.caught = caught;
      if (of_spin && is_atom()) {
        histogram.spins.of_atom = true;
        questions_.carry_levels(plane, histogram.spins);
      } else if (of_spin && straight_) {
        histogram.spins.zones = zones_seen_by(histogram, plane);
        if (quantum_) histogram.spins.start = spins_.start_before(plane);
      }
      chain_.push_back(std::move(histogram));
    }
  }
  std::vector<SpinZone> zones_seen_by(const Histogram& histogram, const Plane& plane) const {
    const bool along_z = std::all_of(histogram.axes.begin(), histogram.axes.end(), [](const auto& axis) {
      return axis.quantity != Quantity::spin || (axis.direction[0] == 0 && axis.direction[1] == 0);
    });
    return quantum_ && along_z ? spins_.zones_before_levels(plane, {}) : spins_.zones_before(plane);
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
        fly_through_region(touching, coupling_of(beamline_, species_));
      else
        fly_straight_or_in_steps(touching);
      i = end;
    }
    add_planes_up_to(std::numeric_limits<double>::infinity());
    double end = 0;
    for (const PlacedPart& part : beamline_.parts) end = std::max(end, end_of(part));
    flight_.reach(end);
  }
  void add_planes_up_to(double y) {
    while (next_plane_ < sections_.planes.size() && sections_.planes[next_plane_].y <= y)
      add_plane(sections_.planes[next_plane_++]);
  }

  /// Under closure `torque` fields without a drive do nothing to spins along them.
  bool turns_velocity(std::span<const Section> touching) const {
    if (turning_.rate_per_tesla == 0) return false;
    const bool spins_aligned = turning_.take_off_spin_component && outlook_.tip == 0;
    return std::any_of(touching.begin(), touching.end(), [&](const Section& s) {
      if (s.needs_steps()) return true;
      if (std::any_of(s.rotating.begin(), s.rotating.end(), [](const auto& t) { return t.amplitude != 0; }))
        return true;
      const Vector3 field = zones_.static_field(s);
      return field != Vector3{} && !(spins_aligned && is_parallel(field, outlook_.aligned));
    });
  }

  /// Only where fields differ from place to place is a path that nothing turns flown in steps.
  void fly_straight_or_in_steps(std::span<const Section> touching) {
    for (std::size_t i = 0; i < touching.size();) {
      std::size_t end = i;
      while (end < touching.size() && is_flown_in_steps(touching[end])) ++end;
      if (end > i) {
        fly_in_steps(touching.subspan(i, end - i));
        i = end;
      } else {
        fly_straight_through(touching[i++]);
      }
    }
  }
  /// Where its levels stay coherent an atom flies straight, and they are carried when they are asked for.
  bool is_flown_in_steps(const Section& section) const {
    return std::ranges::any_of(stretches_, [&](const Stretch& stretch) {
      return stretch.begin <= section.begin && section.end <= stretch.end;
    });
  }
  void fly_in_steps(std::span<const Section> touching) {
    const double begin = touching.front().begin;
    const Stretch& stretch = *std::ranges::find(stretches_, begin, &Stretch::begin);
    add_planes_up_to(begin);
    flight_.reach(begin);
    if (!stretch.outlook.sorts) {
      std::vector<SpinZone> zones = spins_.zones_before(stretch);
      if (!zones.empty()) chain_.push_back(Precession{std::move(zones)});
      return fly_through_region(touching, coupling_of(beamline_, species_), stretch.outlook);
    }
    const Section& first =
        *std::ranges::find_if(touching, [](const Section& s) { return !s.shaped.empty(); });
    const Plane entrance{begin, first.shaped.front().part, MagnetTerm{stretch.end}};
    if (auto asked = questions_.at_plane(entrance, stretch.entrance)) chain_.push_back(std::move(*asked));
    fly_through_region(touching, level_coupling_of(beamline_, species_, stretch, tables_), stretch.outlook);
    TurningRegion region = std::move(std::get<TurningRegion>(chain_.back()));
    SortingField field{std::move(region), entrance.part, {}};
    if (stretch.exit != stretch.entrance) field.axis_behind = stretch.exit;
    chain_.back() = field;
    for (const WallStop& stop : field.stops_behind()) chain_.push_back(stop);
  }

  void fly_straight_through(const Section& section) {
    flight_.enter(section);
    add_planes_up_to(std::nextafter(section.end, section.begin));
    flight_.leave(section);
  }

  // ---- where fields turn the velocity ----

  RegionEdge region_edge(const Plane& plane) const {
    RegionEdge edge;
    edge.part = plane.part;
    if (const auto* align = std::get_if<AlignTerm>(&plane.term)) {
      edge.kind = EdgeKind::align;
      edge.align = alignment_of(*align, plane, species_, quantum_);
    } else if (const auto* plate = std::get_if<PlateTerm>(&plane.term)) {
      edge.kind = EdgeKind::plate;
      edge.plate = aperture_of(plane.y, *plate);
    } else {
      edge.kind = EdgeKind::screen;
      edge.screen = screen_at(plane);
    }
    return edge;
  }

  Sight sight_at(const Plane& plane, const MonitorTerm& monitor) const {
    Sight sight{census_of(plane, monitor), {}};
    for (std::size_t i = 0; i < monitor.tallies.size(); ++i)
      sight.tallies.push_back(tally_at(plane, monitor.tallies[i], i, sight.census.face));
    return sight;
  }

  /// One section of a region, cut at the planes inside it that do more than look.
  void add_section(const Section& section, RegionMaker& maker) {
    maker.begin(section);
    for (; next_plane_ < sections_.planes.size() && sections_.planes[next_plane_].y < section.end;
         ++next_plane_) {
      const Plane& plane = sections_.planes[next_plane_];
      if (const auto* monitor = std::get_if<MonitorTerm>(&plane.term))
        maker.look(sight_at(plane, *monitor));
      else
        maker.edge(plane.y, region_edge(plane));
    }
    maker.end();
  }

  void fly_through_region(std::span<const Section> touching, const FieldCoupling& feels,
                          const StretchOutlook& outlook = {}) {
    const double begin = touching.front().begin;
    flight_.reach(begin);
    chain_.push_back(Drift{begin});
    flight_.skip_to(touching.back().end);
    RegionMaker maker(turning_, zones_, speed(), speed() / slowest_speed(), outlook_, feels,
                      channels_of(sections_));
    for (const Section& section : touching) add_section(section, maker);
    chain_.push_back(maker.finish(outlook));
  }

  const Beamline& beamline_;
  const ScreenGrids& grids_;
  SampledTables& tables_;
  const Species& species_;
  const Sections sections_;
  const bool quantum_;
  const Turning turning_;
  const ZoneMaker zones_;
  const std::vector<Stretch> stretches_;
  const SpinHistory spins_;
  const bool straight_;  // nothing in the whole beam turns the velocity
  const LevelQuestions questions_;
  std::size_t next_plane_ = 0;
  SpinOutlook outlook_;
  std::vector<Stage> chain_;
  FreeFlight flight_;
};

}  // namespace

std::vector<Stage> compile(const Beamline& beamline, const Component& component, const ScreenGrids& grids,
                           SampledTables& tables) {
  return Compiler(beamline, component.species, grids, tables).compile();
}

std::vector<SpinZone> zones_along(const Beamline& beamline, const Component& component) {
  if (law_traits(beamline.law).has_levels && component.species.structure) return {};
  const ZoneMaker maker = zone_maker(beamline, component.species);
  std::vector<SpinZone> zones;
  for (const Section& section : sections_of(beamline).sections) {
    zones.push_back(maker.zone_of(section));
    maker.keep_tolerance(zones.back());
  }
  return zones;
}

}  // namespace rabiline
