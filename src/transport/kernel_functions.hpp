#pragma once
// The kernels of one instruction set; Kernels in transport/kernels.hpp says what each does.
#include "core/lanes.hpp"
#include "transport/kernels.hpp"

namespace rabiline::RABILINE_ISA {

void emit(const Emission&, std::uint64_t first_particle, BatchView&);
void drift(double y, BatchView&);
std::uint64_t pass(const Aperture&, BatchView&);
std::uint64_t screen(const Screen&, BatchView&);
void align(const Alignment&, const RandomKey&, BatchView&);
void precess(const SpinZone*, int zone_count, const RandomKey&, BatchView&);
std::uint64_t filter(const Filter&, BatchView&);
void project(const Projection&, const BatchView&, LevelSums&);
void turn(const Region&, BatchView&, const StepRecorder*);

}  // namespace rabiline::RABILINE_ISA
