#include "parts/fringe.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "field/host_maths.hpp"
#include "parts/own_frame.hpp"

namespace rabiline {
namespace {

/// Dipoles in COSY INFINITY (M. Berz, K. Makino, Beam Physics Manual).
constexpr double common_dipole[6] = {0.478959, 1.911289, -1.185953, 1.630554, -1.082657, 0.318111};
constexpr double farthest = 20, spacing = 1.0 / 64;  // [lengths] that curves are looked at

double enge_share(const FringeShape& shape, double s) {
  return enge_edge<HostMaths>(WithSlope<double>{s, 1}, shape.enge).value;
}

/// How far outside its edge [m] it falls below 1e-6 of the whole field for good; nothing where it never does.
std::optional<double> reach_of(const FringeShape& shape) {
  constexpr double cut_off = 1e-6;
  if (shape.curve == FringeCurve::sine) return shape.fringe / 2;
  if (shape.curve != FringeCurve::enge) return 0;
  const auto share = [&](double s) { return enge_share(shape, s); };
  if (share(-farthest) < 1 - cut_off || share(farthest) > cut_off) return std::nullopt;
  double s = farthest;
  while (s > -farthest && share(s - spacing) <= cut_off) s -= spacing;
  return (s > 0 ? s : 0) * shape.fringe;
}

}  // namespace

FringeShape shape_of(const Fringe& fringe, const AmplitudeProfile& profile) {
  FringeShape shape{false, FringeCurve::enge, 0, 0, 1, {}};
  if (std::holds_alternative<HalfSineProfile>(profile)) {
    shape.curve = FringeCurve::half_sine;
  } else if (const auto* gaussian = std::get_if<GaussianProfile>(&profile)) {
    shape.curve = FringeCurve::gaussian;
    shape.fringe = gaussian->sigma;
  } else if (const auto* tanh = std::get_if<TanhFringe>(&fringe)) {
    shape.fringe = tanh->length;
    shape.enge[1] = 2;  // (1 - tanh s)/2 = 1/(1 + exp 2s)
  } else if (const auto* sine = std::get_if<SineFringe>(&fringe)) {
    shape.curve = FringeCurve::sine;
    shape.fringe = sine->length;
  } else if (const auto* enge = std::get_if<EngeFringe>(&fringe)) {
    shape.fringe = enge->length;
    const std::optional<double> given[6] = {enge->a0, enge->a1, enge->a2, enge->a3, enge->a4, enge->a5};
    const bool any = std::ranges::any_of(given, &std::optional<double>::has_value);
    for (int i = 0; i < 6; ++i) shape.enge[i] = any ? given[i].value_or(0) : common_dipole[i];
  }
  return shape;
}

FringedField fringed_field(FringeShape shape, const Vector3& field, double at, double length,
                           const Offset& offset) {
  const double reach = reach_of(shape).value_or(0);
  FringedField fringed{std::max(0.0, at - reach), at + length + reach, {}, {}};
  if (shape.curve == FringeCurve::sine && length > shape.fringe)
    fringed.kinks = {at + shape.fringe / 2, at + length - shape.fringe / 2};
  const Vector3 across{field.x, 0, field.z}, beam{0, 1, 0}, middle = place_of(at + length / 2, offset);
  shape.half_length = length / 2;
  const auto add = [&](bool along, double size, const Vector3& x) {
    shape.along = along;
    shape.size = size;
    const Vector3 u = (1 / length_of(x)) * x;
    fringed.terms.push_back(placed(ShapedTerm(shape), middle, {u, cross(beam, u), beam}));
  };
  if (length_of(across) > 0) add(false, length_of(across), across);
  if (field.y != 0) add(true, field.y, {1, 0, 0});
  return fringed;
}

std::vector<Fault> faults_of_fringe(const Fringe& fringe, const AmplitudeProfile& profile,
                                    const Placement& place) {
  if (std::holds_alternative<HardFringe>(fringe) || reach_of(shape_of(fringe, profile))) return {};
  return {
      {place.name, "fringe",
       fmt::format("the fringe of `{}` does not fall from the full field to none", place.name),
       "state all coefficients of its curve, as those that are missing are 0, or none for a common dipole"}};
}

std::optional<FringeRise> rise_of(const Fringe& fringe) {
  constexpr double least = 1e-3;
  if (!std::holds_alternative<EngeFringe>(fringe)) return std::nullopt;
  const FringeShape shape = shape_of(fringe, RectangularProfile{});
  double low = 2, low_at = 0;
  FringeRise largest;
  for (double s = -farthest; s <= farthest; s += spacing) {
    const double share = enge_share(shape, s);
    if (share < low) low = share, low_at = s;
    if (share - low > largest.to - largest.from) largest = {low, share, low_at, s};
  }
  return largest.to - largest.from > least ? std::optional(largest) : std::nullopt;
}

}  // namespace rabiline
