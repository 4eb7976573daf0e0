#include "parts/fringe.hpp"

#include "field/host_maths.hpp"

namespace rabiline {

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

std::optional<double> reach_of(const FringeShape& shape) {
  constexpr double farthest = 20, step = 1.0 / 64, cut_off = 1e-4;  // [lengths]
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

}  // namespace rabiline
