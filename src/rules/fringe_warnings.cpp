#include "rules/fringe_warnings.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/call_off.hpp"
#include "core/portable_math.hpp"
#include "field/fringe_limit.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "plan/stretches.hpp"
#include "rules/warning_room.hpp"
#include "transport/stage.hpp"

namespace rabiline {
namespace {

constexpr int particles = 64;
constexpr double most_inside = 0.1;  // [s] that flights inside of one stage may take, about

struct Fringed {
  ShapedTerm term;
  double begin, end;         // [m]
  double good;               // [m] from its axis
  double farthest = 0;       // [m]
  std::vector<char> strays;  // [flown] 1: farther than that

  void look(int particle, double x, double y, double z) {
    if (y < begin || y > end) return;
    const double distance = distance_from_axis(term, x, y, z);
    farthest = std::max(farthest, distance);
    if (distance > good) strays[static_cast<std::size_t>(particle)] = 1;
  }
};

std::vector<Fringed> fringed_fields(const Beamline& beamline) {
  std::vector<Fringed> out;
  for (const Section& section : sections_of(beamline).sections) {
    const auto add = [&](const ShapedTerm& term) {
      if (term.kind != ShapedKind::fringed) return;
      if (const auto same = std::ranges::find(out, term, &Fringed::term); same != out.end())
        same->end = section.end;
      else
        out.push_back({term, section.begin, section.end, good_up_to(term.fringed), 0, {}});
    };
    std::ranges::for_each(section.shaped, add);
    std::ranges::for_each(section.electric, add);
    std::ranges::for_each(section.swinging, add, &SwingingTerm::field);
  }
  return out;
}

/// Free flight from the batch's plane on to `next`: a parabola is looked at between its ends, too.
void look_between(const BatchView& batch, double next, std::vector<Fringed>& fields) {
  const int places = batch.fall == Fall{} ? 1 : 16;
  for (Fringed& field : fields) {
    const double from = std::max(batch.y, field.begin), to = std::min(next, field.end);
    if (from > to) continue;
    for (int i = 0; i < batch.count; ++i) {
      if (batch.flying[i] == 0) continue;
      for (int k = 0; k <= places; ++k) {
        const double y = std::lerp(from, to, static_cast<double>(k) / places),
                     dt = (y - batch.y) / batch.vy[i];
        field.look(i, batch.x[i] + (batch.vx[i] + 0.5 * batch.fall.x * dt) * dt, y,
                   batch.z[i] + (batch.vz[i] + 0.5 * batch.fall.z * dt) * dt);
      }
    }
  }
}

/// What one particle passes.
struct Looker {
  int particle;
  std::vector<Fringed>& fields;
  double last[3] = {};
  bool has_last = false;

