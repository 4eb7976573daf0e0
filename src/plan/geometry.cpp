#include "plan/geometry.hpp"

namespace rabiline {

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

double mean_speed(const SpeedLaw& law) {
  if (const auto* single = std::get_if<SingleSpeed>(&law)) return single->value;
  return std::get<GaussianSpeed>(law).mean;
}

}  // namespace rabiline
