#include "spin/majorana.hpp"

#include <cmath>

namespace rabiline {
namespace {

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

using Polynomial = std::vector<double>;

Polynomial product(const Polynomial& a, const Polynomial& b) {
  Polynomial c(a.size() + b.size() - 1, 0.0);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (std::size_t j = 0; j < b.size(); ++j) c[i + j] += a[i] * b[j];
  return c;
}

// |d|^2 as a polynomial in p, with s = sin(beta/2), c = cos(beta/2), p = s^2, c^2 = 1 - p. Levels are counted
// from the top: m = I - from, m' = I - to. Wigner's sum runs over k with all factorials defined:
//   d = sqrt((I+m')!(I-m')!(I+m)!(I-m)!) sum_k (-1)^k c^(2I-2k+m-m') s^(2k-m+m') /
//         ((I+m-k)! k! (m'-m+k)! (I-m'-k)!)
// Every term has the same parity of powers, so the smallest ones factor out and the rest is a polynomial in
// p.
Polynomial squared_element(int twice_spin, int from, int to) {
  const int up = twice_spin - from, down = from;    // I+m, I-m
  const int up_to = twice_spin - to, down_to = to;  // I+m', I-m'
  const int shift = from - to;                      // m' - m
  const int k_min = shift < 0 ? -shift : 0;
  const int k_max = up < down_to ? up : down_to;
  const int sine_least = 2 * k_min + shift, cosine_least = twice_spin - 2 * k_max - shift;
  const double norm = std::sqrt(factorial(up) * factorial(down) * factorial(up_to) * factorial(down_to));

  Polynomial sum(1, 0.0);
  for (int k = k_min; k <= k_max; ++k) {
    Polynomial term(1,
                    (k % 2 == 0 ? 1 : -1) * norm /
                        (factorial(up - k) * factorial(k) * factorial(shift + k) * factorial(down_to - k)));
    for (int i = k_min; i < k; ++i) term = product(term, {0, 1});   // s^2
    for (int i = k; i < k_max; ++i) term = product(term, {1, -1});  // c^2
    if (term.size() > sum.size()) sum.resize(term.size(), 0.0);
    for (std::size_t i = 0; i < term.size(); ++i) sum[i] += term[i];
  }
  Polynomial square = product(sum, sum);
  for (int i = 0; i < sine_least; ++i) square = product(square, {0, 1});
  for (int i = 0; i < cosine_least; ++i) square = product(square, {1, -1});
  square.resize(static_cast<std::size_t>(twice_spin) + 1, 0.0);
  return square;
}

}  // namespace

MajoranaTable majorana_table(int twice_spin) {
  MajoranaTable table{twice_spin, {}};
  for (int from = 0; from <= twice_spin; ++from)
    for (int to = 0; to <= twice_spin; ++to) {
      const Polynomial p = squared_element(twice_spin, from, to);
      table.coefficients.insert(table.coefficients.end(), p.begin(), p.end());
    }
  return table;
}

}  // namespace rabiline
