#include "face/points.hpp"

#include "core/version.hpp"
#include "simulation/append.hpp"

namespace rabiline {

TakePoints take_points(const RunSettings& settings, Effects& effects) {
  return [&](Result& points) {
    effects.add(points);
    if (!settings.points) return;
    points.provenance.version = version;
    settings.points(points);
    keep_totals(points);
  };
}

}  // namespace rabiline
