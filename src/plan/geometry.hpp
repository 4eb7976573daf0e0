#pragma once
// Openings and screens as kernels see them.
#include <map>
#include <string>
#include <vector>
#include "particle/source.hpp"

#include "beamline/experiment.hpp"
#include "parts/part.hpp"
#include "section/section.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

Aperture aperture_of(double y, const Opening&, const Offset&, const Roll& = {});
/// Of a plate, or of a beam stop.
Aperture aperture_of(double y, const PlateTerm&);
/// Area of an opening [m^2].
double area_of(const Aperture&);
/// Whether all of one opening lies in the other one: discs or rectangles.
bool lies_in(const Aperture& inner, const Aperture& outer);

/// The rectangle around a face, along its own axes.
Rectangle extent_of(const Face&);

/// The rectangle [m] that a detector's histogram covers at every point of a scan. Of a detector that the scan
/// moves, it is counted from the detector's centre and moves with it.
struct ScreenGrid {
  double low_x, high_x, low_z, high_z;
  bool moves = false;
  bool operator==(const ScreenGrid&) const = default;
};
using ScreenGrids = std::map<std::string, ScreenGrid>;  // by the detector's name
ScreenGrids screen_grids(const ScanPoints& points);

Screen screen_of(double y, int part, const ScreenTerm&, const ScreenGrid&);

/// [m] Half of the beam at a place, along x and z.
struct HalfSizes {
  double x, z;
};
HalfSizes halves_of(const SourceOpening&);

}  // namespace rabiline
