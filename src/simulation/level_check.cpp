#include "simulation/level_check.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>

#include "core/constants.hpp"
#include "core/eigensystem.hpp"
#include "core/portable_math.hpp"
#include "field/host_maths.hpp"
#include "field/shaped_field.hpp"
#include "simulation/zone_rates.hpp"
#include "spin/angular_momentum.hpp"
#include "spin/levels.hpp"

namespace rabiline {
namespace {

using constants::two_pi;
using Complex = std::complex<double>;
using State = Eigen::VectorXcd;

/// H = zero + B . moment in rad/s, and levels along a field, in products of the states of J and I along z.
class Spins {
 public:
  explicit Spins(const CoupledSpins& spins)
      : spins_(spins), zero_(Eigen::MatrixXcd::Zero(spins.levels(), spins.levels())) {
    const AngularMomentum j = angular_momentum(spins.twice_j), i = angular_momentum(spins.twice_i);
    const Eigen::MatrixXd one_j = Eigen::MatrixXd::Identity(j.z.rows(), j.z.rows()),
                          one_i = Eigen::MatrixXd::Identity(i.z.rows(), i.z.rows());
    const Complex minus_i(0, -1);
    const Eigen::MatrixXcd all_of_j[3] = {kronecker(j.x, one_i).cast<Complex>(),
                                          minus_i * kronecker(j.i_times_y, one_i).cast<Complex>(),
                                          kronecker(j.z, one_i).cast<Complex>()},
                           all_of_i[3] = {kronecker(one_j, i.x).cast<Complex>(),
                                          minus_i * kronecker(one_j, i.i_times_y).cast<Complex>(),
                                          kronecker(one_j, i.z).cast<Complex>()};
    Eigen::MatrixXcd product = zero_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const Eigen::MatrixXcd &of_j = all_of_j[axis], &of_i = all_of_i[axis];
      product += of_j * of_i;
      moment_[axis] = two_pi * (spins.zeeman_j * of_j + spins.zeeman_i * of_i);
      total_[axis] = of_j + of_i;
    }
    zero_ = two_pi * (spins.coupling * product + spins.coupling_squared * product * product);
    zero_ -= zero_.trace() / static_cast<double>(spins.levels()) *
             Eigen::MatrixXcd::Identity(spins.levels(), spins.levels());
  }

  int levels() const { return spins_.levels(); }
  const Eigen::MatrixXcd& zero() const { return zero_; }
  Eigen::MatrixXcd with_moment(const Vector3& b) const {
    return b.x * moment_[0] + b.y * moment_[1] + b.z * moment_[2];
  }
  /// What bounds its eigenvalues in a field of that size.
  double radius(double field) const {
    return zero_.cwiseAbs().rowwise().sum().maxCoeff() +
           field * moment_[2].cwiseAbs().rowwise().sum().maxCoeff();
  }
  /// Columns are the levels along a direction in a field of the size `to`, with the signs of those in `from`.
  Eigen::MatrixXcd states(const Vector3& n, double from, double to) const {
    const double polar = portable::atan2(portable::hypot(n.x, n.y, 0), n.z),
                 azimuth = portable::atan2(n.y, n.x);
    Eigen::MatrixXd out = levels_at(spins_, from).states;
    const int parts = from == to ? 0 : spins_.coupling_squared == 0 ? 1 : 64;
    for (int i = 1; i <= parts; ++i) {
      Eigen::MatrixXd next = levels_at(spins_, from + (to - from) * i / parts).states;
      for (Eigen::Index k = 0; k < next.cols() && parts > 1; ++k)
        if (next.col(k).dot(out.col(k)) < 0) next.col(k) *= -1;
      out = std::move(next);
    }
    return turn(2, azimuth) * turn(1, polar) * out.cast<Complex>();
  }

 private:
  Eigen::MatrixXcd turn(std::size_t axis, double angle) const {
    const auto own = eigensystem_of(total_[axis]);
    State phases(levels());
    for (Eigen::Index k = 0; k < phases.size(); ++k)
      phases(k) = Complex(portable::cos(angle * own.values(k)), -portable::sin(angle * own.values(k)));
    return own.vectors * phases.asDiagonal() * own.vectors.adjoint();
  }

