#include "plan/frequency_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "core/portable_math.hpp"
#include "plan/transit_links.hpp"

namespace rabiline {
namespace {

/// Of probabilities, and of their squares, which errors follow from.
constexpr double most_error = 1e-11, most_error_of_squares = 1e-5;
/// What a probability may be off at scan points that are looked at: levels that are GHz apart are known to
/// 1e-10, since their energies are numbers of 16 digits.
constexpr double most_seen = 5e-10;
constexpr int numbers_of_nodes[] = {12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512};
/// More are not kept, in all classes.
constexpr std::size_t most_sums = std::size_t{1} << 22;
/// To work out the transitions at one frequency and to look at them: [s], and as long as so many particles.
constexpr double cost_of_node = 4e-4, particles_of_node = 3000;

/// What a function of type tau, at most 1 in size on the real line, is off the polynomial through n Chebyshev
/// points at most: 4 M/(rho^(n-1) (rho - 1)), M = exp(tau (rho - 1/rho)/2) its size on the ellipse rho, which
/// is chosen best.
double error_between(double tau, int n) {
  const double degree = n - 1;
  if (tau >= degree) return std::numeric_limits<double>::infinity();
  if (tau == 0) return 0;
  const double rho = (degree + std::sqrt(degree * degree - tau * tau)) / tau;
  return portable::exp(tau * (rho - 1 / rho) / 2 - degree * portable::log(rho)) * 4 / (rho - 1);
}
/// The largest type that n points serve. A square has twice the type.
double type_served(int n) {
  double low = 0, high = n;
  for (int i = 0; i < 50; ++i) {
    const double tau = (low + high) / 2;
    const bool serves =
        error_between(tau, n) <= most_error && error_between(2 * tau, n) <= most_error_of_squares;
    (serves ? low : high) = tau;
  }
  return low;
}

/// Reweightings that differ in the frequency of one clock alone.
struct Family {
  std::vector<std::size_t> members;  // of the node's reweightings
  std::vector<double> frequencies;   // [Hz] of each
  double low() const { return *std::ranges::min_element(frequencies); }
  double high() const { return *std::ranges::max_element(frequencies); }
};

/// The polynomial through values at Chebyshev's points of a range, in its barycentric form.
class Interpolant {
 public:
  Interpolant(double low, double high, int n) {
    for (int j = 0; j < n; ++j)
      points_.push_back((low + high) / 2 +
                        (high - low) / 2 * portable::cos(std::numbers::pi * (j + 0.5) / n));
    for (const double point : points_) {
      double product = 1;
      for (const double other : points_)  // 4/(high - low) for each keeps the product of so many near 1
        if (other != point) product *= (point - other) * 4 / (high - low);
      scales_.push_back(1 / product);
    }
  }
  const std::vector<double>& points() const { return points_; }
  /// Of the values at the points, at x.
  std::vector<double> weights(double x) const {
    std::vector<double> weights(points_.size());
    double sum = 0;
    for (std::size_t j = 0; j < points_.size(); ++j) {
      if (x == points_[j]) {
        std::ranges::fill(weights, 0.0);
        weights[j] = 1;
        return weights;
      }
      weights[j] = scales_[j] / (x - points_[j]);
      sum += weights[j];
    }
    for (double& weight : weights) weight /= sum;
    return weights;
  }

 private:
  std::vector<double> points_, scales_;
};

class NodeMaker {
 public:
  NodeMaker(PlanTree& tree, SampledTables& tables, const SpeedRange& speeds, int threads, std::size_t& sums)
      : tree_(tree), tables_(tables), speeds_(speeds), threads_(threads), sums_(sums) {}

  void visit(std::vector<PlanNode>& nodes) {
    for (PlanNode& node : nodes)
      if (node.reweightings.empty())
        visit(node.next);
      else if (!node.transit && !node.next.empty())
        lay_out(node);
  }

 private:
  void lay_out(PlanNode& node) {
    if (node.reweightings.size() < 2 || reads_what_is_not_sorted(node)) return;
    const std::vector<Family> families = families_of(node);
    if (families.empty()) return;
    std::vector<SlownessClass> classes = classes_of(node, families);
    if (classes.empty()) return;
    tables_.work_out_transitions(threads_);
    const auto wrong =
        std::ranges::find_if_not(classes, [&](const SlownessClass& one) { return holds(node, one); });
    classes.erase(wrong, classes.end());
    for (SlownessClass& one : classes)
      for (FrequencyNodes& family : one.families)
        family.sums = std::exchange(sums_, sums_ + family.nodes.size() * sums_of_reweighting(node));
    node.classes = std::move(classes);
  }

