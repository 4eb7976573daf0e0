#pragma once
// What a field is multiplied by as time goes on.
#include "field/map_shape.hpp"

namespace rabiline {

/// A cubic B-spline through nodes from t = 0 on; behind the last one it stays what it is there.
struct TimeCourse {
  const double* coefficients = nullptr;  // of the nodes, and one more at each end
  int nodes = 0;                         // four or more; 0: it is always 1
  double per_second = 0;                 // [1/s] one over the time between nodes
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

}  // namespace rabiline
