#include "transport/stages/steering.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/portable_math.hpp"
#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

/// [J/T] along the field, where its size is B.
double moment_of(const Steering& s, int level, double size) {
  if (s.moments.coefficients == nullptr) return s.moment * (1 - 2.0 * level / (s.levels - 1));
  const double place = size / (size + s.moments.scale) * s.moments.cells;
  const int cell = std::min(static_cast<int>(place), s.moments.cells - 1);
  const double* c = s.moments.coefficients + std::ptrdiff_t{4} * (level * s.moments.cells + cell);
  const double t = place - cell;
  return ((c[3] * t + c[2]) * t + c[1]) * t + c[0];
}

/// The levels that meet the walls.
void explain_stopped(const Steering& s, PlanReport& report) {
  const double speed = report.speed, fastest = report.fastest();
  double first = s.end, last = s.begin;
  std::size_t stopped = 0, fast = 0;
  for (const int level : report.on_axis) {
    if (stopped_at(s, level, fastest)) ++fast;
    const std::optional<double> y = stopped_at(s, level, speed);
    if (!y) continue;
    ++stopped;
    first = std::min(first, *y);
    last = std::max(last, *y);
  }
  if (stopped == 0) return;
  report.line("{:>16}at {:.4g} m/s on the axis {} of {} levels meet its walls, from {:.4f} to {:.4f} m", "",
              speed, stopped, report.on_axis.size(), first, last);
  if (stopped < report.on_axis.size()) return;
  report.warn(
      report.name_of(s.part), "kind",
      fmt::format(
          "`{}` pushes every level into its walls: at {:.4g} m/s on the axis they stop from {:.4g} to "
          "{:.4g} m; nothing {} along the axis can arrive",
          report.name_of(s.part), speed, first, last, fast == stopped ? "that flies" : "so slow that flies"));
}

}  // namespace

std::size_t Steering::sums() const { return 1; }
void Steering::pass(StageContext& context) const {
  context.sums[0] += kernel::steer(context.isa)(*this, context.batch.view());
}
void Steering::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
double Steering::y() const { return begin; }
double Steering::cost(double speed) const { return outlook_of(*this, speed).steps * 4 * cost::step; }
bool Steering::follows_paths() const { return true; }
Steering Steering::piece(double from, double to) const {
  Steering cut = *this;
  cut.begin = from;
  cut.end = to;
  return cut;
}

void Steering::explain(PlanReport& report) const {
  const double stay = (end - begin) / report.speed;
  const SteeringOutlook outlook = outlook_of(*this, report.speed);
  report.line("{}  {}: steers up to {}, about {:.0f} steps{}", PlanReport::metres(begin),
              report.name_of(part), PlanReport::metres(end), outlook.steps, report.reuse);
  const bool multipole = shape.kind == MagnetKind::multipole;
  report.line("{:>16}{} |B| is {}, its gradient {}; the largest moment goes by {} in that", "",
              multipole ? "halfway to the poles" : "at the beam",
              pretty_quantity(outlook.field, Dimension::magnetic_field),
              pretty_quantity(outlook.gradient, Dimension::field_gradient),
              pretty_quantity(outlook.acceleration * stay * stay / 2, Dimension::length));
  if (multipole && shape.power == 2 && moments.coefficients == nullptr && outlook.rate > 0)
    report.line("{:>16}a quarter of its oscillation takes {}", "",
                pretty_quantity(std::numbers::pi / 2 * report.speed / outlook.rate, Dimension::length));
  explain_stopped(*this, report);
  report.on_axis.clear();
}

SteeringOutlook outlook_of(const Steering& s, double speed) {
  const bool multipole = s.shape.kind == MagnetKind::multipole;
  const auto at = field_size(s.shape, multipole ? s.shape.radius / 2 : 0.0, s.shape.height,
                             [](double q) { return std::sqrt(q); });
  SteeringOutlook out;
  out.field = at.size;
  out.gradient = portable::hypot(at.along_x, at.along_z);
  out.acceleration = std::abs(s.moment) / s.mass * out.gradient;
  const double turn =
      s.moments.coefficients != nullptr ? out.gradient * out.gradient / (at.size + s.moments.scale) : 0.0;
  out.rate = std::sqrt(std::abs(s.moment) / s.mass * (at.bend + turn));
  out.steps =
      std::clamp(out.rate * (s.end - s.begin) / speed / steering::step_angle, 1.0, steering::most_steps);
  return out;
}

std::optional<double> stopped_at(const Steering& s, int level, double speed) {
  constexpr int steps = 4000;
  const double length = s.end - s.begin, h = length / speed / steps;
  double x = s.sine * s.z0 - s.cosine * s.x0, z = s.shape.height - s.sine * s.x0 - s.cosine * s.z0;
  double vx = 0, vz = 0;
  for (int i = 0; i <= steps; ++i) {
    if (!is_free<bool>(s.walls, x, z)) return s.begin + length * i / steps;
    const auto field = field_size(s.shape, x, z, [](double q) { return std::sqrt(q); });
    if (!std::isfinite(field.size)) return std::nullopt;
    const double pull = moment_of(s, level, field.size) / s.mass;
    vx += h * pull * field.along_x;
    vz += h * pull * field.along_z;
    x += h * vx;
    z += h * vz;
  }
  return std::nullopt;
}

}  // namespace rabiline
