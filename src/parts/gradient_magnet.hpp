#pragma once
#include "parts/fringe.hpp"
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A deflecting magnet with a constant gradient: B_z = field + gradient s along `along`, and F = mu_z dB_z/ds
/// on the moment's part along z. Under `quantum` a particle is in one level all along, drawn where it enters;
/// under `classical` its S_z stays what it is. A level of a species with structure feels mu(|B|) grad |B|.
/// The hypothesis replaces this force, so there the field is uniform. Its gap is a wall. With a fringe it is
/// followed as any field that differs from place to place.
struct GradientMagnet {
  static constexpr std::string_view kind = "gradient_magnet",
                                    meaning =
                                        "a deflecting magnet: a field along z with a constant gradient; "
                                        "under dorado a uniform field";
  static constexpr PartTraits traits{.field = true, .deflects = true};
  double length = 0;    // [m]
  double field = 0;     // [T] along +z, in the middle
  double gradient = 0;  // [T/m] of B_z
  UnitVector along{};   // across the beam
  std::optional<Rectangle> gap{};
  Offset offset{};
  Fringe fringe{};
  bool operator==(const GradientMagnet&) const = default;
};
template <>
inline constexpr auto parameters<GradientMagnet> = std::tuple{
    param("length", &GradientMagnet::length, Dimension::length, range::positive, "extent along the beam"),
    param("field", &GradientMagnet::field, Dimension::magnetic_field, range::any,
          "field along +z in the middle, on the beam's axis where there is no `offset`"),
    param("gradient", &GradientMagnet::gradient, Dimension::field_gradient, range::any,
          "by which that field grows along `along`, e.g. 1000 T/m"),
    param("along", &GradientMagnet::along, "direction of the gradient, across the beam; z if omitted",
          UnitVector{}),
    param("gap", &GradientMagnet::gap, "width and height between the walls; none if omitted"),
    param("offset", &GradientMagnet::offset,
          "displacement of the magnet, its field and its gap, from the beam's axis", Offset{}),
    param("fringe", &GradientMagnet::fringe,
          "how the field ends at both ends, followed in steps; at once if omitted, in closed form",
          Fringe{HardFringe{}}),
};

StaticField static_field(const GradientMagnet&);
void contribute(const GradientMagnet&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const GradientMagnet&, const Placement&);

}  // namespace rabiline
