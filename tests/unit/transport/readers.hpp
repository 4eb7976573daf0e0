#pragma once
// Tables as the kernels read them: what a test asks here is what flies.
#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "core/isa.hpp"
#include "spin/majorana.hpp"
#include "spin/moment_table.hpp"
#include "transport/spin_path.hpp"
#include "transport/stages/steering.hpp"

namespace rabiline::test {

/// Those that this machine has.
inline std::vector<Isa> instruction_sets() {
  std::vector<Isa> sets;
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (supported(isa)) sets.push_back(isa);
  return sets;
}

/// One particle in each level, at rest in the beam's middle but for its speed along it [m/s].
inline void fill_levels(Batch& batch, int levels, double speed) {
  BatchView& v = batch.view();
  v.count = levels;
  v.padded = (levels + 7) / 8 * 8;
  std::fill_n(v.vy, v.padded, speed);
  std::fill_n(v.slowness, v.padded, 1 / speed);
  std::fill_n(v.sz, v.padded, 1.0);
  for (int i = 0; i < levels; ++i) {
    v.level[i] = static_cast<std::uint64_t>(i);
    v.weight[i] = quanta_per_particle;
    v.particle[i] = static_cast<std::uint64_t>(i);
    v.flying[i] = ~std::uint64_t{0};
  }
}

/// In row `from`, the shares of a particle's 2^40 quanta that kernels put into each level.
inline Eigen::MatrixXd shared_out(const SpinPath& path, const BatchView& v, Isa isa) {
  alignas(64) std::uint64_t shares[most_levels * (most_levels + 7)];
  kernel::outcomes(isa)(path.view({}), v, v.weight, shares);
  Eigen::MatrixXd p(path.levels, path.levels);
  for (int from = 0; from < path.levels; ++from)
    for (int to = 0; to < path.levels; ++to)
      p(from, to) =
          static_cast<double>(shares[to * v.padded + from]) / static_cast<double>(quanta_per_particle);
  return p;
}
/// P(from -> to) in row `from`, to 1e-11.
inline Eigen::MatrixXd probabilities(const DrivenLevels& driven, double slowness, Isa isa = best_isa()) {
  Batch batch;
  fill_levels(batch, driven.levels(), 1 / slowness);
  return shared_out({.levels = driven.levels(), .of_atom = true, .transitions = &driven}, batch.view(), isa);
}

/// A spin whose image of z flips with that probability: P(m -> m') as weights are shared out by it ...
inline Eigen::MatrixXd shares(const MajoranaTable& table, double flip, Isa isa = best_isa()) {
  Batch batch;
  fill_levels(batch, table.levels(), 1000);
  std::fill_n(batch.view().sz, batch.view().padded, 1 - 2 * flip);
  return shared_out({.levels = table.levels(), .polynomials = table.coefficients}, batch.view(), isa);
}
/// ... and as tallies measure it.
inline Eigen::MatrixXd probabilities(const MajoranaTable& table, double flip, Isa isa = best_isa()) {
  const int levels = table.levels();
  Batch batch;
  fill_levels(batch, levels, 1000);
  const BatchView& v = batch.view();
  std::fill_n(v.sz, v.padded, 1 - 2 * flip);
  const SpinPath path{.levels = levels, .polynomials = table.coefficients};
  alignas(64) double columns[most_levels * (most_levels + 7)];
  kernel::measure_spin(isa)({path.view({}), Quantity::spin, {0, 0, 1}}, v, v.weight, columns);
  return Eigen::Map<const Eigen::MatrixXd>(columns, v.padded, levels).topRows(levels);
}

/// [J/T] of every level: one second in 1 T/m gives a mass of 1 kg the moment as its speed, in m/s, and takes
/// it nowhere.
inline Eigen::VectorXd moments(const MomentTable& table, double field, Isa isa = best_isa()) {
  Steering magnet;
  magnet.end = 1;
  magnet.shape.field = field;
  magnet.shape.gradient = 1;
  magnet.levels = table.levels();
  magnet.moment = table.largest();
  magnet.moments = {table.coefficients().data(), table.cells(), table.scale()};
  Batch batch;
  fill_levels(batch, table.levels(), 1);
  kernel::steer(isa)(magnet, batch.view());
  return Eigen::Map<const Eigen::VectorXd>(batch.view().vz, table.levels());
}

}  // namespace rabiline::test
