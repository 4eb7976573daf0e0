#pragma once
#include <array>
#include <memory>
#include <string>

#include "field/field_map.hpp"
#include "parts/placement.hpp"
#include "parts/time_factor.hpp"

namespace rabiline {

class SectionBuilder;
struct OwnFrame;

template <>
inline constexpr auto choices<MapSymmetry> = std::array{
    Choice<MapSymmetry>{"none", MapSymmetry::none, "the map has no plane of symmetry there"},
    Choice<MapSymmetry>{
        "same_currents", MapSymmetry::same_currents,
        "currents mirror into themselves: the field across the plane is even, that along it odd"},
    Choice<MapSymmetry>{
        "opposite_currents", MapSymmetry::opposite_currents,
        "currents change sign in the mirror: the field across the plane is odd, that along it even"},
    Choice<MapSymmetry>{
        "same_charges", MapSymmetry::same_charges,
        "charges mirror into themselves: the electric field across the plane is odd, that along it even"},
    Choice<MapSymmetry>{
        "opposite_charges", MapSymmetry::opposite_charges,
        "charges change sign in the mirror: the electric field across the plane is even, that along it odd"},
};
template <>
inline constexpr auto choices<MapOutside> = std::array{
    Choice<MapOutside>{"zero", MapOutside::zero, "no field there"},
    Choice<MapOutside>{"error", MapOutside::error, "what flies there is lost"},
    Choice<MapOutside>{"clamp", MapOutside::clamp, "the field of the nearest place of the map"},
};

/// Which file a map is in, and how it goes on behind planes at zero of its axes.
struct MapFile {
  static constexpr std::string_view example = "file: quadrupole.csv";
  std::string file;
  MapSymmetry x = MapSymmetry::none, y = MapSymmetry::none, z = MapSymmetry::none;
  bool operator==(const MapFile&) const = default;
};
template <>
inline constexpr auto parameters<MapFile> = std::tuple{
    param("file", &MapFile::file, "path of a CSV or HDF5 file, from the beamline file's folder on"),
    param("x", &MapFile::x, "how the field goes on behind the plane x = 0, where the map ends there",
          MapSymmetry::none),
    param("y", &MapFile::y, "likewise behind y = 0", MapSymmetry::none),
    param("z", &MapFile::z, "likewise behind z = 0, of a map in r and z as well", MapSymmetry::none),
};
/// The map itself, which lives as long as any beamline that has it.
struct LoadedMap {
  std::shared_ptr<const FieldMap> map;
  bool operator==(const LoadedMap& o) const { return map == o.map; }
};

/// A field from a table: measured, or computed by another program. Its origin is at `at` on the beam,
/// displaced by the offset; a map in r and z is about `direction`.
struct MappedField {
  static constexpr std::string_view kind = "field_map",
                                    meaning =
                                        "a field, B or E, from a table on a regular grid, x, y, z or r, z";
  static constexpr std::string_view place =
      "where the origin of the map (x, y, z = 0 of its table) stands on the beam, from the source; the field "
      "reaches as far before and behind it as the table does";
  static constexpr PartTraits traits{.field = true};
  static constexpr std::string_view example = "map: quadrupole.csv";
  LoadedMap map;
  double scale = 1;
  MapOutside outside = MapOutside::zero;
  UnitVector direction{0, 1, 0};
  Offset offset{};
  Tilt tilt{};
  std::optional<TimeFactor> oscillates{};
  bool is_electric() const { return map.map && map.map->is_electric(); }
  bool operator==(const MappedField&) const = default;
};
template <>
inline constexpr auto parameters<MappedField> = std::tuple{
    param("map", &MappedField::map, "file of the map, or file and planes of symmetry"),
    param("scale", &MappedField::scale, Dimension::number, range::any, "factor of the whole field", 1.0),
    param("outside", &MappedField::outside, "the field beside the map; none if omitted", MapOutside::zero),
    param("direction", &MappedField::direction, "of the axis z of a map in r and z; the beam's if omitted",
          UnitVector{0, 1, 0}),
    param("offset", &MappedField::offset, "displacement of the map's origin from the axis", Offset{}),
    param("tilt", &MappedField::tilt, "how the map is turned about its origin, field and all", Tilt{}),
    param("oscillates", &MappedField::oscillates,
          "frequency and phase with which the whole field swings; it stands if omitted"),
};

void contribute(const MappedField&, const Placement&, SectionBuilder&);
std::vector<Fault> faults_of(const MappedField&, const Placement&);
/// What the field of a map follows in time, if anything.
struct MapMotion {
  std::optional<Oscillator> clock{};
  TimeCourse course{};
};
/// Where that frame has the map.
void contribute_map(const FieldMap&, double scale, MapOutside, const MapMotion&, const OwnFrame&,
                    const Offset&, const Placement&, SectionBuilder&);

}  // namespace rabiline
