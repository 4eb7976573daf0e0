#pragma once
#include <vector>

namespace rabiline::bench {

/// A spin 1/2 in w0 along z and w1 cos(omega t) along x [rad/s], omega > 0, by the two solutions of Floquet's
/// form exp(-+ i half_rate t) (u, d)(omega t): u and d of the first, then of the second, at equally many
/// angles of a period, real and imaginary part, each followed by how much more it is at the next angle.
struct PeriodTable {
  static constexpr int phases = 4096, columns = 16;
  double omega = 0, half_rate = 0;
  std::vector<double> rows{};  // [angle][u_1, u_2, d_1, d_2; re, im; value, slope]
  PeriodTable(double w0, double w1, double omega);
};

}  // namespace rabiline::bench
