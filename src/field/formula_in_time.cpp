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
    look_everywhere();
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

  /// Some over all of the time, and those at which three places have their largest and smallest values.
  std::vector<double> times_to_see() {
    constexpr int even = 32;
    std::vector<double> out;
    for (int i = 0; i <= even; ++i)
      out.push_back(duration_ / 2 * (1 - portable::cos(std::numbers::pi * i / even)));
    for (const Eigen::Index node : {Eigen::Index{0}, size_ / 6, size_ / 3 - 1})
      for (Eigen::Index row = 3 * node; row < 3 * node + 3; ++row) {
        if (!formulas_[row % 3].moves()) continue;
        std::vector<double> seen;
        for (int i = 0; i <= scouted; ++i) seen.push_back(value(row, duration_ * i / scouted));
        const auto [least, most] = std::ranges::minmax_element(seen);
        for (const auto& extreme : {least, most})
          out.push_back(duration_ * static_cast<double>(extreme - seen.begin()) / scouted);
      }
    std::ranges::sort(out);
    out.erase(std::unique(out.begin(), out.end()), out.end());
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
      add(left.col(column));
      left -= (fields_.back() * left.row(row)).eval();
    }
  }
  /// One more field, which is 1 where it is largest.
  void add(const Eigen::VectorXd& field) {
    if (pivots_.size() == most_field_courses) throw too_many();
    Eigen::Index row = 0;
    field.cwiseAbs().maxCoeff(&row);
    pivots_.push_back(row);
    fields_.push_back(field / field[row]);
  }
  /// What acts for a short time at few places may have been missed: many places are looked at at many times,
  /// and the field of a time at which one of them has more than the sum so far is added to it.
  void look_everywhere() {
    constexpr int moments = 1 << 11;
    const auto time = [&](int i) { return duration_ * i / moments; };
    std::vector<std::vector<double>> share(moments + 1);  // of each field so far
    const auto know_shares = [&] {
      for (int i = 0; i <= moments; ++i) share[i] = shares(time(i));
    };
    know_shares();
    for (const Eigen::Index row : rows_to_look_at()) {
      std::vector<double> seen;
      for (int i = 0; i <= moments; ++i) seen.push_back(value(row, time(i)));
      for (;;) {
        double most = 0;
        int when = 0;
        for (int i = 0; i <= moments; ++i) {
          double left = seen[i];
          for (std::size_t k = 0; k < share[i].size(); ++k) left -= share[i][k] * fields_[k][row];
          if (std::abs(left) > most) most = std::abs(left), when = i;
        }
        if (!(most > told * largest_)) break;
        largest_ = std::max(largest_, whole_field(time(when)).cwiseAbs().maxCoeff());
        add(left_at(time(when)));
        know_shares();
      }
    }
  }
  /// Of the components that have t: along the axis of the box, and fewer half-way to its sides.
  std::vector<Eigen::Index> rows_to_look_at() const {
    constexpr int most_on_axis = 64, most_beside = 8;
    std::vector<Eigen::Index> out;
    const auto look_along = [&](int x, int z, int most) {
      const int nodes = axes_[1].nodes, count = std::min(most, nodes);
      for (int i = 0; i < count; ++i) {
        const Eigen::Index y = count == nodes ? i : static_cast<Eigen::Index>(i) * (nodes - 1) / (count - 1);
        for (Eigen::Index component = 0; component < 3; ++component)
          if (formulas_[static_cast<std::size_t>(component)].moves())
            out.push_back(3 * ((Eigen::Index{x} * axes_[1].nodes + y) * axes_[2].nodes + z) + component);
      }
    };
    look_along(axes_[0].nodes / 2, axes_[2].nodes / 2, most_on_axis);
    for (const int x : {axes_[0].nodes / 4, axes_[0].nodes - 1 - axes_[0].nodes / 4})
      for (const int z : {axes_[2].nodes / 4, axes_[2].nodes - 1 - axes_[2].nodes / 4})
        look_along(x, z, most_beside);
    return out;
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
  /// Of the field at a time, what the sum so far does not have.
  Eigen::VectorXd left_at(double t) {
    Eigen::VectorXd left = whole_field(t);
    const std::vector<double> share = shares(t);
    for (std::size_t k = 0; k < share.size(); ++k) left -= share[k] * fields_[k];
    return left;
  }
  void hold_against_other_times() {
    for (const double part : {0.0137, 0.1731, 0.3937, 0.6183, 0.7719, 0.9281})
      if (!(left_at(part * duration_).cwiseAbs().maxCoeff() <= told * largest_)) throw too_many();
  }
  static FormulaFault too_many() {
    return fault_in_time("the formulas are no sum of up to eight fields with a course in time each",
                         "waves that travel repeat: state `frequency` instead of `duration`");
  }

  using Courses = std::vector<std::vector<double>>;  // of each field
  Courses courses(int cells) {
    Courses out(pivots_.size());
    for (int i = 0; i <= cells; ++i) {
      const std::vector<double> share = shares(duration_ * i / cells);
      for (std::size_t k = 0; k < share.size(); ++k) out[k].push_back(share[k]);
    }
    return out;
  }
  /// As many nodes as it takes, in powers of two.
  std::vector<FieldOfCourse> with_courses() {
    for (int finest = scouted; finest <= most_cells; finest *= 2) {
      const Courses known = courses(finest);
      for (int cells = finest == scouted ? fewest_cells : finest / 2; cells <= finest / 2; cells *= 2)
        if (auto out = fitted(known, static_cast<std::size_t>(finest / cells))) return std::move(*out);
    }
    throw fault_in_time(
        "the formulas jump in t, or change too often for their `duration`",
        "make a jump a steep slope, as `min(max((t - t0)/tau, 0), 1)` is, or `duration` shorter");
  }
  /// Splines through every so many of the values; nothing where they miss the others.
  std::optional<std::vector<FieldOfCourse>> fitted(const Courses& known, std::size_t every) const {
    std::vector<FieldOfCourse> out;
    for (std::size_t k = 0; k < known.size(); ++k) {
      std::vector<double> values;
      for (std::size_t i = 0; i < known[k].size(); i += every) values.push_back(known[k][i]);
      double largest = 0, missed = 0;
      for (const double value : known[k]) largest = std::max(largest, std::abs(value));
      std::vector<double> course = spline_coefficients(values);
      const TimeCourse spline{course.data(), static_cast<int>(values.size()),
                              1.0 / static_cast<double>(every)};
      for (std::size_t i = 0; i < known[k].size(); ++i)
        missed += std::abs(course_at<HostMaths>(spline, static_cast<double>(i)).share - known[k][i]);
      if (missed > missed_on_average * static_cast<double>(known[k].size()) * largest) return std::nullopt;
      for (double& coefficient : course) coefficient /= largest;
      const Eigen::VectorXd field = largest * fields_[k];
      out.push_back({{{axes_.begin(), axes_.end()}, {field.begin(), field.end()}},
                     std::move(course),
                     stops_of(values, bent * largest)});
    }
    return out;
  }
  /// Whether the cubic through four of the values from one to another misses none in between by more.
  static bool is_cubic(const std::vector<double>& values, std::size_t first, std::size_t last, double miss) {
    const std::size_t length = last - first;
    if (length < 4) return true;
    const std::size_t at[4] = {0, length / 3, length - length / 3, length};
    for (std::size_t i = 0; i <= length; ++i) {
      double sum = 0;
      for (const std::size_t a : at) {
        double weight = 1;
        for (const std::size_t b : at)
          if (b != a)
            weight *= (static_cast<double>(i) - static_cast<double>(b)) /
                      (static_cast<double>(a) - static_cast<double>(b));
        sum += weight * values[first + a];
      }
      if (!(std::abs(sum - values[first + i]) <= miss)) return false;
    }
    return true;
  }
  /// As far apart as the values are cubic in between.
  std::vector<double> stops_of(const std::vector<double>& values, double miss) const {
    const std::size_t cells = values.size() - 1;
    std::vector<double> out;
    while (out.size() < cells) {
      const std::size_t first = out.size();
      std::size_t good = first + 1, bad = cells + 1;
      for (std::size_t length = 2; bad - good > 1;) {
        const std::size_t tried = std::min(bad == cells + 1 ? first + length : (good + bad) / 2, cells);
        (is_cubic(values, first, tried, miss) ? good : bad) = tried;
        if (good == cells) break;
        length *= 2;
      }
      out.resize(good, duration_ * static_cast<double>(good) / static_cast<double>(cells));
    }
    return out;
  }

  static constexpr double interpolated = 1e-9, told = 1e-6, missed_on_average = 1e-8, bent = 1e-4;
  static constexpr int fewest_cells = 64, scouted = 1 << 15, most_cells = 1 << 18;
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
