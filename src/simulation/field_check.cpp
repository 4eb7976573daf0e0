#include "simulation/field_check.hpp"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <set>
#include <span>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "core/stepper.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "simulation/level_check.hpp"
#include "simulation/magnet_check.hpp"
#include "simulation/zone_rates.hpp"

namespace rabiline {
namespace {

constexpr int particles_checked = 16, most_stretches = 8;
constexpr long most_evaluations = 4'000'000;
constexpr double most_operations = 1e8;  // for levels of atoms

/// x, z [m], t [s], velocity [m/s], S; y is the variable.
constexpr int numbers = 9;
using Row = std::array<double, numbers>;

/// One particle in one zone, as an initial value problem.
struct Problem {
  const TurningRegion& region;
  const RegionZone& zone;
  const double* phases;
  double part = 1;  // of the whole moment that pulls
  std::uint64_t level = 0;
  long& evaluations;
};

struct Acting {
  Vector3 spin, turn, push;  // [rad/s], [rad/s], [m/s^2]
  FieldHere<double> field{};
};
/// Adds what E does: the spin sees -v x E/c^2, the charge q E.
void add_electric(const Problem& p, double x, double y, double z, const Vector3& velocity, Acting& at) {
  const ElectricCoupling& feels = p.region.feels.electric;
  FieldHere<double> sum{};
  for (int i = p.zone.shaped_end; i < p.zone.electric_end; ++i)
    add_field<HostMaths>(p.region.shaped[static_cast<std::size_t>(i)], x, y, z, sum);
  const Vector3 e = vector_at(sum.field),
                motional =
                    (-1 / (constants::speed_of_light * constants::speed_of_light)) * cross(velocity, e),
                turn = feels.spin_per_motional * motional + feels.spin_per_electric * e;
  at.spin = at.spin + turn;
  at.turn = at.turn + feels.turn_share * turn;
  at.push = feels.acceleration * e;
}
Acting acting_at(const Problem& p, double x, double y, double z, double t, const Vector3& velocity) {
  const SpinZone& zone = p.zone.field;
  const ZoneRates rates = rates_of(zone, p.phases, {x, y, z}, t, t);
  Acting at{rates.spin, rates.turn, {}};
  for (int i = p.zone.shaped_begin; i < p.zone.shaped_end; ++i)
    add_field_at(p.region.shaped[static_cast<std::size_t>(i)], zone, p.phases, {x, y, z}, t, at.field);
  if (p.region.feels.follows_level) return at;
  if (p.zone.shaped_end < p.zone.electric_end) add_electric(p, x, y, z, velocity, at);
  const Vector3 b = vector_at(at.field.field);
  at.spin = at.spin + p.region.feels.spin_per_tesla * b;
  at.turn = at.turn + p.region.feels.turn_per_tesla * b;
  return at;
}

/// What the slopes of B_x, B_y and B_z are multiplied by: mu B/(|B| m).
Vector3 pull_of_level(const Problem& p, const FieldHere<double>& field) {
  const Vector3 b = vector_at(field.field) + vector_at(p.zone.uniform);
  const double size = length_of(b);
  if (size == 0) return {};
  const FieldCoupling& feels = p.region.feels;
  double pull = p.part * feels.pull;
  if (feels.moments.coefficients != nullptr) {
    pull = moment_at(feels.moments, p.level, size) / feels.mass;
  }
  return (pull / size) * b;
}

int derivative(double y, const double* q, double* dq, void* with) {
  const Problem& p = *static_cast<const Problem*>(with);
  ++p.evaluations;
  const Vector3 velocity = vector_at(q + 3), spin = vector_at(q + 6);
  const Acting at = acting_at(p, q[0], y, q[1], q[2], velocity);
  const Vector3 turn = p.region.take_off_spin_component ? at.turn - dot(at.turn, spin) * spin : at.turn;
  Vector3 a = cross(turn, velocity) + vector_at(p.region.feels.gravity) + at.push;
  const Vector3 along =
      p.region.feels.follows_level ? pull_of_level(p, at.field) : p.part * p.region.feels.pull * spin;
  const double s[3] = {along.x, along.y, along.z};
  for (int i = 0; i < 3; ++i) a = a + s[i] * vector_at(&at.field.slope[3L * i]);
  const Vector3 turned = cross(at.spin, spin);
  const double per_y = 1 / velocity.y;
  const double rates[numbers] = {velocity.x, velocity.z, 1, a.x, a.y, a.z, turned.x, turned.y, turned.z};
  for (int i = 0; i < numbers; ++i) dq[i] = rates[i] * per_y;
  return velocity.y > 0 && p.evaluations < most_evaluations ? GSL_SUCCESS : GSL_EBADFUNC;
}

/// Where a particle comes to the next bend of a course in time, about; the zone's end at the latest.
double next_bend(const Problem& p, double y, const Row& state) {
  const double end = p.zone.field.end, latest = state[2] + (end - y) / state[4];
  double stop = latest;
  for (int i = p.zone.shaped_begin; i < p.zone.shaped_end; ++i)
    if (const TimeCourse& course = p.region.shaped[static_cast<std::size_t>(i)].course; course.nodes > 0)
      stop = next_stop<HostMaths>(course, state[2] * (1 + 1e-12), stop);
  return stop < latest ? std::min(y + state[4] * (stop - state[2]), end) : end;
}

/// Takes a state from the begin of a zone to its end; false where it turns back or takes too long.
bool integrate(Problem& problem, Row& state) {
  const SpinZone& zone = problem.zone.field;
  const double length = zone.end - zone.begin, speed = length_of(vector_at(state.data() + 3));
  if (!(length > 0)) return true;
  constexpr double error = 1e-11;
  gsl_odeiv2_system system{derivative, nullptr, numbers, &problem};
  // Each number against its own size.
  const double sizes[numbers] = {length, length, length / speed, speed, speed, speed, 1, 1, 1};
  Stepper steps(sizes, error, length / 64);
  const double longest = problem.zone.longest > 0 ? problem.zone.longest : length;
  double y = zone.begin;
  while (y < zone.end)
    if (steps.go(system, y, next_bend(problem, y, state), longest, state.data()) != GSL_SUCCESS) return false;
  return true;
}

Row state_of(const BatchView& b, int i) {
  return {b.x[i], b.z[i], b.t[i], b.vx[i], b.vy[i], b.vz[i], b.sx[i], b.sy[i], b.sz[i]};
}

bool through_field(const TurningRegion& region) {
  return std::ranges::any_of(region.zones,
                             [](const RegionZone& z) { return z.course == ZoneCourse::through_field; });
}
bool changes_state(const TurningRegion& region) {
  return std::ranges::any_of(region.edges, [](const RegionEdge& e) { return e.kind == EdgeKind::align; });
}

/// What has met a wall on the way flies on with a mark to the stage that ends it.
void leave_out_marked(const Stage& stage, BatchView& batch) {
  const bool marks = std::visit(
      [](const auto& s) {
        if constexpr (requires { s.marks_walls(); }) return s.marks_walls();
        return false;
      },
      stage);
  for (int i = 0; marks && i < batch.count; ++i)
    if (batch.scratch[i] != 0) batch.flying[i] = 0;
}

/// How many zones a particle flew through, up to the end, or to the plate or screen that it met on its way
/// forward; 0 where it ended elsewhere.
std::size_t zones_flown(const TurningRegion& region, const BatchView& behind, int i) {
  if (behind.flying[i] != 0) return region.zones.size();
  const std::uint64_t end = behind.scratch[i] & 0xffffffffULL;
  const bool at_edge = (end & (region_end::stopped_at_edge | region_end::caught_at_edge)) != 0;
  return at_edge && behind.vy[i] > 0 ? (end & 0xffffULL) + 1 : 0;
}

/// A free flight to the end of the region, for which what met an edge is referred to that, too.
void draw_out(double way, const Fall& fall, Row& state) {
  const double dt = way / state[4];
  state[0] += (state[3] + 0.5 * fall.x * dt) * dt;
  state[1] += (state[5] + 0.5 * fall.z * dt) * dt;
  state[2] += dt;
  state[3] += fall.x * dt;
  state[5] += fall.z * dt;
}

class Checker {
 public:
  explicit Checker(Isa isa) : isa_(isa) {}

