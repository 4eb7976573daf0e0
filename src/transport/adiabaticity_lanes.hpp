#pragma once
// How slowly a static field turns for a particle that flies through it, against its spin: for kernels only.
#include "field/lane_maths.hpp"
#include "transport/shaped_lanes.hpp"
#include "transport/visit_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// The smallest adiabaticity of the lanes of one pack so far, and where it was.
class Adiabaticity {
 public:
  Adiabaticity(const Region& region, const RegionZone& zone, const BatchView& batch, int row)
      : region_(region), zone_(zone), least_(batch.adiabaticity + row), place_(batch.adiabaticity_y + row) {}

  /// Over one step, along which the field is the cubic through its values and slopes at both ends: the
  /// smallest |w| |B|^2/|B x dB/dt|, w = -gamma B, at some of its points.
  void watch(const State& from, const State& to, mask chosen) {
    constexpr int points = 64;
    const Turning a = at(from), b = at(to);
    const real h = to.t - from.t, per_h = 1.0 / select(h != broadcast(0), h, broadcast(1));
    real least = load(least_), place = load(place_);
    for (int i = 0; i <= points; ++i) {
      const double s = static_cast<double>(i) / points, u = 1 - s;
      const Vector field = sum(a.field, u * u * (1 + 2 * s), b.field, s * s * (1 + 2 * u), a.change,
                               s * u * u * h, b.change, -s * s * u * h);
      const Vector change = sum(a.field, -6 * s * u * per_h, b.field, 6 * s * u * per_h, a.change,
                                broadcast(u * (1 - 3 * s)), b.change, broadcast(s * (s - 2 * u)));
      const Vector turns = cross(field, change);
      const real size2 = dot(field, field), turning = sqrt(dot(turns, turns));
      const double gamma = __builtin_fabs(region_.feels.spin_per_tesla);
      const real value = select(turning > broadcast(0),
                                gamma * size2 * sqrt(size2) / select(turning > broadcast(0), turning, size2),
                                broadcast(no_turning));
      const mask smaller = chosen & (value < least);
      least = select(smaller, value, least);
      place = select(smaller, fma(broadcast(s), to.place.y - from.place.y, from.place.y), place);
    }
    store(least_, least);
    store(place_, place);
  }

 private:
  struct Turning {
    Vector field, change;  // [T], [T/s]
  };
  inline Turning at(const State& s) const {
    FieldHere<real> here{};
    Vector change{broadcast(0), broadcast(0), broadcast(0)};
    // Rounding would find the field absent where its map ends.
    const double hair = 1e-9 * (zone_.field.end - zone_.field.begin);
    const Vector inside{
        s.place.x,
        max(broadcast(zone_.field.begin + hair), min(broadcast(zone_.field.end - hair), s.place.y)),
        s.place.z};
    for (int i = zone_.shaped_begin; i < zone_.shaped_end; ++i)
      if (region_.shaped[i].drive < 0)
        change = add(change, broadcast(1),
                     add_field_at(region_.shaped[i], zone_.field, nullptr, s.t, inside, here));
    const real *b = here.field, *g = here.slope;
    const double* uniform = zone_.uniform;
    const Vector& v = s.velocity;
    const auto along = [&](int k, const real& in_time) {
      return fma(g[k], v.x, fma(g[k + 1], v.y, fma(g[k + 2], v.z, in_time)));
    };
    return {{b[0] + uniform[0], b[1] + uniform[1], b[2] + uniform[2]},
            {along(0, change.x), along(3, change.y), along(6, change.z)}};
  }
  template <class Weight, class Slope>
  static Vector sum(const Vector& a, Weight wa, const Vector& b, Weight wb, const Vector& da, Slope wda,
                    const Vector& db, Slope wdb) {
    return {wa * a.x + wb * b.x + wda * da.x + wdb * db.x, wa * a.y + wb * b.y + wda * da.y + wdb * db.y,
            wa * a.z + wb * b.z + wda * da.z + wdb * db.z};
  }

  const Region& region_;
  const RegionZone& zone_;
  double *least_, *place_;
};

}  // namespace rabiline::RABILINE_ISA
