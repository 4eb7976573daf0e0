#pragma once
// Stages of every kind, and a batch for each.
#include <cstdint>
#include <string>
#include <variant>
#include <vector>

#include "transport/stage.hpp"

namespace rabiline::test {

/// Where the batch of a sample stands [m]: stages begin there.
inline constexpr double start = 0.1;

struct StageSample {
  std::string what;
  Stage stage;
  int levels = 0;  // that the batch's particles are in; 0: their spins are vectors
};

/// Every kind of the list in transport/stage.hpp has samples, in stage_samples.cpp: one without any fails the
/// build here.
template <StageKind Kind>
std::vector<StageSample> samples_of() = delete;
template <>
std::vector<StageSample> samples_of<Drift>();
template <>
std::vector<StageSample> samples_of<Passage>();
template <>
std::vector<StageSample> samples_of<Alignment>();
template <>
std::vector<StageSample> samples_of<Precession>();
template <>
std::vector<StageSample> samples_of<Filter>();
template <>
std::vector<StageSample> samples_of<FilterStop>();
template <>
std::vector<StageSample> samples_of<LevelProjection>();
template <>
std::vector<StageSample> samples_of<Deflection>();
template <>
std::vector<StageSample> samples_of<Steering>();
template <>
std::vector<StageSample> samples_of<TurningRegion>();
template <>
std::vector<StageSample> samples_of<Score>();
template <>
std::vector<StageSample> samples_of<Exit>();
template <>
std::vector<StageSample> samples_of<SpinStretch>();
template <>
std::vector<StageSample> samples_of<Census>();
template <>
std::vector<StageSample> samples_of<Histogram>();
template <>
std::vector<StageSample> samples_of<Attenuation>();
template <>
std::vector<StageSample> samples_of<WallStop>();
template <>
std::vector<StageSample> samples_of<Chopping>();
template <>
std::vector<StageSample> samples_of<VelocitySelection>();
template <>
std::vector<StageSample> samples_of<SortingField>();
template <>
std::vector<StageSample> samples_of<Bounds>();

}  // namespace rabiline::test
