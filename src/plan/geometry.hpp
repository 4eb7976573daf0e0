#pragma once
// Openings and screens as kernels see them.
#include "particle/source.hpp"
#include "parts/part.hpp"
#include "section/section.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

Aperture aperture_of(double y, const Opening&, const Offset&);
Screen screen_of(double y, int part, const ScreenTerm&);
/// The mean of a law of speeds [m/s]: what steps, costs and derived numbers are reckoned with.
double mean_speed(const SpeedLaw&);

}  // namespace rabiline
