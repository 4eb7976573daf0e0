#include "parts/fringe.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "field/host_maths.hpp"
#include "parts/own_frame.hpp"

namespace rabiline {
namespace {

/// How far outside its edge [m] it falls below 1e-6 of the whole field for good; nothing where it never does.
std::optional<double> reach_of(const FringeShape& shape) {
  constexpr double farthest = 20, step = 1.0 / 64, cut_off = 1e-6;  // [lengths]
  if (shape.curve == FringeCurve::sine) return shape.fringe / 2;
  if (shape.curve != FringeCurve::enge) return 0;
  const auto share = [&](double s) {
    return enge_edge<HostMaths>(Taylor<double, 2>{{s, 1}}, shape.enge).c[0];
  };
  if (share(-farthest) < 1 - cut_off || share(farthest) > cut_off) return std::nullopt;
  double s = farthest;
  while (s > -farthest && share(s - step) <= cut_off) s -= step;
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
    int i = 0;
    for (const double a : {enge->a0, enge->a1, enge->a2, enge->a3, enge->a4, enge->a5}) shape.enge[i++] = a;
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
  return {{place.name, "fringe",
           fmt::format("the fringe of `{}` does not fall from the full field to none", place.name),
           "omit the coefficients for those of a common dipole"}};
}

}  // namespace rabiline
