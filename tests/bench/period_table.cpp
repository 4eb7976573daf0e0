#include "bench/period_table.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace rabiline::bench {
namespace {

using Complex = std::complex<double>;
struct Turn {  // {{a, -conj(b)}, {b, conj(a)}}
  Complex a{1}, b{};
};
Turn operator*(const Turn& after, const Turn& before) {
  return {after.a * before.a - std::conj(after.b) * before.b,
          after.b * before.a + std::conj(after.a) * before.b};
}
/// Right-handed about (x, y, z) by its length.
Turn turn_by(double x, double y, double z) {
  const double angle = std::sqrt(x * x + y * y + z * z), c = std::cos(angle / 2),
               s = angle > 0 ? std::sin(angle / 2) / angle : 0.5;
  return {{c, -s * z}, {s * y, -s * x}};
}

}  // namespace

PeriodTable::PeriodTable(double w0, double w1, double rate) : omega(rate) {
  const double h = 2 * std::numbers::pi / omega / phases, gauss = std::sqrt(3.0) / 6;
  std::array<Turn, phases + 1> until;
  for (std::size_t j = 0; j < phases; ++j) {
    const auto across = [&](double part) {
      return w1 * std::cos(omega * h * (static_cast<double>(j) + part));
    };
    const double a = across(0.5 - gauss), b = across(0.5 + gauss);
    until[j + 1] = turn_by(0.5 * h * (a + b), gauss / 2 * h * h * w0 * (a - b), h * w0) * until[j];
  }
  // The whole period turns by `angle` about an axis: its eigenvectors, of exp(-i angle/2) and exp(i angle/2).
  const Turn& whole = until[phases];
  const double angle = 2 * std::acos(whole.a.real()), s = -std::sin(angle / 2), nz = whole.a.imag() / s,
               nx = whole.b.imag() / s, ny = -whole.b.real() / s;
  const double half = std::acos(nz) / 2, azimuth = std::atan2(ny, nx);
  const Turn eigen{std::cos(half), std::polar(std::sin(half), azimuth)};
  half_rate = angle / 2 / (h * phases);
  std::array<std::array<double, 8>, phases + 1> nodes;
  for (std::size_t j = 0; j <= phases; ++j) {
    const Turn mode = until[j] * eigen;
    const Complex back = std::polar(1.0, half_rate * h * static_cast<double>(j)), up_1 = mode.a * back,
                  down_1 = mode.b * back, up_2 = -std::conj(mode.b) * std::conj(back),
                  down_2 = std::conj(mode.a) * std::conj(back);
    nodes[j] = {up_1.real(),   up_1.imag(),   up_2.real(),   up_2.imag(),
                down_1.real(), down_1.imag(), down_2.real(), down_2.imag()};
  }
  for (std::size_t j = 0; j < phases; ++j)
    for (std::size_t k = 0; k < 8; ++k) {
      rows.push_back(nodes[j][k]);
      rows.push_back(nodes[j + 1][k] - nodes[j][k]);
    }
}

}  // namespace rabiline::bench