  void fly(const PlanTree& tree) {
    key_ = tree.source.key;
    Batch batch;
    batch.view().count = static_cast<int>(std::min<std::uint64_t>(particles_checked, tree.last - tree.first));
    batch.view().padded = (batch.view().count + 7) / 8 * 8;
    kernel::emit(isa_)(tree.source, tree.first, batch.view());
    propagate(tree.next, batch);
  }
  std::optional<FieldCheck> found() const {
    const bool looked = stretches_ > 0 || found_.particles > 0 || too_long_ || found_.approximated;
    return looked ? std::optional(found_) : std::nullopt;
  }

 private:
  void propagate(const std::vector<PlanNode>& nodes, const Batch& at_begin) {
    for (const PlanNode& node : nodes) {
      if (stretches_ >= most_stretches) return;
      if (const SpinPath* path = path_of(node.stage); path != nullptr && path->way != nullptr)
        compare(*path, at_begin.view());
      if (!node.reweightings
               .empty()) {  // behind a projection that splits, particles stay in the levels that they had
        propagate(node.next, at_begin);
        continue;
      }
      Batch batch;
      batch.copy_from(at_begin);
      std::vector<Sum> sums(sums_needed(node.stage));
      StageContext context{isa_, key_, batch, sums.data()};
      advance(node.stage, context);
      Batch through;
      through.copy_from(batch);
      leave_out_marked(node.stage, through.view());
      if (const auto* region = std::get_if<TurningRegion>(&node.stage); region && through_field(*region))
        compare(*region, at_begin.view(), through.view());
      if (const auto* sorting = std::get_if<SortingField>(&node.stage))
        compare(sorting->region, at_begin.view(), through.view());
      if (const auto* magnet = std::get_if<Deflection>(&node.stage))
        compare_in_magnet(*magnet, at_begin.view(), through.view());
      if (const auto* magnet = std::get_if<Steering>(&node.stage))
        compare_in_magnet(*magnet, at_begin.view(), through.view());
      propagate(node.next, batch);
    }
  }

