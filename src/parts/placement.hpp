#pragma once
// What every part has, whatever its kind: a name and a place on the beam.
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/fault.hpp"
#include "core/vector3.hpp"
#include "particle/opening.hpp"

namespace rabiline {

/// The static field of a part, where it begins.
struct StaticField {
  Vector3 field;           // [T]
  std::string_view blame;  // the key that turns it away from +z
  bool turns = false;      // its direction changes along the beam
};

/// What a kind of part says of itself, so that nobody needs a list of kinds: `static constexpr PartTraits
/// traits`.
struct PartTraits {
  bool field = false;        // a field fills its length
  bool homogeneous = false;  // a static field that is the same everywhere in it
  bool deflects = false;     // by the gradient of its field
  bool drives = false;       // its field has a clock: it can drive transitions
  bool target = false;       // a source may be aimed at it
  bool one_way = false;      // what it does depends on how often and in which direction it is passed
  bool sets_spins = false;   // it aligns, turns or filters them by itself, whatever its field
};

struct Placement {
  std::string name;                  // [A-Za-z][A-Za-z0-9_]*
  double at = 0;                     // [m] where the part begins, from the source's opening
  std::optional<std::string> label;  // how plots call it
  bool enabled = true;               // else the beam flies as if it were absent
  bool operator==(const Placement&) const = default;
};
template <>
inline constexpr auto parameters<Placement> = std::tuple{
    param("name", &Placement::name, "how --set, --scan and results call the part"),
    param("at", &Placement::at, Dimension::length, range::not_negative,
          "where the part begins, from the source"),
    param("label", &Placement::label, "how plots call the part; the name if omitted"),
    param("enabled", &Placement::enabled, "false: as if the part were absent", true),
};

/// Names that no part can have.
std::vector<Fault> faults_of(const Placement&);
/// Whether a name is a letter, then letters, digits or `_`, at most 64.
bool is_well_formed(std::string_view name);
/// Words that a part may not be called, because dotted names or results mean something else by them.
bool is_reserved(std::string_view name);

/// A round wall along a field: what touches it stops there.
struct Bore {
  double radius = 0;  // [m]
  bool operator==(const Bore&) const = default;
};
template <>
inline constexpr auto parameters<Bore> = std::tuple{
    param("radius", &Bore::radius, Dimension::length, range::positive,
          "radius of the free bore around the axis"),
};

inline Vector3 turned(const Vector3& v, const Tilt& tilt) { return turned(v, tilt.x, tilt.y, tilt.z); }

}  // namespace rabiline
