#pragma once
// The kernels of one instruction set; Kernels in transport/kernels.hpp says what each does.
#include "core/lanes.hpp"
#include "transport/kernels.hpp"

namespace rabiline::RABILINE_ISA {

void emit(const Emission&, std::uint64_t first_particle, BatchView&);
void drift(double y, BatchView&);
std::uint64_t pass(const Aperture&, BatchView&);
Caught screen(const Screen&, BatchView&);
void align(const Alignment&, const RandomKey&, BatchView&);
void precess(const SpinZone*, int zone_count, const RandomKey&, BatchView&);
std::uint64_t filter(const Filter&, BatchView&);
void outcomes(const LevelQuestion&, const BatchView&, const std::uint64_t* weights, std::uint64_t* shares);
void count_shares(const ShareCount&, std::uint64_t* counts, std::uint64_t* totals, LevelSums&);
void collapse(const LevelQuestion&, int part, BatchView&);
std::uint64_t deflect(const Deflection&, BatchView&);
std::uint64_t steer(const Steering&, BatchView&);
void project(const Projection&, const BatchView&, LevelSums&);
void turn(const Region&, BatchView&, const StepRecorder*);
void cross(const Aperture&, const BatchView&, std::uint64_t* weights);
void measure(const Gauge&, const BatchView&, const std::uint64_t* weights, double* values);
void measure_spin(const SpinGauge&, const BatchView&, const std::uint64_t* weights, double* values);

}  // namespace rabiline::RABILINE_ISA
