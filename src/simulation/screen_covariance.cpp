#include "simulation/screen_covariance.hpp"

#include <algorithm>

#include "core/in_parallel.hpp"
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

/// Of counts C = sum of w P over particles that were emitted with sum of v = W: the sum over all of them of
/// (w P - r v)(w P' - r' v), r = C/W. What is emitted weighs v = 1, and sum of v w P is the count; or, of an
/// aimed source, nothing on the way has changed its weight, and w = v (plan/transits.cpp).
///
/// How few stragglers are in a group varies by Poisson's law, so their sums vary between groups as sum of
/// w^2 P P'. In sum of w^2 P they weigh w as all particles do on average.
class CovarianceMaker {
 public:
  CovarianceMaker(const PlanTree& tree, const PlanNode& projection, const TransitNodes& nodes,
                  const TransitNodes::WholeScreen& screen, double share, const Eigen::VectorXd& counted,
                  const Eigen::MatrixXd& stragglers, const Sums& sums)
      : tree_(tree),
        projection_(projection),
        nodes_(nodes),
        products_(products_of_powers(*path_of(projection.stage), *projection.transit, screen)),
        singles_(powers_in_counts(*path_of(projection.stage), *projection.transit, screen)),
        share_(share),
        counted_(counted),
        stragglers_(stragglers),
        some_strayed_(!stragglers.isZero(0)),
        weights_differ_(sums_of(tree.source).weights_differ),
        emitted_(static_cast<double>(sums[tree.sums + EmissionSums::q()]) / one_particle),
        emitted2_(static_cast<double>(sums[tree.sums + EmissionSums::q2()]) / one_particle / one_particle) {}

  /// Of all ways, which are filled up to eights.
  Eigen::MatrixXd between_all() const {
    const Eigen::MatrixXd flips = flips_of(tree_, projection_, nodes_);
    const Eigen::Index ways = flips.rows();
    std::vector<Eigen::MatrixXd> power(products_.size());  // of the flips, the 0th left out
    power[1] = flips;
    for (std::size_t i = 2; i < power.size(); ++i) power[i] = power[i - 1].cwiseProduct(flips);

    Eigen::MatrixXd together = Eigen::MatrixXd::Constant(ways, ways, products_[0][0].sum());
    for (std::size_t i = 1; i < power.size(); ++i) {
      const Eigen::VectorXd with_one = power[i] * products_[i][0];
      together.colwise() += with_one;
      together.rowwise() += with_one.transpose();
      Eigen::MatrixXd others = Eigen::MatrixXd::Zero(ways, nodes_.size());
      for (std::size_t j = 1; j < power.size(); ++j) others += power[j] * products_[i][j].asDiagonal();
      kernel::add_products(best_isa())(power[i].data(), others.data(), ways, nodes_.size(), together.data());
    }
    together.triangularView<Eigen::StrictlyUpper>() = together.transpose();
    together *= share_ * share_ / one_particle;
    if (some_strayed_) add_stragglers(together);

    Eigen::VectorXd counted = counted_;
    counted.conservativeResizeLike(Eigen::VectorXd::Zero(ways));
    Eigen::VectorXd weighted = counted;
    if (weights_differ_) {
      weighted.setConstant(singles_[0].sum());
      for (std::size_t i = 1; i < power.size(); ++i) weighted += power[i] * singles_[i];
      weighted *= share_ / one_particle;
      if (some_strayed_)
        weighted.head(stragglers_.rows()) += stragglers_.rowwise().sum() * (emitted2_ / emitted_);
    }
    const Eigen::VectorXd rate = counted / emitted_;
    Eigen::MatrixXd covariance = together - weighted * rate.transpose() - rate * weighted.transpose() +
                                 emitted2_ * rate * rate.transpose();
    covariance.diagonal() = covariance.diagonal().cwiseMax(0);
    return covariance;
  }

  /// The same of one way with itself: sums in one order, whatever other ways there are.
  double variance_of(Eigen::Index way) const {
    const Eigen::VectorXd flips =
        nodes_.flips(*path_of(projection_.ways[static_cast<std::size_t>(way)].stage), tree_.source.key);
    double together = 0, weighted = 0;
    for (Eigen::Index node = 0; node < flips.size(); ++node) {
      double left = 1;  // power of the flip
      for (std::size_t i = 0; i < products_.size(); ++i, left *= flips[node]) {
        weighted += left * singles_[i][node];
        double right = left;
        for (std::size_t j = 0; j < products_.size(); ++j, right *= flips[node])
          together += right * products_[i][j][node];
      }
    }
    together *= share_ * share_ / one_particle;
    weighted *= share_ / one_particle;
    if (some_strayed_) {
      const auto groups = static_cast<double>(stragglers_.cols());
      double strayed = 0, scatter = 0;
      for (Eigen::Index group = 0; group < stragglers_.cols(); ++group) strayed += stragglers_(way, group);
      for (Eigen::Index group = 0; group < stragglers_.cols(); ++group)
        scatter += portable::pow(stragglers_(way, group) - strayed / groups, 2);
      together += scatter * groups / (groups - 1);
      weighted += strayed * (emitted2_ / emitted_);
    }
    if (!weights_differ_) weighted = counted_[way];
    const double rate = counted_[way] / emitted_;
    return std::max(0.0, together - 2 * weighted * rate + emitted2_ * rate * rate);
  }

 private:
  void add_stragglers(Eigen::MatrixXd& together) const {
    const Eigen::Index ways = stragglers_.rows();
    const auto groups = static_cast<double>(stragglers_.cols());
    const Eigen::MatrixXd off = stragglers_.colwise() - stragglers_.rowwise().mean();
    together.topLeftCorner(ways, ways) += off * off.transpose() * (groups / (groups - 1));
  }

  const PlanTree& tree_;
  const PlanNode& projection_;
  const TransitNodes& nodes_;
  const std::vector<std::vector<Eigen::VectorXd>> products_;
  const std::vector<Eigen::VectorXd> singles_;
  const double share_;
  const Eigen::VectorXd& counted_;
  const Eigen::MatrixXd& stragglers_;
  const bool some_strayed_, weights_differ_;
  const double emitted_, emitted2_;  // [particles], [particles^2]
};

}  // namespace

ScreenCovariance covariance_of(const PlanTree& tree, const PlanNode& projection, const TransitNodes& nodes,
                               const TransitNodes::WholeScreen& screen, double share, int part,
                               const Eigen::VectorXd& counted, const Eigen::MatrixXd& stragglers,
                               const Sums& sums, int threads) {
  const CovarianceMaker maker(tree, projection, nodes, screen, share, counted, stragglers, sums);
  ScreenCovariance out{part};
  for (std::size_t way = 0; way < projection.ways.size(); ++way)
    for (const int point : projection.ways[way].points) {
      out.way_of.resize(std::max(out.way_of.size(), static_cast<std::size_t>(point) + 1));
      out.way_of[static_cast<std::size_t>(point)] = static_cast<Eigen::Index>(way);
    }
  if (out.way_of.size() <= most_points_of_covariance) {
    out.between_ways = maker.between_all();
    out.of_ways = out.between_ways.diagonal();
    return out;
  }
  out.of_ways.resize(counted.size());
  in_parallel(projection.ways.size(), threads, [&](std::size_t way) {
    const auto at = static_cast<Eigen::Index>(way);
    out.of_ways[at] = maker.variance_of(at);
  });
  return out;
}

}  // namespace rabiline
