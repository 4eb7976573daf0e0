#include "parts/fringe.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>

#include "core/eigensystem.hpp"
#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "parts/own_frame.hpp"
#include "parts/time_factor.hpp"
#include "section/section_builder.hpp"

namespace rabiline {
namespace {

/// Dipoles in COSY INFINITY (M. Berz, K. Makino, Beam Physics Manual).
constexpr double common_dipole[6] = {0.478959, 1.911289, -1.185953, 1.630554, -1.082657, 0.318111};
constexpr double farthest = 20, spacing = 1.0 / 64;  // [lengths] that curves are looked at

double enge_share(const FringeShape& shape, double s) {
  return enge_edge<HostMaths>(WithSlopes<double>{s, 1, 0}, shape.enge).value;
}

/// How far outside its edge [m] it falls below 1e-8 of the whole field for good, where energies jump by as
/// little; nothing where it never does.
std::optional<double> reach_of(const FringeShape& shape) {
  constexpr double cut_off = 1e-8;
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
  FringeShape shape{FringeKind::across, FringeCurve::enge, 0, 0, 1, {}};
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

bool is_boxed(const Fringe& fringe, const AmplitudeProfile& profile) {
  return std::holds_alternative<HardFringe>(fringe) && std::holds_alternative<RectangularProfile>(profile);
}

FringedField::FringedField(const FringeShape& shape, double at, double length, const Offset& offset,
                           double beside)
    : shape_(shape), middle_(place_of(at + length / 2, offset)) {
  const double reach = reach_of(shape).value_or(0) + beside;
  begin_ = std::max(0.0, at - reach);
  end_ = at + length + reach;
  shape_.half_length = length / 2;
  if (shape.curve == FringeCurve::sine && length > shape.fringe)
    kinks_ = {at + shape.fringe / 2, at + length - shape.fringe / 2};
}

/// On the axis along `x`, or along the beam with `x` across it.
void FringedField::add_term(FringeShape shape, double even, double growth, const Vector3& x) {
  if (even == 0 && growth == 0) return;
  const Vector3 beam{0, 1, 0}, first = (1 / length_of(x)) * x;
  shape.size = growth == 0 ? even : 1;
  shape.even = growth == 0 ? 1 : even;
  shape.growth = growth;
  terms_.push_back(placed(ShapedTerm(shape), middle_, {first, cross(beam, first), beam}));
}

/// In a frame with w = z, u = x and the beam y, slopes have a part dB_y/dy, which is that of a field along
/// the beam that grows along it; dB_u/dy and dB_w/dy, of one across it; and what is left, a quadrupole's.
void FringedField::add(const Vector3& field, const FieldSlopes& slopes) {
  double most = 0;
  for (const double slope : slopes) most = std::max(most, std::abs(slope));
  const auto felt = [&](double slope) {
    return std::abs(slope) > 1e-14 * most ? slope : 0;
  };  // a tilt rounds
  const Vector3 across{field.x, 0, field.z}, growing{felt(slopes[1]), 0, felt(slopes[7])};
  const double size = length_of(across), growth = length_of(growing);
  FringeShape shape = shape_;
  shape.kind = FringeKind::across;
  if (length_of(cross(across, growing)) <= 1e-14 * size * growth) {
    add_term(shape, size, size > 0 ? dot(across, growing) / size : growth, size > 0 ? across : growing);
  } else {
    add_term(shape, size, 0, across);
    add_term(shape, 0, growth, growing);
  }
  shape.kind = FringeKind::along;
  add_term(shape, field.y, felt(slopes[4]), {1, 0, 0});
  const double even = felt(slopes[8] + slopes[4] / 2), skew = felt(slopes[2]),
               quadrupole = portable::hypot(even, skew, 0);
  if (quadrupole == 0) return;
  const double angle = portable::atan2(skew, even) / 2, cosine = portable::cos(angle),
               sine = portable::sin(angle);
  add_poles({1, quadrupole, 1}, {{sine, 0, cosine}, {cosine, 0, -sine}, {0, 1, 0}});
}

void FringedField::add_turning(const Vector3& field, double turn, double phase) {
  FringeShape shape = shape_;
  shape.turn = turn;
  shape.phase = phase + std::numbers::pi / 2;
  const Vector3 across{field.x, 0, field.z};
  shape.kind = FringeKind::across;
  add_term(shape, length_of(across), 0, across);
  shape.kind = FringeKind::along;
  add_term(shape, field.y, 0, {1, 0, 0});
}

/// Gauss and Gegenbauer's places, by G. Golub and J. Welsch (Math. Comp. 23, 221, 1969): eigenvalues of the
/// recurrence of polynomials that are orthogonal with the weight (1 - c^2)^(n - 1/2).
void FringedField::add_poles(const MultipoleShape& poles, const OwnFrame& frame) {
  constexpr int places = 8;
  FringeShape shape = shape_;
  shape.kind = FringeKind::poles;
  shape.size = poles.field;
  for (int i = 0; i < poles.power; ++i) shape.size /= poles.radius;
  shape.power = poles.power;
  const double n = poles.power + 1;
  Eigen::MatrixXd recurrence = Eigen::MatrixXd::Zero(places, places);
  for (int k = 1; k < places; ++k)
    recurrence(k, k - 1) = std::sqrt(k * (k + 2 * n - 1) / (4 * (k + n) * (k + n - 1)));
  const auto own = eigensystem_of(recurrence);
  for (int i = 0; i < places / 2; ++i) {
    const Eigen::Index positive = places - 1 - i;
    shape.place[i] = own.values(positive);
    shape.share[i] = 2 * own.vectors(0, positive) * own.vectors(0, positive);
  }
  terms_.push_back(placed(ShapedTerm(shape), middle_, frame));
}

void FringedField::add_wires(const MagnetShape& wires, const OwnFrame& frame) {
  FringeShape shape = shape_;
  shape.kind = FringeKind::wires;
  shape.size = wires.field;
  shape.half_distance = wires.half_distance;
  shape.height = wires.height;
  terms_.push_back(placed(ShapedTerm(shape), middle_, frame));
}

void FringedField::contribute(SectionBuilder& builder, const std::optional<Oscillator>& clock) const {
  for (const ShapedTerm& term : terms_) add_shaped(clock, begin_, end_, term, builder);
  for (const double y : kinks_) builder.kink(y);
}
void FringedField::contribute_swinging(SectionBuilder& builder, const std::string& oscillator, double phase,
                                       double lag) const {
  for (const ShapedTerm& term : terms_) builder.swinging(begin_, end_, term, oscillator, phase, lag);
  for (const double y : kinks_) builder.kink(y);
}
void FringedField::contribute_electric(SectionBuilder& builder) const {
  for (const ShapedTerm& term : terms_) builder.electric(begin_, end_, term);
  for (const double y : kinks_) builder.kink(y);
}

std::vector<PlacedTerm> FringedField::terms() const {
  std::vector<PlacedTerm> out;
  for (const ShapedTerm& term : terms_) out.push_back({begin_, end_, term});
  return out;
}

void contribute_magnet(MagnetTerm magnet, const Fringe& fringe, const Placement& place,
                       const Vector3& on_axis, const std::function<void(FringedField&)>& add_to,
                       SectionBuilder& builder) {
  if (!is_boxed(fringe, RectangularProfile{})) {
    const FringeShape shape = shape_of(fringe, RectangularProfile{});
    const double length = magnet.end - place.at;
    FringedField alone(shape, place.at, length, {}), whole(shape, place.at, length, magnet.offset);
    alone.add(on_axis);
    alone.contribute(builder);
    add_to(whole);
    magnet.fringed = whole.terms();
  } else if (length_of(on_axis) > 0) {
    builder.uniform(place.at, magnet.end, {on_axis});
  }
  builder.plane(place.at, magnet);
}

std::vector<Fault> faults_of_fringe(const Fringe& fringe, const AmplitudeProfile& profile,
                                    const Placement& place) {
  const bool hard = std::holds_alternative<HardFringe>(fringe);
  if (!hard && !std::holds_alternative<RectangularProfile>(profile))
    return {{place.name, "profile",
             fmt::format("`{}` has a profile and a fringe, which are two curves of one field", place.name),
             "omit one of them, or make two fields that overlap"}};
  if (hard || reach_of(shape_of(fringe, profile))) return {};
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
