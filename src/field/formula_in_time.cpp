// Fields B(r, t) as sums of B_k(r) f_k(t): the empirical interpolation of M. Barrault, Y. Maday, N. Nguyen
// and A. Patera, C. R. Acad. Sci. Paris, Ser. I 339, 667 (2004), with the time in place of the parameter.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "core/portable_math.hpp"
#include "field/formula_parser.hpp"
#include "field/host_maths.hpp"
#include "field/time_course.hpp"

namespace rabiline {
namespace {

FormulaFault fault_in_time(const char* message, std::string help) {
  FormulaFault out(message, std::move(help));
  out.component = 3;
  return out;
}

class InTime {
 public:
  InTime(const FieldFormula& formula, const std::array<MapAxis, 3>& axes)
      : axes_(axes), duration_(formula.duration), formulas_{{{formula, 0}, {formula, 1}, {formula, 2}}} {
    for (const MapAxis& axis : axes) size_ *= axis.nodes;
  }

  std::vector<FieldOfCourse> result() {
    if (std::ranges::none_of(formulas_, &FormulaComponent::moves))
      throw fault_in_time("no component has t: the field stands",
                          "omit `duration`, or write `t` [s] where it acts");
    interpolate();
    hold_against_other_times();
    return with_courses();
  }

 private:
  /// A row is a component at a node.
  double value(Eigen::Index row, double t) {
    const auto node = static_cast<std::size_t>(row / 3), y = static_cast<std::size_t>(axes_[1].nodes),
               z = static_cast<std::size_t>(axes_[2].nodes);
    return formulas_[row % 3].at(place_of(axes_, node / (y * z), node / z % y, node % z), t);
  }
  Eigen::VectorXd whole_field(double t) {
    Eigen::VectorXd out(size_);
    for (Eigen::Index row = 0; row < size_; ++row) out[row] = value(row, t);
    return out;
  }

  /// Some over all of the time, and those at which a few places have their largest and smallest values.
  std::vector<double> times_to_see() {
    constexpr int even = 32, scouting = 1024;
    std::vector<double> out;
    for (int i = 0; i <= even; ++i)
      out.push_back(duration_ / 2 * (1 - portable::cos(std::numbers::pi * i / even)));
    const auto third_of = [&](std::size_t a, int i) { return (axes_[a].nodes - 1) * i / 2; };
    for (int place = 0; place < 27; ++place) {
      const Eigen::Index node =
          (static_cast<Eigen::Index>(third_of(0, place / 9)) * axes_[1].nodes + third_of(1, place / 3 % 3)) *
              axes_[2].nodes +
          third_of(2, place % 3);
      for (Eigen::Index row = 3 * node; row < 3 * node + 3; ++row) {
        if (!formulas_[row % 3].moves()) continue;
        std::vector<double> seen;
        for (int i = 0; i <= scouting; ++i) seen.push_back(value(row, duration_ * i / scouting));
        const auto [least, most] = std::ranges::minmax_element(seen);
        for (const auto& extreme : {least, most})
          out.push_back(duration_ * static_cast<double>(extreme - seen.begin()) / scouting);
      }
    }
    std::ranges::sort(out);
    const auto same = std::ranges::unique(out);
    out.erase(same.begin(), same.end());
    return out;
  }

