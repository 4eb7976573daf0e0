#pragma once
// Tables of B on regular grids: the coefficients of their splines, and what they say of their own quality.
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "field/map_shape.hpp"

namespace rabiline {

/// How B or E continues behind a plane at zero of an axis that the map ends at.
enum class MapSymmetry {
  none,
  same_currents,      // currents mirror into themselves: B across the plane is even, along it odd
  opposite_currents,  // they change sign: B across the plane is odd, along it even
  same_charges,       // charges mirror into themselves: E across the plane is odd, along it even
  opposite_charges    // they change sign: E across the plane is even, along it odd
};

/// Places i h from the first node on, n of them.
struct MapAxis {
  int nodes = 0;
  double begin = 0, step = 0;  // [m]
  double end() const { return begin + step * (nodes - 1); }
  bool operator==(const MapAxis&) const = default;
};

/// What no number of a map is beyond, in SI: sums of larger ones may be none.
inline constexpr double largest_of_map = 1e300;

/// The axis of places that ascend in even steps, to 1e-6 of a step; nothing, and `why`, where they do not.
std::optional<MapAxis> even_axis(const std::vector<double>& places, std::string_view name, std::string& why);

/// B at the nodes of a grid as it was read: component m of node (i, j, k) at ((i n_y + j) n_z + k) 3 + m. Of
/// a field about an axis: axes r, z, components B_r, B_z, at (i n_z + k) 2 + m.
struct MapNodes {
  std::vector<MapAxis> axes;
  std::vector<double> field;  // [T], or [V/m]
  bool electric = false;      // it is E
};

/// Of the cubic B-spline through four values or more at even steps, not-a-knot at the ends: one more at each
/// end.
std::vector<double> spline_coefficients(const std::vector<double>& values);

/// Owns the table that terms point into.
class FieldMap {
 public:
  /// Mirrors the nodes at planes of symmetry (z = 0 alone of a field about an axis, which is mirrored at
  /// that, too) and finds the splines' coefficients. Each axis has four nodes or more then.
  FieldMap(MapNodes, const std::array<MapSymmetry, 3>&, std::string path);

  const std::string& path() const { return path_; }
  bool is_electric() const { return electric_; }
  bool is_round() const { return axes_.size() == 2; }
  /// After mirroring; of a field about an axis r begins below zero.
  const std::vector<MapAxis>& axes() const { return axes_; }
  std::size_t bytes() const { return table_.size() * sizeof(double); }
  MapShape shape(double factor, MapOutside) const;
  RoundMapShape round_shape(double factor, MapOutside) const;
  /// The map of every second node; empty axes where it has too few.
  bool can_be_halved() const;
  FieldMap halved() const;

  bool operator==(const FieldMap& o) const { return this == &o; }

 private:
  std::string path_;
  bool electric_;
  std::vector<MapAxis> axes_;
  std::vector<double> table_;
};

/// The largest and the root of the mean square.
struct Spread {
  double largest = 0, rms = 0;
};
/// What a map says of itself, relative to its largest |B|; div and curl at the middles of its cells times the
/// step over that.
struct MapQuality {
  double largest_field = 0;  // [T]
  bool halved = false;       // enough nodes for an estimate
  Spread error;              // of B: the map of every second node at the ones between, over 16
  bool noisy = false;        // that does not fall as the fourth power of the step: not divided then
  Spread divergence, curl;
};
MapQuality quality_of(const FieldMap&);

}  // namespace rabiline
