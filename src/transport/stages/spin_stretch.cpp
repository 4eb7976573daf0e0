#include "transport/stages/spin_stretch.hpp"

#include <array>

#include "transport/cost.hpp"
#include "transport/paths.hpp"
#include "transport/plan_report.hpp"
#include "transport/sum_sink.hpp"

namespace rabiline {
namespace {

LevelLayout layout_of(const SpinStretch& stretch) { return {static_cast<std::size_t>(stretch.spins.levels)}; }

void add_sums(const LevelLayout& layout, std::size_t level, const LevelSums& from, std::size_t column,
              Sum* sums) {
  sums[LevelLayout::q(level)] += from.q[column];
  sums[LevelLayout::squares(level)] += joined(from.squares_high[column], from.squares_low[column]);
  if (layout.has_products())
    sums[layout.products(level)] += joined(from.products_high[column], from.products_low[column]);
}
void add_share(const LevelLayout& layout, std::size_t level, std::uint64_t q, std::uint64_t whole,
               Sum* sums) {
  sums[LevelLayout::q(level)] += q;
  sums[LevelLayout::squares(level)] += square(q);
  if (layout.has_products()) sums[layout.products(level)] += static_cast<Sum>(q) * whole;
}

/// The levels of atoms: those that they are in, or by their transitions.
void count_levels_of_atoms(const SpinStretch& stretch, StageContext& context) {
  const BatchView& batch = context.batch.view();
  alignas(64) std::uint64_t weights[Batch::capacity], shares[most_levels * Batch::capacity];
  for (int i = 0; i < batch.padded; ++i)
    weights[i] = batch.caught_by[i] == static_cast<std::uint64_t>(stretch.part) + 1 ? batch.weight[i] : 0;
  share_levels(stretch.spins, context.key, context.isa, batch, weights, shares);
  const LevelLayout layout = layout_of(stretch);
  for (int i = 0; i < batch.count; ++i) {
    if (weights[i] == 0) continue;
    for (std::size_t level = 0; level < layout.levels; ++level) {
      const std::uint64_t q =
          shares[level * static_cast<std::size_t>(batch.padded) + static_cast<std::size_t>(i)];
      if (q != 0) add_share(layout, level, q, weights[i], context.sums);
    }
  }
}

/// Of each level along one axis, what is found in each along another: nothing where both are the same one.
using LevelShares = std::vector<std::vector<double>>;

LevelShares shares_of(const SpinPath& known) {
  LevelShares shares;
  if (!known.is_idle() || known.keeps_levels()) return shares;
  Batch batch;
  BatchView& b = batch.view();
  b.count = known.levels;
  b.padded = (known.levels + 7) / 8 * 8;
  for (int from = 0; from < b.padded; ++from) {
    b.level[from] = static_cast<std::uint64_t>(std::min(from, known.levels - 1));
    b.weight[from] = quanta_per_particle;
    b.sx[from] = known.start->x;
    b.sy[from] = known.start->y;
    b.sz[from] = known.start->z;
    b.vy[from] = b.slowness[from] = 1;
  }
  alignas(64) std::uint64_t found[most_levels * most_levels];
  share_levels(known, {}, best_isa(), b, b.weight, found);
  for (int from = 0; from < known.levels; ++from) {
    std::vector<double>& of = shares.emplace_back();
    for (int to = 0; to < known.levels; ++to)
      of.push_back(static_cast<double>(found[to * b.padded + from]) /
                   static_cast<double>(quanta_per_particle));
  }
  return shares;
}

/// The levels in which paths end, by the shares of their weights that the screen counted.
class LevelPaths : public PathTally {
 public:
  LevelPaths(LevelLayout layout, LevelShares shares) : layout_(layout), shares_(std::move(shares)) {}

  void add(const Paths& paths, const PathWeights& counted, Sum* sums, Sum*) override {
    if (paths.levels_stay && shares_.empty()) {
      for (std::size_t path = 0; path < paths.levels.size(); ++path) {
        const auto level = static_cast<std::size_t>(paths.levels[path]);
        if (level < layout_.levels) add_sums(layout_, level, *counted.by_path, path, sums);
      }
      return;
    }
    // Another projection further on has drawn levels along each path, or they are asked for along another
    // axis.
    for (std::size_t k = 0; k < paths.count(); ++k) {
      if (counted.totals[k] == 0) continue;
      std::array<std::uint64_t, most_levels> found{};
      for (std::size_t path = 0; path < paths.levels.size(); ++path)
        add_found(paths.ends[path].level[paths.number[k]], counted.of[path][k], found);
      for (std::size_t level = 0; level < layout_.levels; ++level)
        add_share(layout_, level, found[level], counted.totals[k], sums);
    }
  }

 private:
  /// All are floored, and the level itself takes what is missing.
  void add_found(std::size_t level, std::uint64_t q, std::array<std::uint64_t, most_levels>& found) const {
    std::uint64_t rest = q;
    for (std::size_t to = 0; to < shares_.size(); ++to) {
      if (to == level) continue;
      const auto share = static_cast<std::uint64_t>(static_cast<double>(q) * shares_[level][to]);
      found[to] += share;
      rest -= std::min(rest, share);
    }
    found[level] += rest;
  }

  const LevelLayout layout_;
  const LevelShares shares_;
};

}  // namespace

std::size_t SpinStretch::sums() const { return layout_of(*this).size(); }
void SpinStretch::list_sums(SumSink& sink) const { sink.levels(part, spins.levels, 0); }
double SpinStretch::y() const { return behind_everything; }
double SpinStretch::cost(double speed) const {
  if (spins.from_level() && spins.zones.size() <= 1 && spins.levels == 2) return cost::closed_form;
  return spins.cost(speed);
}
bool SpinStretch::follows_paths() const { return spins.is_idle(); }
std::unique_ptr<PathTally> SpinStretch::tally_paths() const {
  return std::make_unique<LevelPaths>(layout_of(*this), shares_of(spins));
}

void SpinStretch::pass(StageContext& context) const {
  if (spins.of_atom) return count_levels_of_atoms(*this, context);
  LevelSums found;
  kernel::project(context.isa)({spins.view(context.key), part, majorana}, context.batch.view(), found);
  const LevelLayout layout = layout_of(*this);
  for (std::size_t level = 0; level < layout.levels; ++level)
    add_sums(layout, level, found, level, context.sums);
}

void SpinStretch::explain(PlanReport& report) const {
  const bool of_levels = law_traits(report.beamline.law).has_levels;
  report.line(
      "            spins at {}: {}, {}{}", report.name_of(part),
      of_levels ? fmt::format("{} levels", spins.levels) : "a vector",
      spins.way != nullptr           ? describe(*spins.way)
      : spins.transitions != nullptr ? "coherent through the fields below, which drive them"
      : spins.zones.empty()          ? "as they arrive"
      : spins.from_level() && spins.zones.size() == 1 && spins.zones.front().kind == ZoneKind::rotating
          ? "closed form"
      : of_levels ? "coherent through the zones below"
                  : "turned by the zones below",
      report.reuse);
  if (report.slowness_cells > 0)
    report.line("{:>16}{} scan points follow from moments of the slowness in {} cells", "",
                report.reweightings, report.slowness_cells);
  else if (!report.why_one_by_one.empty())
    report.line("{:>16}scan points are read one by one: {}", "", report.why_one_by_one);
  for (const SpinZone& zone : spins.zones) explain_zone(zone, report);
  report.tell_driven(part);
}

}  // namespace rabiline