  const CoupledSpins& spins_;
  Eigen::MatrixXcd zero_;
  std::array<Eigen::MatrixXcd, 3> moment_, total_;
};

/// One particle on a way.
class FollowedAtom {
 public:
  FollowedAtom(const LevelWay& way, const Spins& spins, const RandomKey& key, const StraightFlight& flight)
      : way_(way), spins_(spins), key_(key), flight_(flight) {}

  /// The operations for each halving of the steps.
  double work() const {
    double steps = 0;
    for (const CourseSection& section : way_.fields().sections) steps += stay(section) / longest(section);
    constexpr double terms = 40;
    return steps * terms * spins_.levels() * spins_.levels();
  }
  std::vector<double> probabilities(double share) {
    Vector3 last{}, direction{0, 0, 1};
    State a = State::Unit(spins_.levels(), flight_.level), state = spins_.states(direction, 0, 0) * a;
    const LevelFields& fields = way_.fields();
    const CourseSection* before = nullptr;
    for (const CourseSection& section : fields.sections) {
      enter(section);
      const double begin = time_at(section.field.begin), end = time_at(section.field.end);
      const std::vector<Edge> edges = edges_of(section, begin, end);
      moment_ = flight_.t + (begin + edges.front().s) / 2;
      const Vector3 entry = static_at(section, begin);
      if (before == nullptr && fields.begins_in_field)
        state = spins_.states(axis_of(entry, direction), length_of(entry), length_of(entry)) * a;
      else
        state = renamed(state, last, direction, entry, axis_of(entry, direction),
                        before != nullptr ? begin - time_at(before->field.end) : 0,
                        before != nullptr && before->field.end == section.field.begin);
      double s = begin;
      Vector3 along = axis_of(entry, direction);
      for (const auto& [edge, is_face] : edges) {
        moment_ = flight_.t + (s + edge) / 2;
        const int steps = static_cast<int>(std::ceil((edge - s) / (share * longest(section))));
        for (int i = 0; i < steps; ++i)
          advance(section, s + i * ((edge - s) / steps), (edge - s) / steps, state);
        s = edge;
        if (!is_face) continue;
        const double hair = section.hair() / flight_.velocity.y;
        const Vector3 left = static_at(section, s - hair), met = static_at(section, s + hair),
                      old = axis_of(left, along);
        along = axis_of(met, old);
        state = renamed(state, left, old, met, along, 0, true);
      }
      last = static_at(section, end);
      direction = axis_of(last, direction);
      before = &section;
    }
    if (const bool met = fields.ends_in_field && fields.behind > 0;
        met || !fields.ends_in_field || length_of(last) == 0) {
      constexpr Vector3 along_z{0, 0, 1};
      const Vector3 next = met ? fields.behind * along_z : Vector3{};
      state = renamed(state, last, direction, next, along_z, 0, met);
      last = next;
      direction = along_z;
    }
    const State found = spins_.states(direction, length_of(last), length_of(last)).adjoint() * state;
    std::vector<double> p;
    for (const Complex& amplitude : found) p.push_back(std::norm(amplitude));
    return p;
  }

