#include "particle/direction.hpp"

#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "particle/law_tables.hpp"

namespace rabiline {
namespace {

constexpr double right_angle = std::numbers::pi / 2;

}  // namespace

double ParallelDirection::widest_angle(double) const { return 0; }
DirectionDraw ParallelDirection::draw(LawTables&) const { return {}; }

double GaussianDirection::widest_angle(double deviations) const {
  return portable::atan(deviations * portable::hypot(x, z));
}
DirectionDraw GaussianDirection::draw(LawTables&) const { return {DirectionKind::gaussian, x, z}; }

double BoxDirection::widest_angle(double) const { return portable::atan(portable::hypot(x, z)); }
DirectionDraw BoxDirection::draw(LawTables&) const { return {DirectionKind::box, x, z}; }

double ConeDirection::widest_angle(double) const { return half_angle; }
DirectionDraw ConeDirection::draw(LawTables&) const {
  const double half = portable::sin(half_angle / 2);
  return {DirectionKind::cone, 2 * half * half};
}

double CosineDirection::widest_angle(double) const { return half_angle; }
DirectionDraw CosineDirection::draw(LawTables&) const {
  const double sine = portable::sin(half_angle);
  return {DirectionKind::cosine, sine * sine};
}

double ChannelDirection::widest_angle(double) const { return right_angle; }
DirectionDraw ChannelDirection::draw(LawTables& tables) const {
  DirectionDraw draw{DirectionKind::channel};
  draw.angles = tables.channel(length / radius).angles.law();
  return draw;
}
/// j = 1 there, and W of what enters the channel leaves it: Clausing 1932.
double ChannelDirection::density_on_axis(Transmissions& known) const {
  const double ratio = length / radius;
  auto found = known.find(ratio);
  if (found == known.end()) found = known.emplace(ratio, ChannelFlow(ratio).transmission()).first;
  return 1 / (std::numbers::pi * found->second);
}
void ChannelDirection::weigh(LawTables& tables, DirectionDraw& draw) const {
  draw.aimed_law = AimedLaw::channel;
  draw.channel = tables.channel(length / radius).shape();
}

double IsotropicEmission::density_on_axis(Transmissions&) const { return 1 / (2 * std::numbers::pi); }
void IsotropicEmission::weigh(LawTables&, DirectionDraw& draw) const { draw.aimed_law = AimedLaw::isotropic; }

double CosineEmission::density_on_axis(Transmissions&) const { return 1 / std::numbers::pi; }
void CosineEmission::weigh(LawTables&, DirectionDraw& draw) const { draw.aimed_law = AimedLaw::cosine; }

/// Wherever the target is.
double AimedDirection::widest_angle(double) const { return right_angle; }
DirectionDraw AimedDirection::draw(LawTables& tables) const {
  DirectionDraw draw{DirectionKind::aimed};
  std::visit([&](const auto& law) { law.weigh(tables, draw); }, emission);
  return draw;
}

}  // namespace rabiline