  /// The levels at the end of a way, which is asked for there.
  void compare(const SpinPath& path, const BatchView& batch) {
    const LevelWay& way = *path.way;
    if (!ways_.insert(&way).second) return;
    found_.tolerance = way.fields().tolerance;
    if (!LevelReference::is_for(way)) {
      found_.approximated = true;
      return;
    }
    alignas(64) std::uint64_t weights[Batch::capacity] = {}, shares[most_levels * Batch::capacity];
    std::fill_n(weights, batch.count, quanta_per_particle);
    share_levels(path, key_, isa_, batch, weights, shares);
    const LevelReference reference(way, key_);
    const bool whole = operations_ == most_operations;  // which other ways have used nothing of
    for (int i = 0; i < batch.count; ++i) {
      const auto expected = reference.carried({{batch.x[i], batch.y, batch.z[i]},
                                               {batch.vx[i], batch.vy[i], batch.vz[i]},
                                               batch.t[i],
                                               batch.fall,
                                               batch.particle[i],
                                               static_cast<int>(batch.level[i])},
                                              operations_);
      if (!expected) {
        too_long_ = too_long_ || whole;
        return;
      }
      ++found_.particles;
      for (std::size_t level = 0; level < expected->size(); ++level) {
        const double found =
            static_cast<double>(
                shares[level * static_cast<std::size_t>(batch.padded) + static_cast<std::size_t>(i)]) /
            static_cast<double>(quanta_per_particle);
        found_.levels = std::max(found_.levels, std::abs(found - (*expected)[level]));
      }
    }
  }

