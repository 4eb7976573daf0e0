#pragma once
// How a static field ends along the beam.
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "field/magnet_shape.hpp"
#include "field/shaped_term.hpp"
#include "parameter/parameter.hpp"
#include "parts/field_gradient.hpp"
#include "parts/placement.hpp"
#include "parts/profile.hpp"

namespace rabiline {

class SectionBuilder;
struct MagnetTerm;
struct Oscillator;
struct OwnFrame;
struct PlacedTerm;

struct HardFringe {
  static constexpr std::string_view kind = "hard", meaning = "the field ends at once";
  bool operator==(const HardFringe&) const = default;
};
/// (1 - tanh s)/2.
struct TanhFringe {
  static constexpr std::string_view kind = "tanh",
                                    meaning =
                                        "(1 - tanh(s))/2, s outwards from the edge in units of `length`";
  double length = 0;  // [m]
  bool operator==(const TanhFringe&) const = default;
};
template <>
inline constexpr auto parameters<TanhFringe> = std::tuple{
    param("length", &TanhFringe::length, Dimension::length, range::positive,
          "the field is at 88 % a length inside the edge and at 12 % a length outside"),
};
/// The curve: H. A. Enge, in Focusing of Charged Particles, vol. 2, ed. A. Septier (1967).
struct EngeFringe {
  static constexpr std::string_view kind = "enge",
                                    meaning =
                                        "Enge's curve 1/(1 + exp(a0 + a1 s + ... + a5 s^5)), s outwards from "
                                        "the edge in units of `length`, the gap";
  static constexpr std::string_view example = "length: 12 mm";
  double length = 0;  // [m]
  std::optional<double> a0{}, a1{}, a2{}, a3{}, a4{}, a5{};
  bool operator==(const EngeFringe&) const = default;
};
template <>
inline constexpr auto parameters<EngeFringe> = std::tuple{
    param("length", &EngeFringe::length, Dimension::length, range::positive, "unit of s: the magnet's gap"),
    param("a0", &EngeFringe::a0, Dimension::number, range::any,
          "constant in the exponent: 0.478959 where none of a0 to a5 is stated; where any is, the others are "
          "0"),
    param("a1", &EngeFringe::a1, Dimension::number, range::any, "coefficient of s, likewise: 1.911289 or 0"),
    param("a2", &EngeFringe::a2, Dimension::number, range::any,
          "coefficient of s^2, likewise: -1.185953 or 0"),
    param("a3", &EngeFringe::a3, Dimension::number, range::any,
          "coefficient of s^3, likewise: 1.630554 or 0"),
    param("a4", &EngeFringe::a4, Dimension::number, range::any,
          "coefficient of s^4, likewise: -1.082657 or 0"),
    param("a5", &EngeFringe::a5, Dimension::number, range::any,
          "coefficient of s^5, likewise: 0.318111 or 0"),
};
struct SineFringe {
  static constexpr std::string_view kind = "sine",
                                    meaning = "half a sine from the full field to none, over `length`";
  double length = 0;  // [m]
  bool operator==(const SineFringe&) const = default;
};
template <>
inline constexpr auto parameters<SineFringe> = std::tuple{
    param("length", &SineFringe::length, Dimension::length, range::positive,
          "from the full field to none; the edge is in its middle"),
};
using Fringe = std::variant<HardFringe, TanhFringe, EngeFringe, SineFringe>;

/// The curve of a profile that is not rectangular, else of a fringe that is not hard; without size and
/// length.
FringeShape shape_of(const Fringe&, const AmplitudeProfile&);
/// Whether a field has hard edges and one size.
bool is_boxed(const Fringe&, const AmplitudeProfile&);

/// Adds fields of some curve along the beam, along, across and about it each as Maxwell's equations have it,
/// with the middle of their axis on the offset axis.
class FringedField {
 public:
  /// `beside`: how much farther along the beam its edges may come where it is tilted [m].
  FringedField(const FringeShape&, double at, double length, const Offset&, double beside = 0);

  /// `field` [T] is that in the middle between the edges, and `slopes` [T/m], dB_i/dx_k at [3 i + k], how it
  /// would grow from there on if it had no edges.
  void add(const Vector3& field, const FieldSlopes& slopes = {});
  /// `field` turns along the beam by `turn` [rad/m]: this is its part that runs as cos(turn y + phase), y
  /// from the middle.
  void add_turning(const Vector3& field, double turn, double phase);
  /// Poles about the beam, B_x - i B_y = B_0 ((x + i y)/R)^p in the x and y axis of a frame whose third one
  /// is that of the poles.
  void add_poles(const MultipoleShape&, const OwnFrame&);
  /// Two wires, as in the x and z axis of MagnetShape's two wires: of a frame whose third axis is along the
  /// beam, the first one that way and the second one across.
  void add_wires(const MagnetShape&, const OwnFrame&);

  void contribute(SectionBuilder&, const std::optional<Oscillator>& clock = std::nullopt) const;
  /// Swinging by that oscillator, with a phase of its own and what it lags in the sense of turning.
  void contribute_swinging(SectionBuilder&, const std::string& oscillator, double phase, double lag) const;
  void contribute_electric(SectionBuilder&) const;
  /// The terms that it adds up to.
  std::vector<PlacedTerm> terms() const;

 private:
  void add_term(FringeShape, double even, double growth, const Vector3& x);

  FringeShape shape_;
  double begin_, end_;  // [m], where it is there
  Vector3 middle_;
  std::vector<ShapedTerm> terms_;
  std::vector<double> kinks_;  // [m], where the curve is not smooth, nor is the field off the axis
};
/// A magnet that starts at the place: its force as far as the fringe reaches, and the field on the beam's
/// axis [T], which is there where the law replaces the force. `add_to` adds its whole field.
void contribute_magnet(MagnetTerm, const Fringe&, const Placement&, const Vector3& on_axis,
                       const std::function<void(FringedField&)>& add_to, SectionBuilder&);
/// A curve that never ends, or two curves.
std::vector<Fault> faults_of_fringe(const Fringe&, const AmplitudeProfile&, const Placement&);

/// Where a curve grows outwards: shares of the whole field, and where they are, in lengths outwards from the
/// edge.
struct FringeRise {
  double from = 0, to = 0, begin = 0, end = 0;
};
/// The largest one of more than a thousandth of the whole field.
std::optional<FringeRise> rise_of(const Fringe&);

}  // namespace rabiline
