#pragma once
// What a field is multiplied by as time goes on.
#include "field/map_shape.hpp"

namespace rabiline {

/// A cubic B-spline through nodes from t = 0 on; behind the last one it stays what it is there. Between its
/// stops it is nearly one polynomial of third degree: steps that end there miss none of its bends.
struct TimeCourse {
  const double* coefficients = nullptr;  // of the nodes, and one more at each end
  int nodes = 0;                         // four or more; 0: it is always 1
  double per_second = 0;                 // [1/s] one over the time between nodes
  const double* stops = nullptr;         // [s] for each span between nodes: the first stop behind it
  bool operator==(const TimeCourse&) const = default;
};

template <class Number>
struct CourseHere {
  Number share, rate;  // [1/s] its derivative
};

template <class Maths, class Number>
[[gnu::always_inline]] inline CourseHere<Number> course_at(const TimeCourse& course, const Number& t) {
  constexpr int lanes = Maths::lanes;
  const SplineCell<Number> cell = spline_cell<Maths>(t, 0.0, course.per_second, course.nodes);
  alignas(64) double first[lanes], of_node[4][lanes];
  Maths::store(first, cell.first);
  for (int k = 0; k < lanes; ++k)
    for (int i = 0; i < 4; ++i) of_node[i][k] = course.coefficients[static_cast<long>(first[k]) + i];
  Number node[4];
  for (int i = 0; i < 4; ++i) node[i] = Maths::load(of_node[i]);
  const auto sum = [&](const Number(&weight)[4]) {
    return weight[0] * node[0] + weight[1] * node[1] + weight[2] * node[2] + weight[3] * node[3];
  };
  return {sum(cell.weight), sum(cell.slope)};
}

/// The nearest stop after t, at most `latest`.
template <class Maths, class Number>
[[gnu::always_inline]] inline Number next_stop(const TimeCourse& course, const Number& t, Number latest) {
  constexpr int lanes = Maths::lanes;
  const Number first = spline_cell<Maths>(t, 0.0, course.per_second, course.nodes).first;
  constexpr double before = -1e-12;  // [s] from emission ahead of t = 0, where a course begins
  latest = Maths::select((t < before) & (latest > 0.0), t - t, latest);
  alignas(64) double cell[lanes], stop[2][lanes];
  Maths::store(cell, first);
  // Where rounding has t in the span before its own, the next one's counts.
  for (int k = 0; k < lanes; ++k)
    for (int i = 0; i < 2; ++i) {
      const long span = static_cast<long>(cell[k]) + i;
      stop[i][k] = course.stops[span < course.nodes - 1 ? span : course.nodes - 2];
    }
  for (const double* of_span : {stop[1], stop[0]}) {
    const Number at = Maths::load(of_span);
    latest = Maths::select(at > t, Maths::select(at < latest, at, latest), latest);
  }
  return latest;
}

}  // namespace rabiline
