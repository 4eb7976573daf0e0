#pragma once
// Fields that differ from place to place, as plain values: kernels of every instruction set read them.
// How large they are somewhere is in field/shaped_field.hpp.
#include "field/current_loop.hpp"
#include "field/flat_sheet.hpp"
#include "field/fringed_field.hpp"
#include "field/map_shape.hpp"
#include "field/multipole.hpp"
#include "field/straight_wire.hpp"
#include "field/time_course.hpp"
#include "field/twisted.hpp"

namespace rabiline {

enum class ShapedKind { linear, loop, sheet, flat_sheet, wire, multipole, fringed, map, round_map, twisted };

/// B = B_0 + G r, r from the origin of its frame.
struct LinearShape {
  double field[3];  // [T]
  double slope[9];  // [T/m] dB_i/dx_k at [3 i + k]
  bool operator==(const LinearShape&) const = default;
};

/// One field, in its own frame: an origin and three axes in the laboratory.
struct ShapedTerm {
  ShapedKind kind = ShapedKind::linear;          // which of the union
  double x = 0, y = 0, z = 0;                    // [m] the origin in the laboratory
  bool turned = false;                           // the axes are not those of the laboratory
  double axes[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  // its x, y and z axis, one after the other
  union {
    LinearShape linear = {};
    LoopShape loop;
    SheetShape sheet;
    FlatSheetShape flat_sheet;
    WireShape wire;
    MultipoleShape multipole;
    FringeShape fringed;
    MapShape map;
    RoundMapShape round_map;
    TwistedShape twisted;
  };
  TimeCourse course{};
  int part = 0;    // whose field it is
  int drive = -1;  // of its zone, with whose angle it swings; -1: of none
  bool moves() const { return drive >= 0 || course.nodes > 0; }

  ShapedTerm() : linear{} {}
  explicit ShapedTerm(const LinearShape& f) : kind(ShapedKind::linear), linear(f) {}
  explicit ShapedTerm(const LoopShape& f) : kind(ShapedKind::loop), loop(f) {}
  explicit ShapedTerm(const SheetShape& f) : kind(ShapedKind::sheet), sheet(f) {}
  explicit ShapedTerm(const FlatSheetShape& f) : kind(ShapedKind::flat_sheet), flat_sheet(f) {}
  explicit ShapedTerm(const WireShape& f) : kind(ShapedKind::wire), wire(f) {}
  explicit ShapedTerm(const MultipoleShape& f) : kind(ShapedKind::multipole), multipole(f) {}
  explicit ShapedTerm(const FringeShape& f) : kind(ShapedKind::fringed), fringed(f) {}
  explicit ShapedTerm(const MapShape& f) : kind(ShapedKind::map), map(f) {}
  explicit ShapedTerm(const RoundMapShape& f) : kind(ShapedKind::round_map), round_map(f) {}
  explicit ShapedTerm(const TwistedShape& f) : kind(ShapedKind::twisted), twisted(f) {}
};

/// Calls ask(shape) with the member of the union that a term has.
template <class Ask>
[[gnu::always_inline]] inline auto with_shape(const ShapedTerm& term, Ask ask) {
  switch (term.kind) {
    case ShapedKind::loop:
      return ask(term.loop);
    case ShapedKind::sheet:
      return ask(term.sheet);
    case ShapedKind::flat_sheet:
      return ask(term.flat_sheet);
    case ShapedKind::wire:
      return ask(term.wire);
    case ShapedKind::multipole:
      return ask(term.multipole);
    case ShapedKind::fringed:
      return ask(term.fringed);
    case ShapedKind::map:
      return ask(term.map);
    case ShapedKind::round_map:
      return ask(term.round_map);
    case ShapedKind::twisted:
      return ask(term.twisted);
    case ShapedKind::linear:
      break;
  }
  return ask(term.linear);
}

/// Whether two terms are the same, the active members of their unions included.
inline bool operator==(const ShapedTerm& a, const ShapedTerm& b) {
  for (int i = 0; i < 9; ++i)
    if (a.axes[i] != b.axes[i]) return false;
  if (a.kind != b.kind || a.x != b.x || a.y != b.y || a.z != b.z || a.part != b.part || a.drive != b.drive ||
      a.course != b.course)
    return false;
  switch (a.kind) {
    case ShapedKind::loop:
      return a.loop == b.loop;
    case ShapedKind::sheet:
      return a.sheet == b.sheet;
    case ShapedKind::flat_sheet:
      return a.flat_sheet == b.flat_sheet;
    case ShapedKind::wire:
      return a.wire == b.wire;
    case ShapedKind::multipole:
      return a.multipole == b.multipole;
    case ShapedKind::fringed:
      return a.fringed == b.fringed;
    case ShapedKind::map:
      return a.map == b.map;
    case ShapedKind::round_map:
      return a.round_map == b.round_map;
    case ShapedKind::twisted:
      return a.twisted == b.twisted;
    case ShapedKind::linear:
      break;
  }
  return a.linear == b.linear;
}

}  // namespace rabiline