 private:
  double time_at(double y) const { return (y - flight_.place.y) / flight_.velocity.y; }
  double stay(const CourseSection& section) const {
    return (section.field.end - section.field.begin) / flight_.velocity.y;
  }
  static Vector3 axis_of(const Vector3& b, const Vector3& else_along) {
    return length_of(b) > 0 ? (1 / length_of(b)) * b : else_along;
  }
  void enter(const CourseSection& section) {
    for (int i = 0; i < section.field.drives; ++i)
      phases_[i] = phase_of(section.field.drive[i], key_, flight_.particle);
  }
  struct Edge {
    double s;
    bool is_face;  // where a static field may jump
  };
  /// The moments within at which pulses are switched, a course bends or the field jumps, and the end.
  std::vector<Edge> edges_of(const CourseSection& section, double begin, double end) const {
    std::vector<Edge> out;
    for (int i = 0; i < section.field.drives; ++i) {
      const Gate& gate = section.field.drive[i].gate;
      if (gate.begin == gate.end) continue;
      const double first = gate.period > 0 ? std::floor((flight_.t + begin - gate.end) / gate.period) : 0;
      for (double pulse = std::max(0.0, first); pulse < gate.times; ++pulse) {
        const double on = gate.begin + pulse * gate.period - flight_.t;
        if (on >= end) break;
        for (const double edge : {on, on + (gate.end - gate.begin)})
          if (edge > begin && edge < end) out.push_back({edge, false});
      }
    }
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      if (const TimeCourse& course = way_.fields().shaped[static_cast<std::size_t>(i)].course;
          course.nodes > 0)
        for (double s = begin; s < end; out.push_back({s, false}))
          s = next_stop<HostMaths>(course, (flight_.t + s) * (1 + 1e-14), flight_.t + end) - flight_.t;
    const double soonest = 2 * section.hair() / flight_.velocity.y,
                 bend = portable::hypot(flight_.fall.x, flight_.fall.z, 0);
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      for (double s = begin; s < end; out.push_back({s, true})) {
        const Vector3 r = place_at(s), v = flight_.velocity;
        s += time_to_face<HostMaths>(way_.fields().shaped[static_cast<std::size_t>(i)], {r.x, r.y, r.z},
                                     {v.x + flight_.fall.x * s, v.y, v.z + flight_.fall.z * s}, bend, soonest,
                                     end - s);
      }
    std::erase_if(out, [&](const Edge& edge) { return edge.s > end - soonest; });
    out.push_back({end, false});
    std::ranges::sort(out, {}, &Edge::s);
    return out;
  }
  Vector3 place_at(double s) const {
    const Vector3 &r = flight_.place, &v = flight_.velocity;
    return {r.x + (v.x + flight_.fall.x * s / 2) * s, r.y + v.y * s,
            r.z + (v.z + flight_.fall.z * s / 2) * s};
  }
  Vector3 field_at(const CourseSection& section, double s, bool all = true) const {
    const Vector3 place = place_at(s);
    FieldHere<double> here{};
    const double y =
        std::clamp(place.y, section.field.begin + section.hair(), section.field.end - section.hair());
    for (int i = section.shaped_begin; i < section.shaped_end; ++i)
      if (const ShapedTerm& term = way_.fields().shaped[static_cast<std::size_t>(i)]; all || !term.moves())
        add_field_at(term, section.field, phases_, {place.x, y, place.z}, flight_.t + s, here);
    return rates_of(section.field, phases_, place, flight_.t + s, moment_).spin + vector_at(here.field);
  }
  /// Of what stands still.
  Vector3 static_at(const CourseSection& section, double s) const {
    CourseSection still = section;
    still.field.drives = 0;
    return field_at(still, s, false);
  }
  /// [T] Of all that swings, at any time.
  double peaks_at(const CourseSection& section, double s) const {
    const Vector3 place = place_at(s);
    double sum = 0;
    for (int i = section.shaped_begin; i < section.shaped_end; ++i) {
      const ShapedTerm& term = way_.fields().shaped[static_cast<std::size_t>(i)];
      FieldHere<double> peak{};
      if (term.drive >= 0) add_field<HostMaths>(term, place.x, place.y, place.z, peak);
      sum += length_of(vector_at(peak.field));
    }
    return sum;
  }
  /// [s] Of a step before it is halved: by what turns the state, and what the field does.
  double longest(const CourseSection& section) const {
    constexpr int places = 16;
    double most = 0;
    for (int i = 0; i <= places; ++i) {
      const double s = time_at(section.field.begin) + i * (stay(section) / places);
      most = std::max(most, length_of(field_at(section, s)) + peaks_at(section, s));
    }
    for (int i = 0; i < section.field.drives; ++i) most += std::abs(section.field.drive[i].spin_rate);
    const double drives = section.fastest > 0 ? 0.3 / section.fastest : stay(section);
    return std::min({6 / spins_.radius(most), drives, stay(section) / 100});
  }
  /// Where static fields meet, behind what drove before and before what drives then, levels keep their names
  /// while the size changes, and the direction changes at once in the smaller of both fields; in none where
  /// there is a gap of the time `stay` between them.
  State renamed(const State& state, const Vector3& from, const Vector3& old, const Vector3& to,
                const Vector3& next, double stay, bool touches) const {
    const double size = length_of(from), least = touches ? std::min(size, length_of(to)) : 0;
    const State named = spins_.states(old, size, size).adjoint() * state,
                turned = spins_.states(next, least, least).adjoint() *
                         rested(spins_.states(old, size, least) * named, stay);
    return spins_.states(next, least, length_of(to)) * turned;
  }
  /// After a time in no field.
  State rested(const State& state, double stay) const {
    if (stay == 0) return state;
    const auto own = eigensystem_of(spins_.zero());
    State along = own.vectors.adjoint() * state;
    for (Eigen::Index k = 0; k < along.size(); ++k) {
      const double angle = own.values(k) * stay;
      along(k) *= Complex(portable::cos(angle), -portable::sin(angle));
    }
    return own.vectors * along;
  }
  /// One step from s: with H h = K_0 + K_1 u + ..., u from 0 to 1, the series' terms follow from one another.
  void advance(const CourseSection& section, double s, double h, State& state) const {
    static const Eigen::Matrix4d coefficients = [] {
      Eigen::Matrix4d vandermonde;
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 4; ++k) vandermonde(i, k) = k == 0 ? 1 : vandermonde(i, k - 1) * nodes[i];
      return Eigen::Matrix4d(vandermonde.inverse());
    }();
    Vector3 b[4], of_power[4] = {};
    for (int i = 0; i < 4; ++i) b[i] = field_at(section, s + nodes[i] * h);
    for (int k = 0; k < 4; ++k)
      for (int i = 0; i < 4; ++i) of_power[k] = of_power[k] + coefficients(k, i) * b[i];
    Eigen::MatrixXcd hamiltonian[4];
    bool acts[4];
    for (int k = 0; k < 4; ++k) {
      hamiltonian[k] = Complex(0, -h) * spins_.with_moment(of_power[k]);
      if (k == 0) hamiltonian[k] += Complex(0, -h) * spins_.zero();
      acts[k] = hamiltonian[k].cwiseAbs().maxCoeff() > 1e-17;
    }
    constexpr int most = 100;
    std::vector<State> term{state};
    for (int n = 0, small = 0; n < most && small < 4; ++n) {
      State next = State::Zero(state.size());
      for (int k = 0; k <= std::min(n, 3); ++k)
        if (acts[k]) next.noalias() += hamiltonian[k] * term[static_cast<std::size_t>(n - k)];
      next /= n + 1;
      small = next.squaredNorm() < 1e-32 ? small + 1 : 0;
      state += next;
      term.push_back(std::move(next));
    }
  }

  /// Gauss's, of a step from 0 to 1.
  static constexpr double nodes[4] = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                      0.93056815579702629};
  const LevelWay& way_;
  const Spins& spins_;
  const RandomKey& key_;
  const StraightFlight& flight_;
  double phases_[most_drives] = {};
  double moment_ = 0;  // [s] for which pulses are followed
};

}  // namespace

LevelReference::LevelReference(const LevelWay& way, const RandomKey& key) : way_(way), key_(key) {}

std::optional<std::vector<double>> LevelReference::carried(const StraightFlight& flight,
                                                           double& operations) const {
  const Spins spins(way_.table().spins());
  FollowedAtom atom(way_, spins, key_, flight);
  const double work = atom.work();
  std::optional<std::vector<double>> before;
  for (double share = 1; work / share <= operations; share /= 2) {
    std::vector<double> now = atom.probabilities(share);
    operations -= work / share;
    double error = before ? 0 : 1;
    for (std::size_t k = 0; before && k < now.size(); ++k)
      error = std::max(error, std::abs(now[k] - (*before)[k]));
    if (error < 0.05 * way_.fields().tolerance) return now;
    before = std::move(now);
  }
  return std::nullopt;
}

}  // namespace rabiline
