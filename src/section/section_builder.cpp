#include "section/section_builder.hpp"

#include <algorithm>

#include "section/magnet_field.hpp"

namespace rabiline {
namespace {

constexpr double same_place = 1e-12;  // [m]

}  // namespace

void SectionBuilder::uniform(double begin, double end, UniformTerm term) {
  uniform_.push_back({{begin, end, part_}, term});
}
void SectionBuilder::oscillator(const std::string& name, Oscillator oscillator) {
  oscillator.part = part_;
  oscillators_[name] = oscillator;
}
void SectionBuilder::zone(double begin, double end, RotatingTerm term, const std::string& oscillator) {
  term.part = part_;
  zones_.push_back({{begin, end, part_}, {term, oscillator}});
}
void SectionBuilder::twisted(double begin, double end, const RotatingTerm& term) {
  if (atoms_) {
    const Vector3 first = term.amplitude * term.first, second = term.amplitude * term.second;
    ShapedTerm field(TwistedShape{{first.x, first.y, first.z}, {second.x, second.y, second.z}, term.twist});
    field.y = begin;
    return shaped(begin, end, field);
  }
  zone(begin, end, term, {});
}
void SectionBuilder::coil(double begin, double end, const CoilTerm& term) {
  coils_.push_back({{begin, end, part_}, term});
}
void SectionBuilder::shaped(double begin, double end, ShapedTerm term) {
  term.part = part_;
  shaped_.push_back({{begin, end, part_}, term});
}
void SectionBuilder::swinging(double begin, double end, ShapedTerm term, Oscillator oscillator) {
  term.part = oscillator.part = part_;
  swinging_.push_back({{begin, end, part_}, {{term, oscillator}, {}}});
}
void SectionBuilder::swinging(double begin, double end, ShapedTerm term, const std::string& oscillator,
                              double phase, double lag) {
  term.part = part_;
  swinging_.push_back({{begin, end, part_}, {{term, {.phase = phase, .lag = lag}}, oscillator}});
}
void SectionBuilder::electric(double begin, double end, ShapedTerm term) {
  term.part = part_;
  electric_.push_back({{begin, end, part_}, term});
}
void SectionBuilder::bore(double begin, double end, double radius, Offset offset) {
  bores_.push_back({{begin, end, part_}, {radius, part_, offset}});
}

RotatingTerm SectionBuilder::follow(const Zone& zone) const {
  RotatingTerm term = zone.term;
  if (zone.oscillator.empty()) return term;
  const double own = term.oscillator.phase;
  term.oscillator = oscillators_.at(zone.oscillator);
  term.oscillator.phase += own;
  return term;
}

SwingingTerm SectionBuilder::follow(const Swing& swing) const {
  SwingingTerm term = swing.term;
  if (swing.oscillator.empty()) return term;
  const Oscillator own = term.oscillator;
  term.oscillator = oscillators_.at(swing.oscillator);
  term.oscillator.phase += own.phase;
  term.oscillator.lag = own.lag;
  return term;
}

/// Places along the beam where something begins or ends, ascending. Places that decimal numbers mean to be
/// one, such as 0.2 m + 10 mm and 0.21 m, are one.
std::vector<double> SectionBuilder::edges() const {
  std::vector<double> edges;
  const auto add_edges = [&](const auto& contributions) {
    for (const auto& [extent, term] : contributions) edges.insert(edges.end(), {extent.begin, extent.end});
  };
  add_edges(uniform_);
  add_edges(zones_);
  add_edges(coils_);
  add_edges(shaped_);
  add_edges(swinging_);
  add_edges(electric_);
  add_edges(bores_);
  add_edges(gaps_);
  edges.insert(edges.end(), kinks_.begin(), kinks_.end());
  if (fall_end_ > 0) edges.insert(edges.end(), {0, fall_end_});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end(), [](double a, double b) { return b - a <= same_place; }),
              edges.end());
  return edges;
}

