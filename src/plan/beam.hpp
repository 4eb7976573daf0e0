#pragma once
// Where the beam is before anything pushes it.
#include <vector>

#include "beamline/experiment.hpp"
#include "section/section.hpp"

namespace rabiline {

/// [m] The beam at one place: between two coordinates each.
struct BeamSpan {
  struct Span {
    double low, high;
    double middle() const { return (low + high) / 2; }
  };
  Span x, z;
  Offset centre() const { return {x.middle(), z.middle()}; }
  /// In the middle of the four sides.
  std::vector<Offset> sides() const;
};

/// [m] Where the middle of the source's opening looks.
Offset axis_of_beam(const Source&, double y);
/// At y: straight lines through the source's opening and, where they go apart, each of those behind it; a
/// beam of parallel lines is as wide as the narrowest opening.
BeamSpan beam_at(double y, const Beamline&, const Sections&);

}  // namespace rabiline
