#include "simulation/screen_covariance.hpp"

#include <algorithm>

#include "simulation/counting.hpp"

namespace rabiline {
namespace {

constexpr double one_particle = static_cast<double>(quanta_per_particle);  // [quanta]

/// P(from -> to) is a polynomial in the flip probability p of a spin 1/2 (MajoranaTable): of a power of p.
double coefficient(const SpinPath& path, std::size_t from, int to, int power) {
  if (path.levels == 2) {
    const bool stays = static_cast<int>(from) == to;
    return power == 0 ? (stays ? 1 : 0) : (stays ? -1 : 1);
  }
  return path.polynomials[(from * static_cast<std::size_t>(path.levels) + static_cast<std::size_t>(to)) *
                              static_cast<std::size_t>(path.levels) +
                          static_cast<std::size_t>(power)];
}

/// Products of powers of p in what the screen counts of pairs of paths: [i][j], each over the nodes.
std::vector<std::vector<Eigen::VectorXd>> products_of_powers(const SpinPath& path,
                                                             const TransitLayout& layout,
                                                             const TransitNodes::WholeScreen& screen) {
  const auto levels = static_cast<std::size_t>(path.levels);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(screen.paths.front().front().size());
  std::vector<std::vector<Eigen::VectorXd>> of(levels, std::vector<Eigen::VectorXd>(levels, none));
  for (std::size_t from = 0; from < layout.levels(); ++from)
    for (std::size_t a = 0; a < layout.outcomes(from).size(); ++a)
      for (std::size_t b = 0; b < layout.outcomes(from).size(); ++b) {
        const Eigen::VectorXd& pair = screen.pairs[from][a][b];
        for (std::size_t i = 0; i < levels; ++i)
          for (std::size_t j = 0; j < levels; ++j)
            of[i][j] += pair * (coefficient(path, from, layout.outcomes(from)[a], static_cast<int>(i)) *
                                coefficient(path, from, layout.outcomes(from)[b], static_cast<int>(j)));
      }
  return of;
}

/// Sum of w^2 P, as powers of p.
std::vector<Eigen::VectorXd> powers_in_counts(const SpinPath& path, const TransitLayout& layout,
                                              const TransitNodes::WholeScreen& screen) {
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(screen.paths.front().front().size());
  std::vector<Eigen::VectorXd> of(static_cast<std::size_t>(path.levels), none);
  for (std::size_t from = 0; from < layout.levels(); ++from)
    for (std::size_t a = 0; a < layout.outcomes(from).size(); ++a)
      for (std::size_t i = 0; i < of.size(); ++i)
        of[i] +=
            screen.pairs[from][a][a] * coefficient(path, from, layout.outcomes(from)[a], static_cast<int>(i));
  return of;
}

/// The flip probability of a spin 1/2 at the nodes, for every way: [way][node], ways in eights.
Eigen::MatrixXd flips_of(const PlanTree& tree, const PlanNode& projection, const TransitNodes& nodes) {
  const auto ways = static_cast<Eigen::Index>(projection.ways.size());
  Eigen::MatrixXd flips = Eigen::MatrixXd::Zero((ways + 7) / 8 * 8, nodes.size());
  for (Eigen::Index way = 0; way < ways; ++way)
    flips.row(way) =
        nodes.flips(*path_of(projection.ways[static_cast<std::size_t>(way)].stage), tree.source.key);
  return flips;
}

/// How few they are in a group varies by Poisson's law, so their sums vary between groups as sum of w^2 P P'.
/// In sum of w^2 P they weigh w as all particles do on average. `together`: between the ways from `first` on.
void add_stragglers(const Eigen::MatrixXd& in_groups, Eigen::Index first, Eigen::MatrixXd& together) {
  const Eigen::Index ways = std::min(together.rows(), in_groups.rows() - first);
  if (ways <= 0) return;
  const auto groups = static_cast<double>(in_groups.cols());
  const Eigen::MatrixXd here = in_groups.middleRows(first, ways);
  const Eigen::MatrixXd off = here.colwise() - here.rowwise().mean();
  together.topLeftCorner(ways, ways) += off * off.transpose() * (groups / (groups - 1));
}

}  // namespace

/// Of counts C = sum of w P over particles that were emitted with sum of v = W: the sum over all of them of
/// (w P - r v)(w P' - r' v), r = C/W. What is emitted weighs v = 1, and sum of v w P is the count; or, of an
/// aimed source, nothing on the way has changed its weight, and w = v (plan/transits.cpp).
ScreenCovariance covariance_of(const PlanTree& tree, const PlanNode& projection, const TransitNodes& nodes,
                               const TransitNodes::WholeScreen& screen, double share, int part,
                               Eigen::VectorXd counted, const Eigen::MatrixXd& stragglers, const Sums& sums) {
  const TransitLayout& layout = *projection.transit;
  const SpinPath& path = *path_of(projection.stage);
  const auto products = products_of_powers(path, layout, screen);
  const auto singles = powers_in_counts(path, layout, screen);
  const Eigen::MatrixXd flips = flips_of(tree, projection, nodes);
  const Eigen::Index ways = flips.rows();

  std::vector<Eigen::MatrixXd> power(products.size());  // of the flips, the 0th left out
  power[1] = flips;
  for (std::size_t i = 2; i < power.size(); ++i) power[i] = power[i - 1].cwiseProduct(flips);

  Eigen::VectorXd weighted = Eigen::VectorXd::Constant(ways, singles[0].sum());
  for (std::size_t i = 1; i < power.size(); ++i) weighted += power[i] * singles[i];
  weighted *= share / one_particle;
  const double emitted = static_cast<double>(sums[tree.sums + EmissionSums::q()]) / one_particle,
               emitted2 =
                   static_cast<double>(sums[tree.sums + EmissionSums::q2()]) / one_particle / one_particle;
  const bool some_strayed = !stragglers.isZero(0);
  if (some_strayed) weighted.head(stragglers.rows()) += stragglers.rowwise().sum() * (emitted2 / emitted);
  counted.conservativeResizeLike(Eigen::VectorXd::Zero(ways));
  if (!sums_of(tree.source).weights_differ) weighted = counted;
  const Eigen::VectorXd rate = counted / emitted;

  /// Between the ways of a block.
  const auto between = [&](Eigen::Index first, Eigen::Index count) {
    Eigen::MatrixXd together = Eigen::MatrixXd::Constant(count, count, products[0][0].sum());
    for (std::size_t i = 1; i < power.size(); ++i) {
      const Eigen::MatrixXd own = power[i].middleRows(first, count);
      const Eigen::VectorXd with_one = own * products[i][0];
      together.colwise() += with_one;
      together.rowwise() += with_one.transpose();
      Eigen::MatrixXd others = Eigen::MatrixXd::Zero(count, nodes.size());
      for (std::size_t j = 1; j < power.size(); ++j)
        others += power[j].middleRows(first, count) * products[i][j].asDiagonal();
      kernel::add_products(best_isa())(own.data(), others.data(), count, nodes.size(), together.data());
    }
    together.triangularView<Eigen::StrictlyUpper>() = together.transpose();
    together *= share * share / one_particle;
    if (some_strayed) add_stragglers(stragglers, first, together);
    const Eigen::VectorXd w = weighted.segment(first, count), r = rate.segment(first, count);
    Eigen::MatrixXd covariance =
        together - w * r.transpose() - r * w.transpose() + emitted2 * r * r.transpose();
    covariance.diagonal() = covariance.diagonal().cwiseMax(0);
    return covariance;
  };

  ScreenCovariance out{part};
  for (std::size_t way = 0; way < projection.ways.size(); ++way)
    for (const int point : projection.ways[way].points) {
      out.way_of.resize(std::max(out.way_of.size(), static_cast<std::size_t>(point) + 1));
      out.way_of[static_cast<std::size_t>(point)] = static_cast<Eigen::Index>(way);
    }
  if (projection.ways.size() <= most_points_of_covariance) {
    out.between_ways = between(0, ways);
    out.of_ways = out.between_ways.diagonal();
    return out;
  }
  constexpr Eigen::Index at_once = 64;
  out.of_ways.resize(ways);
  for (Eigen::Index first = 0; first < ways; first += at_once) {
    const Eigen::Index count = std::min(at_once, ways - first);
    out.of_ways.segment(first, count) = between(first, count).diagonal();
  }
  return out;
}

}  // namespace rabiline
