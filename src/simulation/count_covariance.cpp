#include "simulation/count_covariance.hpp"

#include <algorithm>

#include "core/in_parallel.hpp"
#include "simulation/counting.hpp"

namespace rabiline {
namespace {

constexpr double one_particle = static_cast<double>(quanta_per_particle);  // [quanta]

/// A share P(from -> to) is a sum of functions of the slowness that are fewer than the shares, the first of
/// them 1: powers of the flip probability p of a spin 1/2 (MajoranaTable). Where filters share the weights
/// too they are the shares of the `outcomes` that can come to a place.
std::size_t terms_of(const SpinPath& path, std::size_t outcomes) {
  const auto levels = static_cast<std::size_t>(path.levels);
  return path.filters.empty() ? levels : 1 + levels * outcomes;
}
double coefficient(const SpinPath& path, std::size_t outcomes, std::size_t from, int to, std::size_t term) {
  const std::size_t share = from * outcomes + static_cast<std::size_t>(to);
  if (!path.filters.empty()) return term == 1 + share ? 1 : 0;
  if (path.levels == 2) {
    const bool stays = static_cast<int>(from) == to;
    return term == 0 ? (stays ? 1 : 0) : (stays ? -1 : 1);
  }
  return path.polynomials[share * static_cast<std::size_t>(path.levels) + term];
}
/// Each over the nodes, and of powers as many as products of two of them have.
std::vector<Eigen::VectorXd> terms_at(const TransitNodes& nodes, const SpinPath& path, std::size_t outcomes,
                                      const RandomKey& key) {
  std::vector<Eigen::VectorXd> terms{Eigen::VectorXd::Ones(nodes.size())};
  if (path.filters.empty()) {
    terms.push_back(nodes.flips(path, key));
    while (terms.size() + 1 < 2 * terms_of(path, outcomes))
      terms.push_back(terms.back().cwiseProduct(terms[1]));
    return terms;
  }
  for (std::size_t from = 0; from < static_cast<std::size_t>(path.levels); ++from) {
    const Eigen::MatrixXd shares = nodes.shares(path, key, from);
    for (std::size_t to = 0; to < outcomes; ++to)
      terms.emplace_back(shares.col(static_cast<Eigen::Index>(to)));
  }
  return terms;
}

/// Products of terms in what a link has of pairs of paths: [i][j], each over the nodes.
std::vector<std::vector<Eigen::VectorXd>> products_of_terms(const SpinPath& path, const TransitLayout& layout,
                                                            std::size_t link,
                                                            const TransitNodes::WholeLink& whole) {
  const std::size_t outcomes = layout.link(link).outcomes, terms = terms_of(path, outcomes);
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(whole.paths.front().front().size());
  std::vector<std::vector<Eigen::VectorXd>> of(terms, std::vector<Eigen::VectorXd>(terms, none));
  for (std::size_t from = 0; from < layout.levels(); ++from)
    for (std::size_t a = 0; a < layout.paths(link, from); ++a)
      for (std::size_t b = 0; b < layout.paths(link, from); ++b) {
        const Eigen::VectorXd& pair = whole.pairs[from][a][b];
        for (std::size_t i = 0; i < terms; ++i)
          for (std::size_t j = 0; j < terms; ++j)
            of[i][j] += pair * (coefficient(path, outcomes, from, layout.outcomes(from)[a], i) *
                                coefficient(path, outcomes, from, layout.outcomes(from)[b], j));
      }
  return of;
}

/// Sum of w^2 P, by its terms.
std::vector<Eigen::VectorXd> terms_in_counts(const SpinPath& path, const TransitLayout& layout,
                                             std::size_t link, const TransitNodes::WholeLink& whole) {
  const std::size_t outcomes = layout.link(link).outcomes;
  const Eigen::VectorXd none = Eigen::VectorXd::Zero(whole.paths.front().front().size());
  std::vector<Eigen::VectorXd> of(terms_of(path, outcomes), none);
  for (std::size_t from = 0; from < layout.levels(); ++from)
    for (std::size_t a = 0; a < layout.paths(link, from); ++a)
      for (std::size_t i = 0; i < of.size(); ++i)
        of[i] += whole.pairs[from][a][a] * coefficient(path, outcomes, from, layout.outcomes(from)[a], i);
  return of;
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
                  std::size_t link, const TransitNodes::WholeLink& whole, const Eigen::VectorXd& counted,
                  const Eigen::MatrixXd& stragglers, const Sums& sums)
      : tree_(tree),
        projection_(projection),
        nodes_(nodes),
        outcomes_(projection.transit->link(link).outcomes),
        products_(products_of_terms(*path_of(projection.stage), *projection.transit, link, whole)),
        singles_(terms_in_counts(*path_of(projection.stage), *projection.transit, link, whole)),
        share_(projection.transit->link(link).counted),
        counted_(counted),
        stragglers_(stragglers),
        some_strayed_(!stragglers.isZero(0)),
        weights_differ_(sums_of(tree.source).weights_differ),
        emitted_(static_cast<double>(sums[tree.sums + EmissionSums::q()]) / one_particle),
        emitted2_(static_cast<double>(sums[tree.sums + EmissionSums::q2()]) / one_particle / one_particle) {}