  /// There, and halfway from the last place.
  void look(const double* place) {
    for (Fringed& field : fields) {
      field.look(particle, place[0], place[1], place[2]);
      if (has_last)
        field.look(particle, std::midpoint(place[0], last[0]), std::midpoint(place[1], last[1]),
                   std::midpoint(place[2], last[2]));
    }
    std::copy_n(place, 3, last);
    has_last = true;
  }
};

/// Where a stage bends paths, each of the first particles flies through it alone, and is looked at where its
/// steps end: as many as there is time for.
void look_inside(const Stage& stage, const RandomKey& key, const Batch& batch, std::vector<Fringed>& fields) {
  const BatchView& from = batch.view();
  const double cost = 8 * cost_of(stage, from.vy[0]);  // a vector takes as long as its lanes
  const int looked_at =
      static_cast<int>(std::clamp(most_inside / cost, 1.0, static_cast<double>(from.count)));
  std::vector<Sum> sums(sums_needed(stage));
  for (int i = 0; i < looked_at; ++i) {
    if (from.flying[i] == 0) continue;
    Batch alone;
    BatchView& to = alone.view();
    to.count = 1;
    to.padded = 8;
    to.y = from.y;
    to.fall = from.fall;
    for (const auto column : real_columns) (to.*column)[0] = (from.*column)[i];
    for (const auto column : word_columns) (to.*column)[0] = (from.*column)[i];
    Looker looker{i, fields};
    const StepRecorder recorder{[](void* self, double, const double* place, const double*, const double*) {
                                  static_cast<Looker*>(self)->look(place);
                                },
                                &looker};
    StageContext context{best_isa(), key, alone, sums.data(), &recorder};
    advance(stage, context);
  }
}

/// As far as they come in a second.
void fly(const PlanTree& tree, std::vector<Fringed>& fields) try {
  const Heeding heeding(call_after(1));
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
    if (std::holds_alternative<TurningRegion>(stage) || std::holds_alternative<SortingField>(stage))
      look_inside(stage, tree.source.key, batch, fields);
    std::vector<Sum> sums(sums_needed(stage));
    StageContext context{best_isa(), tree.source.key, batch, sums.data()};
    advance(stage, context);
  }
} catch (const CalledOff&) {  // what has been seen counts
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
          strays, field.strays.size(), part.name, metres(field.good),
          shape.kind == FringeKind::across ? " along the field" : "", metres(field.farthest),
          edge ? "fringe" : "profile"),
      field.good < series_good_up_to(shape) ? "make it longer, or stop in front of it what comes so far"
                                            : "stop in front of it what comes so far, or omit the fringe: "
                                              "without it the field is known everywhere");
}

/// A fringe that leaves nothing of its field whole, or reaches the source.
void check_length(const Fringe& fringe, const Placement& part, double length, Faults& out) {
  constexpr double whole = 0.99, nothing = 1e-3;
  if (std::holds_alternative<HardFringe>(fringe)) return;
  FringeShape shape = shape_of(fringe, RectangularProfile{});
  shape.half_length = length / 2;
  const auto share = [&](double y) {
    return edges_at<HostMaths>(shape, ComplexNumber<double>{y - part.at - length / 2, 0}).value.re;
  };
  if (const double most = share(part.at + length / 2); most < whole)
    out.push_back(
        warning(part.name, "fringe",
                fmt::format("the fringe of `{}` is so long that its field comes to {:.3g} of the whole",
                            part.name, most),
                "make the fringe shorter, or the field longer"));
  if (const double there = share(0); there > nothing)
    out.push_back(
        warning(part.name, "at",
                fmt::format("the fringe of `{}` reaches the source, where its field is {:.3g} of the whole",
                            part.name, there),
                "move it away from the source, or make the fringe shorter"));
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

std::vector<Fault> odd_fringes_of(const Beamline& beamline) {
  Faults out;
  if (asks_for_adiabaticity(beamline))
    for (const PlacedPart& part : beamline.parts)
      if (const auto* guide = std::get_if<GuideField>(&part.part);
          guide && std::holds_alternative<HardFringe>(guide->fringe))
        out.push_back(warning(
            part.placement.name, "kind",
            fmt::format("`adiabaticity` is that of fields that are followed along each path, and `{}` turns "
                        "spins by a closed form: it is not among them",
                        part.placement.name),
            "give it a `fringe`, such as `{kind: tanh, length: 10 mm}`"));
  for (const PlacedPart& part : beamline.parts)
    std::visit(
        [&](const auto& any) {
          if constexpr (requires { any.fringe; }) {
            check_length(any.fringe, part.placement, any.length, out);
            const auto rise = rise_of(any.fringe);
            if (!rise) return;
            const std::string& name = part.placement.name;
            out.push_back(warning(name, "fringe",
                                  fmt::format("the fringe of `{}` does not fall all the way: outwards its "
                                              "field grows from {:.3g} to {:.3g} "
                                              "of the whole, between {:.3g} and {:.3g} lengths from its edge",
                                              name, rise->from, rise->to, rise->begin, rise->end),
                                  "state all coefficients of its curve, as those that are missing are 0, or "
                                  "none for a common dipole"));
          }
        },
        part.part);
  return out;
}

}  // namespace rabiline