  /// Particles that were caught in front of the projection are not sorted by their slowness.
  static bool reads_what_is_not_sorted(const PlanNode& projection) {
    for (const PlanNode* node = &projection; !node->next.empty();) {
      node = &node->next.front();
      if (reads_earlier_catch(node->stage, projection)) return true;
    }
    return false;
  }

  // ---- which reweightings ----

  const SampledTables::Driven& driven(const Stage& stage) const {
    return tables_.driven_by(path_of(stage)->transitions);
  }
  static double frequency_of(const std::vector<LevelZone>& zones) {
    return std::ranges::find_if(zones, [](const LevelZone& zone) { return zone.drive.has_value(); })
        ->drive->oscillator.frequency;
  }
  static std::vector<LevelZone> at_frequency(std::vector<LevelZone> zones, double frequency) {
    for (LevelZone& zone : zones)
      if (zone.drive) zone.drive->oscillator.frequency = frequency;
    return zones;
  }
  /// The stage but for what drives the levels.
  static Stage undriven(const Stage& stage) {
    SpinPath path = *path_of(stage);
    path.transitions = nullptr;
    return with_path(stage, path);
  }
  bool differ_in_frequency_alone(const Stage& a, const Stage& b) const {
    const SampledTables::Driven &one = driven(a), &other = driven(b);
    return one.structure == other.structure && one.largest_slowness == other.largest_slowness &&
           at_frequency(one.zones, 0) == at_frequency(other.zones, 0) && undriven(a) == undriven(b);
  }
  /// All reweightings; none where some have no closed form with one frequency.
  std::vector<Family> families_of(const PlanNode& node) const {
    std::vector<Family> families;
    for (std::size_t i = 0; i < node.reweightings.size(); ++i) {
      const Stage& stage = node.reweightings[i].stage;
      const DrivenLevels* transitions = path_of(stage)->transitions;
      if (transitions == nullptr || transitions->photons() == 0) return {};
      auto family = std::ranges::find_if(families, [&](const Family& known) {
        return differ_in_frequency_alone(node.reweightings[known.members.front()].stage, stage);
      });
      if (family == families.end()) {
        if (families.size() == most_families) return {};
        family = families.emplace(families.end());
      }
      family->members.push_back(i);
      family->frequencies.push_back(frequency_of(driven(stage).zones));
    }
    return families;
  }

  // ---- at which frequencies ----

  /// tau of a particle's slowness [m/s].
  double turning_of(const PlanNode& node, const Family& family) const {
    const Stage& stage = node.reweightings[family.members.front()].stage;
    double begin = std::numeric_limits<double>::infinity(), end = 0;
    for (const LevelZone& zone : driven(stage).zones) {
      if (!zone.drive) continue;
      begin = std::min(begin, zone.begin);
      end = std::max(end, zone.end);
    }
    return std::numbers::pi * path_of(stage)->transitions->photons() * (end - begin) *
           (family.high() - family.low());
  }

  /// None where to book each reweighting is the shorter way.
  std::vector<SlownessClass> classes_of(const PlanNode& node, const std::vector<Family>& families) {
    double turning = 0;
    std::size_t fewest = node.reweightings.size();
    for (const Family& family : families) {
      turning = std::max(turning, turning_of(node, family));
      fewest = std::min(fewest, family.members.size());
    }
    if (turning == 0) return {};
    std::vector<std::pair<int, double>> numbers;  // of nodes, and up to which slowness
    std::size_t all = 0, of_mean = 0;
    for (const int n : numbers_of_nodes) {
      const double last = type_served(n) / turning;
      if (last < 1 / speeds_.fastest) continue;
      if (2 * static_cast<std::size_t>(n) > fewest) break;
      numbers.emplace_back(n, last);
      all += static_cast<std::size_t>(n) * families.size();
      if (of_mean == 0 && last * tree_.source.speed.mean >= 1)
        of_mean = static_cast<std::size_t>(n) * families.size();
      if (last * speeds_.slowest >= 1) break;
    }
    const Stage& stage = node.reweightings.front().stage;
    const double of_one = cost_of(stage, tree_.source.speed.mean),
                 of_node = cost_of_node + particles_of_node * of_one,
                 saved = static_cast<double>(tree_.last - tree_.first) *
                         static_cast<double>(node.reweightings.size() - of_mean) * of_one;
    if (of_mean == 0 || all * sums_of_reweighting(node) > most_sums ||
        saved < of_node * static_cast<double>(all))
      return {};
    std::vector<SlownessClass> classes;
    for (const auto& [n, last] : numbers) {
      SlownessClass& one = classes.emplace_back(SlownessClass{last});
      for (const Family& family : families) one.families.push_back(nodes_of(node, family, n));
    }
    return classes;
  }