/// Whether a magnet has a fringe, another static field acts where it does, or the wall of one stands there.
bool SectionBuilder::is_among_fields(const Plane& plane) const {
  const MagnetTerm& magnet = std::get<MagnetTerm>(plane.term);
  if (!magnet.fringed.empty()) return true;
  const double begin = plane.y + same_place, end = magnet.end - same_place;
  const auto overlaps = [&](const auto& contributions, auto acts) {
    return std::ranges::any_of(contributions, [&](const auto& c) {
      return c.first.part != plane.part && c.first.begin < end && c.first.end > begin && acts(c.second);
    });
  };
  return fall_end_ > 0 ||
         overlaps(uniform_, [](const UniformTerm& term) { return term.field != Vector3{}; }) ||
         overlaps(coils_, [](const CoilTerm& coil) { return coil.angle != 0; }) ||
         overlaps(shaped_, [](const ShapedTerm&) { return true; }) ||
         overlaps(swinging_, [](const Swing&) { return true; }) ||
         overlaps(electric_, [](const ShapedTerm&) { return true; }) ||
         overlaps(bores_, [](const Wall&) { return true; }) ||
         std::ranges::any_of(planes_, [&](const Plane& other) {
           const auto* next = std::get_if<MagnetTerm>(&other.term);
           if (next == nullptr || other.part == plane.part) return false;
           return (other.y < end && next->end > begin) ||
                  std::ranges::any_of(next->fringed, [&](const PlacedTerm& term) {
                    return term.begin < end && term.end > begin;
                  });
         });
}

void SectionBuilder::make_field(const Plane& plane) {
  const MagnetTerm& magnet = std::get<MagnetTerm>(plane.term);
  const Extent extent{plane.y, magnet.end, plane.part};
  const auto is_its_own = [&](const auto& on_axis) { return on_axis.first.part == plane.part; };
  std::erase_if(uniform_, is_its_own);
  std::erase_if(shaped_, is_its_own);
  const auto add = [&](const Extent& where, ShapedTerm term) {
    term.part = plane.part;
    shaped_.push_back({where, term});
  };
  for (const auto& [begin, end, term] : magnet.fringed) add({begin, end, plane.part}, term);
  if (magnet.fringed.empty())
    for (const ShapedTerm& term : field_terms_of(magnet, plane.y)) add(extent, term);
  gaps_.push_back({extent, {magnet.walls, magnet.offset, magnet.tilt, magnet.shape.height, plane.part}});
}

Sections SectionBuilder::build(Magnets magnets) const {
  SectionBuilder all = *this;
  for (const Plane& plane : planes_)
    if (std::holds_alternative<MagnetTerm>(plane.term) &&
        (magnets == Magnets::fields || (magnets == Magnets::deflect && is_among_fields(plane))))
      all.make_field(plane);
  std::erase_if(all.planes_, [&](const Plane& plane) {
    return std::holds_alternative<MagnetTerm>(plane.term) &&
           (magnets != Magnets::deflect || is_among_fields(plane));
  });
  return all.cut();
}

Sections SectionBuilder::cut() {
  const std::vector<double> edges = this->edges();
  const auto snap = [&](double& y) {
    const auto next = std::lower_bound(edges.begin(), edges.end(), y - same_place);
    if (next != edges.end() && *next <= y + same_place) y = *next;
  };
  const auto snap_ends = [&](auto&... contributions) {
    const auto both = [&](Extent& e) { snap(e.begin), snap(e.end); };
    (std::ranges::for_each(contributions, [&](auto& one) { both(one.first); }), ...);
  };
  snap_ends(uniform_, zones_, coils_, shaped_, swinging_, electric_, gaps_, bores_);
  Sections result;
  result.tables = tables_;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    Section section{edges[i], edges[i + 1], {}, {}, {}, {}, {}, {}, {}, chamber_};
    const auto covers = [&](const Extent& e) { return e.begin <= section.begin && e.end >= section.end; };
    bool anything = false;
    for (const auto& [extent, term] : uniform_)
      if (covers(extent)) section.field = section.field + term.field, anything = true;
    for (const auto& [extent, zone] : zones_)
      if (covers(extent)) section.rotating.push_back(follow(zone)), anything = true;
    for (const auto& [extent, term] : coils_)
      if (covers(extent)) section.coils.push_back(term), anything = true;
    for (const auto& [extent, term] : shaped_)
      if (covers(extent)) section.shaped.push_back(term), anything = true;
    for (const auto& [extent, swing] : swinging_)
      if (covers(extent)) section.swinging.push_back(follow(swing)), anything = true;
    for (const auto& [extent, term] : electric_)
      if (covers(extent)) section.electric.push_back(term), anything = true;
    for (const auto& [extent, gap] : gaps_)
      if (covers(extent)) section.gaps.push_back(gap);
    for (const auto& [extent, wall] : bores_)
      if (covers(extent) && wall.radius < section.wall.radius) section.wall = wall, anything = true;
    section.falls_along = section.end <= fall_end_;
    if (anything || section.falls_along) result.sections.push_back(section);
  }
  result.planes = planes_;
  for (Plane& plane : result.planes) snap(plane.y);
  std::stable_sort(result.planes.begin(), result.planes.end(),
                   [](const Plane& a, const Plane& b) { return a.y < b.y; });
  return result;
}

}  // namespace rabiline
