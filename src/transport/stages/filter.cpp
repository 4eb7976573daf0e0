#include "transport/stages/filter.hpp"

#ifndef RABILINE_ISA  // what the host does

#include "particle/fate.hpp"
#include "transport/cost.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {

std::size_t Filter::sums() const { return 1; }
void Filter::pass(StageContext& context) const {
  context.sums[0] += kernel::filter(context.isa)(*this, context.batch.view());
}
void Filter::list_sums(SumSink& sink) const { sink.fate(fate::stopped, part, 0); }
double Filter::y() const { return at; }
double Filter::cost(double) const { return cost::plane; }
void Filter::explain(PlanReport& report) const {
  report.line("{}  {}: passes spins along ({:.4g}, {:.4g}, {:.4g}) with {:g}, against it with {:g}{}",
              PlanReport::metres(at), report.name_of(part), axis[0], axis[1], axis[2], up, down,
              report.reuse);
  if (!report.why_one_by_one.empty())
    report.line("{:>16}scan points behind it are flown one by one: {}", "", report.why_one_by_one);
}
/// It changes weights.
bool Filter::follows_paths() const { return false; }

}  // namespace rabiline

#else  // its kernel, compiled once for each instruction set

#include "transport/plane_lanes.hpp"

namespace rabiline::RABILINE_ISA {

/// A pure state of spin 1/2 with Bloch vector s passes diag(sqrt(up), sqrt(down)) along the axis a: with c =
/// s.a it is transmitted with w = (up (1 + c) + down (1 - c))/2, and leaves with the Bloch vector
/// [(up (1 + c) - down (1 - c))/2 a + sqrt(up down) (s - c a)] / w.
std::uint64_t filter(const Filter& f, BatchView& batch) {
  const Vector axis{broadcast(f.axis[0]), broadcast(f.axis[1]), broadcast(f.axis[2])};
  const double coherence = __builtin_sqrt(f.up * f.down);
  words lost = words{};
  batch.up = false;
  for (int i = 0; i < batch.padded; i += lane_count) {
    const mask flying = (mask)load(batch.flying + i);
    const real sign =
        select(f.quantum ? load(batch.level + i) != words{} : mask{}, broadcast(-1), broadcast(1));
    const Vector s{sign * load(batch.sx + i), sign * load(batch.sy + i), sign * load(batch.sz + i)};
    const real c = max(broadcast(-1), min(broadcast(1), dot(s, axis)));
    const real up = f.up * (0.5 * (1.0 + c)), down = f.down * (0.5 * (1.0 - c));
    const real passed = min(broadcast(1), up + down);
    const Vector across = add(s, -c, axis);
    const real along = up - down;
    Vector out{fma(along, axis.x, coherence * across.x), fma(along, axis.y, coherence * across.y),
               fma(along, axis.z, coherence * across.z)};
    const real size = sqrt(dot(out, out));
    const mask changes = flying & (size > broadcast(0));
    const real scale = sign / select(changes, size, broadcast(1));
    out = {out.x * scale, out.y * scale, out.z * scale};
    store(batch.sx + i, select(changes, out.x, load(batch.sx + i)));
    store(batch.sy + i, select(changes, out.y, load(batch.sy + i)));
    store(batch.sz + i, select(changes, out.z, load(batch.sz + i)));
    lost = lost + let_pass(batch, i, passed);
  }
  return sum_of_lanes(lost);
}

}  // namespace rabiline::RABILINE_ISA

#endif
