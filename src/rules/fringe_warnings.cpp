#include "rules/fringe_warnings.hpp"

#include <algorithm>
#include <cmath>

#include "core/portable_math.hpp"
#include "field/fringe_limit.hpp"
#include "field/shaped_field.hpp"
#include "rules/warning_room.hpp"
#include "transport/stage.hpp"

namespace rabiline {
namespace {

constexpr int particles = 64;

struct Fringed {
  ShapedTerm term;
  double begin, end;         // [m]
  double good;               // [m] from its axis
  double farthest = 0;       // [m]
  std::vector<char> strays;  // [flown] 1: farther than that

  void look(int particle, double x, double y, double z) {
    double own[3];
    own_place(term, x, y, z, own);
    const double distance = term.fringed.along ? portable::hypot(own[0], own[1], 0) : std::abs(own[0]);
    farthest = std::max(farthest, distance);
    if (distance > good) strays[static_cast<std::size_t>(particle)] = 1;
  }
};

std::vector<Fringed> fringed_fields(const Beamline& beamline) {
  std::vector<Fringed> out;
  for (const Section& section : sections_of(beamline).sections) {
    const auto add = [&](const ShapedTerm& term) {
      if (term.kind == ShapedKind::fringed)
        out.push_back({term, section.begin, section.end, good_up_to(term.fringed), 0, {}});
    };
    std::ranges::for_each(section.shaped, add);
    std::ranges::for_each(section.electric, add);
    std::ranges::for_each(section.swinging, add, &SwingingTerm::field);
  }
  return out;
}

/// Free flight from the batch's plane on to `next`.
void look_between(const BatchView& batch, double next, std::vector<Fringed>& fields) {
  for (Fringed& field : fields) {
    const double from = std::max(batch.y, field.begin), to = std::min(next, field.end);
    if (from > to) continue;
    for (int i = 0; i < batch.count; ++i) {
      if (batch.flying[i] == 0) continue;
      for (const double y : {from, to}) {
        const double dt = (y - batch.y) / batch.vy[i];
        field.look(i, batch.x[i] + (batch.vx[i] + 0.5 * batch.fall.x * dt) * dt, y,
                   batch.z[i] + (batch.vz[i] + 0.5 * batch.fall.z * dt) * dt);
      }
    }
  }
}

void fly(const PlanTree& tree, std::vector<Fringed>& fields) {
  Batch batch;
  BatchView& view = batch.view();
  view.count = static_cast<int>(std::min<std::uint64_t>(particles, tree.last - tree.first));
  view.padded = (view.count + 7) / 8 * 8;
  kernel::emit(best_isa())(tree.source, tree.first, view);
  for (Fringed& field : fields) field.strays.assign(static_cast<std::size_t>(view.count), 0);
  for (const std::vector<PlanNode>* nodes = &tree.next; !nodes->empty(); nodes = &nodes->front().next) {
    const Stage& stage = nodes->front().stage;
    look_between(view, place_of(stage), fields);
    const SpinPath* asked = path_of(stage);
    if (!nodes->front().reweightings.empty() || (asked != nullptr && asked->way != nullptr))
      continue;  // weights alone
    std::vector<Sum> sums(sums_needed(stage));
    StageContext context{best_isa(), tree.source.key, batch, sums.data()};
    advance(stage, context);
  }
}

Fault warning_of(const Fringed& field, const Placement& part) {
  const FringeShape& shape = field.term.fringed;
  const bool edge = shape.curve == FringeCurve::enge || shape.curve == FringeCurve::sine;
  const auto strays = std::ranges::count(field.strays, 1);
  return warning(
      part.name, edge ? "fringe" : "profile",
      fmt::format(
          "{} of the first {} particles pass `{}` more than {} from its axis{}, up to {}: so far from it "
          "the {} does not tell what the field is",
          strays, field.strays.size(), part.name, metres(field.good), shape.along ? "" : " along the field",
          metres(field.farthest), edge ? "fringe" : "profile"),
      "make it longer, or stop in front of it what comes so far");
}

}  // namespace

std::vector<Fault> warnings_of_fringes(const Beamline& first, const Plan& plan) {
  std::vector<Fringed> fields = fringed_fields(first);
  Faults out;
  if (fields.empty()) return out;
  for (const PlanTree& tree : plan.trees) {
    if (std::ranges::find(tree.points, 0) == tree.points.end()) continue;
    fly(tree, fields);
    for (const Fringed& field : fields)
      if (std::ranges::find(field.strays, 1) != field.strays.end())
        out.push_back(warning_of(field, first.parts[static_cast<std::size_t>(field.term.part)].placement));
  }
  return out;
}

}  // namespace rabiline