  void compare(const TurningRegion& region, const BatchView& before, const BatchView& behind) {
    if (changes_state(region)) return;
    ++stretches_;
    found_.tolerance = region.feels.tolerance;
    for (int i = 0; i < before.count; ++i) {
      const std::size_t zones = before.flying[i] != 0 ? zones_flown(region, behind, i) : 0;
      if (zones == 0) continue;
      Row state = state_of(before, i);
      if (!follow(region, zones, before, i, state)) continue;
      draw_out(region.zones.back().field.end - region.zones[zones - 1].field.end, behind.fall, state);
      note(region, state, state_of(behind, i));
    }
  }
  /// The same flight by the other integrator, through the first so many zones.
  bool follow(const TurningRegion& region, std::size_t zones, const BatchView& before, int i, Row& state) {
    const int levels = region.feels.levels;
    const double part = levels > 0 ? 1 - 2 * static_cast<double>(before.level[i]) / (levels - 1) : 1;
    for (const RegionZone& zone : std::span(region.zones).first(zones)) {
      double phases[most_drives] = {};
      for (int k = 0; k < zone.field.drives; ++k)
        phases[k] = phase_of(zone.field.drive[k], key_, before.particle[i]);
      Problem problem{region, zone, phases, part, before.level[i], evaluations_};
      if (!integrate(problem, state)) return false;
    }
    return true;
  }
  void note(const TurningRegion& region, const Row& a, const Row& b) {
    const auto distance = [&](int from) {
      return length_of(vector_at(a.data() + from) - vector_at(b.data() + from));
    };
    const double length = region.zones.back().field.end - region.zones.front().field.begin;
    ++found_.particles;
    found_.place = std::max(found_.place, portable::hypot(a[0] - b[0], a[1] - b[1], 0) / length);
    found_.direction = std::max(found_.direction, distance(3) / length_of(vector_at(a.data() + 3)));
    if (!region.feels.follows_level) found_.spin = std::max(found_.spin, distance(6));
  }

  /// The level, or S along the field, is that of before.
  template <class Magnet>
  void compare_in_magnet(const Magnet& magnet, const BatchView& before, const BatchView& behind) {
    ++stretches_;
    found_.tolerance = magnet.tolerance;
    const double length = magnet.end - magnet.begin;
    for (int i = 0; i < before.count; ++i) {
      if (before.flying[i] == 0 || behind.flying[i] == 0) continue;
      const auto there = integrated_through(magnet, before, i, evaluations_, most_evaluations);
      if (!there) continue;
      ++found_.particles;
      found_.place =
          std::max(found_.place, portable::hypot(there->x - behind.x[i], there->z - behind.z[i], 0) / length);
      found_.direction =
          std::max(found_.direction,
                   portable::hypot(there->vx - behind.vx[i], there->vz - behind.vz[i], 0) / behind.vy[i]);
      if (magnet.levels > 0)
        found_.levels = std::max(found_.levels, before.level[i] == behind.level[i] ? 0.0 : 1.0);
      else
        found_.spin = std::max(found_.spin, std::abs(before.sz[i] - behind.sz[i]));
    }
  }

  const Isa isa_;
  RandomKey key_;
  int stretches_ = 0;
  long evaluations_ = 0;
  double operations_ = most_operations;
  bool too_long_ = false;  // for even one atom, where nothing else took of the operations
  std::set<const LevelWay*> ways_;
  FieldCheck found_;
};

}  // namespace

std::optional<FieldCheck> check_fields(const Plan& plan, Isa isa) {
  Checker checker(isa);
  for (const PlanTree& tree : plan.trees) checker.fly(tree);
  return checker.found();
}

}  // namespace rabiline
