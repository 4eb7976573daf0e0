#pragma once
// Transitions between the levels of a spin I in any field that acts on it like a rotation.
#include <vector>

namespace rabiline {

/// P(m -> m') of a spin I as polynomials in the flip probability p of a spin 1/2 under the same rotation.
///
/// Majorana (1932): a rotation by the polar angle beta takes m to m' with |d^I_{m'm}(beta)|^2, and
/// p = sin^2(beta/2). Wigner's sum gives d = sum_k c_k cos(beta/2)^(2I-2k+m-m') sin(beta/2)^(2k-m+m'), so its
/// square is a polynomial of degree 2I in p.
struct MajoranaTable {
  int twice_spin = 1;
  std::vector<double> coefficients;  // [from][to][power of p], levels m = I, I-1, ... -I

  int levels() const { return twice_spin + 1; }
};

MajoranaTable majorana_table(int twice_spin);

}  // namespace rabiline
