#include "level_step_kernels.hpp"

#include "transport/level_step_lanes.hpp"

namespace rabiline::RABILINE_ISA {
namespace {

void set_hamiltonian(real t, double coupled, LevelMatrix& h) {
  const auto swing = [&](double rate, double phase) {
    real sine, cosine;
    sincos(fma(t, broadcast(rate), broadcast(phase)), sine, cosine);
    return cosine;
  };
  const Swings<real> now = swings(swing, coupled);
  for (int k = 0; k < 3; ++k) h.diagonal[k] = now.energy[k];
  for (int k = 0; k < 2; ++k) {
    h.re[k] = now.re[k];
    h.im[k] = now.im[k];
  }
}

}  // namespace

SteppedLevels step_levels(int steps, double coupled, bool taken_out) {
  constexpr int to[2] = {1, 2}, from[2] = {0, 1};
  LevelManifold f;
  f.levels = 3;
  f.couplings = f.most_of_one = 2;
  f.is_chain = true;
  f.to = to;
  f.from = from;
  Amplitudes a{};
  a.re[0] = broadcast(1);
  const double h = 3.0 / steps;
  SteppedLevels out{};
  for (int i = 0; i < steps; ++i) {
    LevelMatrix at[5];
    for (int k = 0; k < 5; ++k)
      set_hamiltonian(broadcast(h * (i + 0.5 + 0.5 * lobatto_point[k])), coupled, at[k]);
    real error;
    step_through(f, broadcast(h), taken_out, at, a, error);
    out.error += lane(error, 0);
  }
  for (int k = 0; k < 3; ++k) {
    out.re[k] = lane(a.re[k], 0);
    out.im[k] = lane(a.im[k], 0);
  }
  return out;
}

}  // namespace rabiline::RABILINE_ISA
