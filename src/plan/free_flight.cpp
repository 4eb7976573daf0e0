#include "plan/free_flight.hpp"

#include <algorithm>

#include "field/shaped_field.hpp"
#include "plan/geometry.hpp"

namespace rabiline {
namespace {

constexpr double slack = 1e-12;  // [m] places closer than that are one

/// A parallel beam from inside the chamber.
bool stays_where_it_starts(const Source& source) {
  return std::holds_alternative<ParallelDirection>(source.direction) && source.tilt == SourceTilt{} &&
         !std::holds_alternative<GaussianSpot>(source.opening);
}

/// Whether paths through a section may end at a bore, at poles or where a map ends.
bool has_walls(const Section& section) {
  return section.wall.part != chamber_number || !section.gaps.empty() ||
         std::ranges::any_of(section.shaped,
                             [](const ShapedTerm& term) { return nothing_may_leave(term); }) ||
         std::ranges::any_of(section.swinging,
                             [](const SwingingTerm& term) { return nothing_may_leave(term.field); });
}

}  // namespace

FreeFlight::FreeFlight(const Beamline& beamline, const Sections& sections, std::vector<Stage>& chain)
    : beamline_(beamline),
      channels_(channels_of(sections)),
      chain_(chain),
      may_reach_chamber_(beamline.gravity || !stays_where_it_starts(beamline.source)) {}

/// The round wall, then channels, without those that others stand inside of.
std::vector<FreeFlight::Barrier> FreeFlight::walls_up_to(double y) const {
  std::vector<Barrier> walls;
  const auto round = [&](const Wall& wall) {
    walls.push_back({aperture_of(y, Disc{wall.radius}, wall.offset), wall.part});
  };
  if (section_ != nullptr && section_->wall.part != chamber_number)
    round(section_->wall);
  else if (beamline_.chamber && may_reach_chamber_)
    round({beamline_.chamber->radius, chamber_number});
  for (const ChannelStretch& c : channels_)
    if (c.begin <= reached_ + slack && c.end >= y - slack) walls.push_back({c.opening(y), c.channel.part});
  for (std::size_t k = walls.size(); k-- > 0;)
    if (std::any_of(walls.begin(), walls.end(), [&](const Barrier& other) {
          return &other != &walls[k] && lies_in(other.opening, walls[k].opening);
        }))
      walls.erase(walls.begin() + static_cast<std::ptrdiff_t>(k));
  return walls;
}

void FreeFlight::attenuate_up_to(double y, const std::vector<Aperture>& walls) {
  for (const Attenuation& gas : gases_) {
    Attenuation here = gas.between(reached_, y);
    if (!(here.length > slack)) continue;
    here.walls = walls;
    chain_.push_back(std::move(here));
  }
}

void FreeFlight::keep_inside(double y, const std::vector<Aperture>& walls) {
  if (section_ == nullptr) return;
  for (const GapTerm& gap : section_->gaps)
    chain_.push_back(Bounds{{gap.part, reached_}, y, gap_of(gap), walls});
  const auto keep = [&](const ShapedTerm& term) {
    if (nothing_may_leave(term)) chain_.push_back(Bounds{{term.part, reached_}, y, term, walls});
  };
  std::ranges::for_each(section_->shaped, keep);
  std::ranges::for_each(section_->swinging, keep, &SwingingTerm::field);
}

/// Of several walls each is asked about once, beside those that have not been asked about yet.
void FreeFlight::reach(double y) {
  if (!(y > reached_)) return;
  const std::vector<Barrier> walls = walls_up_to(y);
  std::vector<Aperture> openings(walls.size());
  std::ranges::transform(walls, openings.begin(), &Barrier::opening);
  attenuate_up_to(y, openings);
  keep_inside(y, openings);
  for (const Barrier& wall : walls) {
    openings.erase(openings.begin());
    chain_.push_back(Passage{wall.opening, wall.part, reached_, openings});
  }
  reached_ = y;
}

/// A section without a wall of its own is as what is around it.
void FreeFlight::enter(const Section& section) {
  if (!has_walls(section)) return;
  reach(section.begin);
  section_ = &section;
  const Wall& wall = section.wall;
  if (wall.part != chamber_number)
    chain_.push_back(Passage{aperture_of(section.begin, Disc{wall.radius}, wall.offset), wall.part});
}
void FreeFlight::leave(const Section& section) {
  if (section_ == nullptr) return;
  reach(section.end);
  section_ = nullptr;
}

void FreeFlight::skip_to(double y) {
  attenuate_up_to(y, {});
  reached_ = std::max(reached_, y);
  may_reach_chamber_ = true;
}

}  // namespace rabiline