  FrequencyNodes nodes_of(const PlanNode& node, const Family& family, int n) {
    const Stage& stage = node.reweightings[family.members.front()].stage;
    const SampledTables::Driven& made = driven(stage);
    const Interpolant interpolant(family.low(), family.high(), n);
    FrequencyNodes out{family.members};
    SpinPath path = *path_of(stage);
    for (const double frequency : interpolant.points()) {
      path.transitions =
          &tables_.transitions(made.structure, at_frequency(made.zones, frequency), made.largest_slowness);
      out.nodes.push_back(with_path(stage, path));
    }
    for (const double frequency : family.frequencies) {
      const std::vector<double> weights = interpolant.weights(frequency);
      out.weights.insert(out.weights.end(), weights.begin(), weights.end());
    }
    return out;
  }

  // ---- whether that holds ----

  /// Shares of particles in each level, of some slownesses up to the last.
  std::vector<double> shares_at(const Stage& stage, double last) const {
    constexpr int slownesses = 8;
    const SpinPath& path = *path_of(stage);
    Batch batch;
    BatchView& b = batch.view();
    b.count = b.padded = slownesses * path.levels;
    for (int i = 0; i < b.count; ++i) {
      b.slowness[i] = last * (i % slownesses + 1) / slownesses;
      b.vy[i] = 1 / b.slowness[i];
      b.level[i] = static_cast<std::uint64_t>(i / slownesses);
      b.particle[i] = static_cast<std::uint64_t>(i);
      b.weight[i] = quanta_per_particle;
    }
    struct alignas(64) Line {
      std::uint64_t of[8];
    };
    std::vector<Line> lines(static_cast<std::size_t>(path.levels * slownesses * path.levels) / 8);
    share_levels(path, tree_.source.key, best_isa(), b, b.weight, lines.front().of);
    std::vector<double> shares;
    for (const Line& line : lines)
      for (const std::uint64_t share : line.of)
        shares.push_back(static_cast<double>(share) / static_cast<double>(quanta_per_particle));
    return shares;
  }

  /// It leads to no level that no path is flown in: which levels go over into one another may depend on the
  /// frequency.
  static bool keeps_to_paths(const PlanNode& node, const Stage& stage) {
    const DrivenLevels& transitions = *path_of(stage)->transitions;
    for (std::size_t from = 0; from < node.reachable_levels.size(); ++from)
      if ((transitions.reachable_from(static_cast<int>(from)) & ~node.reachable_levels[from]) != 0)
        return false;
    return true;
  }

  /// That what drives an atom depends on its frequency in no other way is seen, not known: shifts by far
  /// levels do, a little, and steps through profiles, whose number may change.
  bool holds(const PlanNode& node, const SlownessClass& one) const {
    return std::ranges::all_of(one.families, [&](const FrequencyNodes& family) {
      if (!std::ranges::all_of(family.nodes, [&](const Stage& stage) { return keeps_to_paths(node, stage); }))
        return false;
      std::vector<std::vector<double>> known;
      for (const Stage& stage : family.nodes) known.push_back(shares_at(stage, one.last));
      const std::size_t count = family.reweightings.size(),
                        every = (count + most_looked_at - 1) / most_looked_at;
      for (std::size_t i = 0; i < count; i += every) {
        const double* weights = &family.weights[i * known.size()];
        std::vector<double> off = shares_at(node.reweightings[family.reweightings[i]].stage, one.last);
        for (std::size_t j = 0; j < known.size(); ++j)
          for (std::size_t k = 0; k < off.size(); ++k) off[k] -= weights[j] * known[j][k];
        if (std::ranges::any_of(off, [](double x) { return std::abs(x) > most_seen; })) return false;
      }
      return true;
    });
  }

  static constexpr std::size_t most_families = 64, most_looked_at = 32;

  PlanTree& tree_;
  SampledTables& tables_;
  const SpeedRange speeds_;
  const int threads_;
  std::size_t& sums_;
};

}  // namespace

void lay_out_frequency_nodes(PlanTree& tree, SampledTables& tables, const SpeedRange& speeds, int threads,
                             std::size_t& sums) {
  NodeMaker(tree, tables, speeds, threads, sums).visit(tree.next);
}

}  // namespace rabiline