  /// Of all reweightings, which are filled up to eights.
  Eigen::MatrixXd between_all() const {
    const auto all = static_cast<Eigen::Index>(projection_.reweightings.size()),
               reweightings = (all + 7) / 8 * 8;
    std::vector<Eigen::MatrixXd> term(products_.size(), Eigen::MatrixXd::Zero(reweightings, nodes_.size()));
    for (Eigen::Index one = 0; one < all; ++one) {
      const std::vector<Eigen::VectorXd> terms_of_one = terms_of(one);
      for (std::size_t i = 1; i < term.size(); ++i) term[i].row(one) = terms_of_one[i];
    }

    Eigen::MatrixXd together = Eigen::MatrixXd::Constant(reweightings, reweightings, products_[0][0].sum());
    for (std::size_t i = 1; i < term.size(); ++i) {
      const Eigen::VectorXd with_one = term[i] * products_[i][0];
      together.colwise() += with_one;
      together.rowwise() += with_one.transpose();
      Eigen::MatrixXd others = Eigen::MatrixXd::Zero(reweightings, nodes_.size());
      for (std::size_t j = 1; j < term.size(); ++j) others += term[j] * products_[i][j].asDiagonal();
      kernel::add_products(best_isa())(term[i].data(), others.data(), reweightings, nodes_.size(),
                                       together.data());
    }
    together.triangularView<Eigen::StrictlyUpper>() = together.transpose();
    together *= share_ * share_ / one_particle;
    if (some_strayed_) add_stragglers(together);

    Eigen::VectorXd counted = counted_;
    counted.conservativeResizeLike(Eigen::VectorXd::Zero(reweightings));
    Eigen::VectorXd weighted = counted;
    if (weights_differ_) {
      weighted.setConstant(singles_[0].sum());
      for (std::size_t i = 1; i < term.size(); ++i) weighted += term[i] * singles_[i];
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

  /// The same of one reweighting with itself: sums in one order, whatever others there are.
  double variance_of(Eigen::Index one) const {
    const std::vector<Eigen::VectorXd> term = terms_of(one);
    const bool are_powers = path_of(projection_.stage)->filters.empty();
    double together = 0, weighted = 0;
    for (Eigen::Index node = 0; node < nodes_.size(); ++node)
      for (std::size_t i = 0; i < products_.size(); ++i) {
        weighted += term[i][node] * singles_[i][node];
        for (std::size_t j = 0; j < products_.size(); ++j)
          together +=
              (are_powers ? term[i + j][node] : term[i][node] * term[j][node]) * products_[i][j][node];
      }
    together *= share_ * share_ / one_particle;
    weighted *= share_ / one_particle;
    if (some_strayed_) {
      const auto groups = static_cast<double>(stragglers_.cols());
      double strayed = 0, scatter = 0;
      for (Eigen::Index group = 0; group < stragglers_.cols(); ++group) strayed += stragglers_(one, group);
      for (Eigen::Index group = 0; group < stragglers_.cols(); ++group)
        scatter += portable::pow(stragglers_(one, group) - strayed / groups, 2);
      together += scatter * groups / (groups - 1);
      weighted += strayed * (emitted2_ / emitted_);
    }
    if (!weights_differ_) weighted = counted_[one];
    const double rate = counted_[one] / emitted_;
    return std::max(0.0, together - 2 * weighted * rate + emitted2_ * rate * rate);
  }

 private:
  std::vector<Eigen::VectorXd> terms_of(Eigen::Index one) const {
    return terms_at(nodes_, *path_of(projection_.reweightings[static_cast<std::size_t>(one)].stage),
                    outcomes_, tree_.source.key);
  }
  void add_stragglers(Eigen::MatrixXd& together) const {
    const Eigen::Index reweightings = stragglers_.rows();
    const auto groups = static_cast<double>(stragglers_.cols());
    const Eigen::MatrixXd off = stragglers_.colwise() - stragglers_.rowwise().mean();
    together.topLeftCorner(reweightings, reweightings) += off * off.transpose() * (groups / (groups - 1));
  }

  const PlanTree& tree_;
  const PlanNode& projection_;
  const TransitNodes& nodes_;
  const std::size_t outcomes_;
  const std::vector<std::vector<Eigen::VectorXd>> products_;
  const std::vector<Eigen::VectorXd> singles_;
  const double share_;
  const Eigen::VectorXd& counted_;
  const Eigen::MatrixXd& stragglers_;
  const bool some_strayed_, weights_differ_;
  const double emitted_, emitted2_;  // [particles], [particles^2]
};

}  // namespace

CountCovariance covariance_of(const PlanTree& tree, const PlanNode& projection, const TransitNodes& nodes,
                              std::size_t link, const TransitNodes::WholeLink& whole,
                              const Eigen::VectorXd& counted, const Eigen::MatrixXd& stragglers,
                              const Sums& sums, int threads) {
  const CovarianceMaker maker(tree, projection, nodes, link, whole, counted, stragglers, sums);
  CountCovariance out{projection.transit->link(link).part, projection.transit->link(link).plane};
  for (std::size_t one = 0; one < projection.reweightings.size(); ++one)
    for (const int point : projection.reweightings[one].points) {
      out.reweighting_of.resize(std::max(out.reweighting_of.size(), static_cast<std::size_t>(point) + 1));
      out.reweighting_of[static_cast<std::size_t>(point)] = static_cast<Eigen::Index>(one);
    }
  if (out.reweighting_of.size() <= most_points_of_covariance) {
    out.between_reweightings = maker.between_all();
    out.of_reweightings = out.between_reweightings.diagonal();
    return out;
  }
  out.of_reweightings.resize(counted.size());
  in_parallel(projection.reweightings.size(), threads, [&](std::size_t one) {
    const auto at = static_cast<Eigen::Index>(one);
    out.of_reweightings[at] = maker.variance_of(at);
  });
  return out;
}

}  // namespace rabiline
