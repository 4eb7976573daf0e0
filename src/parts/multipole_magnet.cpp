#include "parts/multipole_magnet.hpp"

#include "parts/magnet_rules.hpp"
#include "parts/own_frame.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

void contribute(const MultipoleMagnet& part, const Placement& place, SectionBuilder& builder) {
  MagnetTerm term{place.at + part.length, {}, {}, part.offset, {}};
  term.shape.kind = MagnetKind::multipole;
  term.shape.field = part.pole_field;
  term.shape.power = static_cast<int>(part.poles) / 2 - 1;
  term.shape.radius = part.radius;
  term.walls.circles[0] = {0, 0, part.radius, -1};
  contribute_magnet(
      term, part.fringe, place, {},
      [&](FringedField& whole) {
        whole.add_poles({term.shape.power, part.pole_field, part.radius}, {{0, 0, 1}, {1, 0, 0}, {0, 1, 0}});
      },
      builder);
}

std::vector<Fault> faults_of(const MultipoleMagnet& part, const Placement& place) {
  std::vector<Fault> out = faults_of_poles(part.poles, place);
  for (Fault& fault : faults_of_fringe(part.fringe, RectangularProfile{}, place))
    out.push_back(std::move(fault));
  return out;
}

}  // namespace rabiline
