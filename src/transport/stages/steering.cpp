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

/// A batch at the begin of a magnet, one particle of weight 1 on the axis in each of the levels.
void enter(const Steering& s, const std::vector<int>& levels, double speed, BatchView& beam) {
  beam.count = static_cast<int>(levels.size());
  beam.padded = (beam.count + 7) / 8 * 8;
  beam.y = s.begin;
  for (double* across : {beam.x, beam.z, beam.vx, beam.vz}) std::fill_n(across, beam.padded, 0.0);
  std::fill_n(beam.vy, beam.padded, speed);
  std::fill_n(beam.slowness, beam.padded, 1 / speed);
  for (int i = 0; i < beam.count; ++i) {
    beam.level[i] = static_cast<std::uint64_t>(levels[static_cast<std::size_t>(i)]);
    beam.weight[i] = 1;
    beam.flying[i] = ~std::uint64_t{0};
  }
}

/// The levels that meet the walls.
void explain_stopped(const Steering& s, PlanReport& report) {
  const double speed = report.flight.speed_between(s.begin, s.end);
  const std::vector<double> stops = stops_of(s, report.on_axis, speed);
  const std::size_t stopped = stops.size(), fast = stops_of(s, report.on_axis, report.fastest()).size();
  if (stopped == 0) return;
  const double first = stops.front(), last = stops.back();
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
  if (whole == 0) cut.whole = end - begin;
  cut.begin = from;
  cut.end = to;
  return cut;
}

void Steering::explain(PlanReport& report) const {
  const double speed = report.flight.speed_between(begin, end), stay = (end - begin) / speed;
  const SteeringOutlook outlook = outlook_of(*this, speed);
  report.line("{}  {}: steers up to {}, {}{}", PlanReport::metres(begin), report.name_of(part),
              PlanReport::metres(end), PlanReport::about_steps(outlook.steps), report.reuse);
  const bool multipole = shape.kind == MagnetKind::multipole;
  report.line("{:>16}{} |B| is {}, its gradient {}; the largest moment is deflected by {} in it", "",
              multipole ? "halfway to the poles" : "on its axis",
              pretty_quantity(outlook.field, Dimension::magnetic_field),
              pretty_quantity(outlook.gradient, Dimension::field_gradient),
              pretty_quantity(outlook.acceleration * stay * stay / 2, Dimension::length));
  if (multipole && shape.power == 2 && moments.coefficients == nullptr && outlook.rate > 0)
    report.line("{:>16}a quarter of its oscillation takes {}", "",
                pretty_quantity(std::numbers::pi / 2 * speed / outlook.rate, Dimension::length));
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
  out.steps = std::clamp(out.rate * (s.end - s.begin) / speed / steering::step_angle, 1.0,
                         steering::most_steps + steering::most_fine);
  return out;
}

std::vector<double> stops_of(const Steering& s, const std::vector<int>& levels, double speed) {
  constexpr int pieces = 4000;
  Batch batch;
  enter(s, levels, speed, batch.view());
  if (kernel::steer(best_isa())(s, batch.view()) == 0) return {};
  enter(s, levels, speed, batch.view());
  std::vector<double> stops;
  for (int piece = 0; piece <= pieces && stops.size() < levels.size(); ++piece) {
    const double to = s.begin + (s.end - s.begin) * piece / pieces;
    stops.insert(stops.end(), kernel::steer(best_isa())(s.piece(batch.view().y, to), batch.view()), to);
  }
  return stops;
}

}  // namespace rabiline
