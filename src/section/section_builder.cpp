#include "section/section_builder.hpp"

#include <algorithm>

namespace rabiline {

void SectionBuilder::uniform(double begin, double end, UniformTerm term) {
  uniform_.push_back({{begin, end, part_}, term});
}
void SectionBuilder::oscillator(const std::string& name, RotatingTerm clock) {
  clock.oscillator = part_;
  oscillators_[name] = clock;
}
void SectionBuilder::zone(double begin, double end, double amplitude, double phase,
                          const std::string& oscillator) {
  zones_.push_back({{begin, end, part_}, {amplitude, phase, oscillator}});
}
void SectionBuilder::bore(double begin, double end, double radius) {
  bores_.push_back({{begin, end, part_}, radius});
}

RotatingTerm SectionBuilder::follow(const Zone& zone) const {
  RotatingTerm term = oscillators_.at(zone.oscillator);
  term.amplitude = zone.amplitude;
  term.phase += zone.phase;
  return term;
}

Sections SectionBuilder::build() const {
  std::vector<double> edges;
  const auto add_edges = [&](const auto& contributions) {
    for (const auto& [extent, term] : contributions) edges.insert(edges.end(), {extent.begin, extent.end});
  };
  add_edges(uniform_);
  add_edges(zones_);
  add_edges(bores_);
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());

  Sections result;
  for (std::size_t i = 0; i + 1 < edges.size(); ++i) {
    Section section{edges[i], edges[i + 1], 0, {}, chamber_};
    const auto covers = [&](const Extent& e) { return e.begin <= section.begin && e.end >= section.end; };
    bool anything = false;
    for (const auto& [extent, term] : uniform_)
      if (covers(extent)) section.field += term.field, anything = true;
    for (const auto& [extent, zone] : zones_)
      if (covers(extent)) section.rotating.push_back(follow(zone)), anything = true;
    for (const auto& [extent, radius] : bores_)
      if (covers(extent) && radius < section.wall.radius)
        section.wall = {radius, extent.part}, anything = true;
    if (anything) result.sections.push_back(section);
  }
  result.planes = planes_;
  std::stable_sort(result.planes.begin(), result.planes.end(),
                   [](const Plane& a, const Plane& b) { return a.y < b.y; });
  return result;
}

}  // namespace rabiline