  /// Takes off the field at the time and at the place where most is left of it, until nothing is.
  void interpolate() {
    const std::vector<double> seen = times_to_see();
    Eigen::MatrixXd left(size_, static_cast<Eigen::Index>(seen.size()));
    for (std::size_t i = 0; i < seen.size(); ++i)
      left.col(static_cast<Eigen::Index>(i)) = whole_field(seen[i]);
    largest_ = left.cwiseAbs().maxCoeff();
    Eigen::Index row = 0, column = 0;
    while (left.cwiseAbs().maxCoeff(&row, &column) > interpolated * largest_) {
      if (pivots_.size() == most_field_courses) throw too_many();
      const Eigen::VectorXd field = left.col(column) / left(row, column);
      left -= (field * left.row(row)).eval();
      pivots_.push_back(row);
      fields_.push_back(field);
    }
  }
  /// f_k at a time, from the field at the pivots.
  std::vector<double> shares(double t) {
    std::vector<double> out;
    for (const Eigen::Index row : pivots_) {
      double share = value(row, t);
      for (std::size_t k = 0; k < out.size(); ++k) share -= fields_[k][row] * out[k];
      out.push_back(share);
    }
    return out;
  }
  void hold_against_other_times() {
    for (const double part : {0.0137, 0.1731, 0.3937, 0.6183, 0.7719, 0.9281}) {
      Eigen::VectorXd left = whole_field(part * duration_);
      const std::vector<double> share = shares(part * duration_);
      for (std::size_t k = 0; k < share.size(); ++k) left -= share[k] * fields_[k];
      if (!(left.cwiseAbs().maxCoeff() <= told * largest_)) throw too_many();
    }
  }
  static FormulaFault too_many() {
    return fault_in_time("the formulas are no sum of up to eight fields with a course in time each",
                         "waves that travel repeat: state `frequency` instead of `duration`");
  }

  /// As many nodes as it takes, in powers of two.
  std::vector<FieldOfCourse> with_courses() {
    for (int cells = 64; cells <= most_cells; cells *= 2) {
      std::vector<std::vector<double>> values(pivots_.size()), between(pivots_.size());
      const auto see = [&](std::vector<std::vector<double>>& seen, double cell) {
        const std::vector<double> share = shares(duration_ * cell / cells);
        for (std::size_t k = 0; k < share.size(); ++k) seen[k].push_back(share[k]);
      };
      for (int i = 0; i <= cells; ++i) {
        see(values, i);
        if (i < cells) see(between, i + 0.5);
      }
      if (auto out = fitted(values, between)) return std::move(*out);
    }
    throw fault_in_time(
        "the formulas jump in t, or change too often for their `duration`",
        "make a jump a steep slope, as `min(max((t - t0)/tau, 0), 1)` is, or `duration` shorter");
  }
  /// Nothing where the splines miss what is between their nodes.
  std::optional<std::vector<FieldOfCourse>> fitted(const std::vector<std::vector<double>>& values,
                                                   const std::vector<std::vector<double>>& between) const {
    std::vector<FieldOfCourse> out;
    for (std::size_t k = 0; k < pivots_.size(); ++k) {
      double largest = 0, missed = 0;
      for (const double value : values[k]) largest = std::max(largest, std::abs(value));
      std::vector<double> course = spline_coefficients(values[k]);
      const auto cells = static_cast<int>(between[k].size());
      for (int i = 0; i < cells; ++i)
        missed += std::abs(course_at<HostMaths>({course.data(), cells + 1, 1}, i + 0.5).share -
                           between[k][static_cast<std::size_t>(i)]);
      if (missed > missed_on_average * cells * largest) return std::nullopt;
      for (double& coefficient : course) coefficient /= largest;
      const Eigen::VectorXd field = largest * fields_[k];
      out.push_back({{{axes_.begin(), axes_.end()}, {field.begin(), field.end()}}, std::move(course)});
    }
    return out;
  }

  static constexpr double interpolated = 1e-9, told = 1e-6, missed_on_average = 1e-8;
  static constexpr int most_cells = 1 << 17;
  const std::array<MapAxis, 3>& axes_;
  const double duration_;  // [s]
  std::array<FormulaComponent, 3> formulas_;
  Eigen::Index size_ = 3;
  double largest_ = 0;                   // [T]
  std::vector<Eigen::Index> pivots_;     // rows
  std::vector<Eigen::VectorXd> fields_;  // 1 at their pivot
};

}  // namespace

std::vector<FieldOfCourse> sampled_in_time(const FieldFormula& formula, const std::array<MapAxis, 3>& axes) {
  return InTime(formula, axes).result();
}

}  // namespace rabiline
