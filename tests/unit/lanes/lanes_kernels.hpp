#pragma once
// core/lanes.hpp and core/random_lanes.hpp as functions on arrays, one table of them per instruction set.
#include <cstdint>

#include "core/isa.hpp"

namespace rabiline {

/// What one call works on.
struct alignas(64) Column {
  static constexpr int length = 4096;
  double value[length];
};
struct alignas(64) WordColumn {
  std::uint64_t value[Column::length];
};

struct LanesKernels {
  int lane_count;
  void (*sincos)(const Column& x, Column& s, Column& c);
  void (*sin_squared)(const Column& x, Column& y);
  void (*log)(const Column& x, Column& y);
  void (*exp)(const Column& x, Column& y);
  void (*atan)(const Column& x, Column& y);
  void (*sqrt)(const Column& x, Column& y);
  void (*abs)(const Column& x, Column& y);
  void (*round_to_nearest)(const Column& x, Column& y);
  void (*rotation_coefficients)(const Column& q, Column& S, Column& C);
  void (*fma)(const Column& a, const Column& b, const Column& c, Column& y);
  void (*fnma)(const Column& a, const Column& b, const Column& c, Column& y);
  void (*min)(const Column& a, const Column& b, Column& y);
  void (*max)(const Column& a, const Column& b, Column& y);
  /// c where a < b and a is not negative, else a + b; then the first n elements of each vector negated.
  void (*choose)(const Column& a, const Column& b, const Column& c, int n, Column& y);
  /// How many elements are below the limit, and whether any and all of the first vector are.
  void (*count_below)(const Column& x, double limit, int& count, bool& any_first, bool& all_first);
  void (*uniforms)(const WordColumn& particle, std::uint64_t seed, unsigned purpose, unsigned draw,
                   unsigned stream, Column& u0, Column& u1);
  /// The four words of each block, each as a number.
  void (*coarse_uniforms)(const WordColumn& particle, std::uint64_t seed, unsigned purpose, unsigned draw,
                          unsigned stream, Column (&u)[4]);
  void (*interleave)(const Column& a, const Column& b, Column& low, Column& high);
  /// Those that are even, one after the other, and how many they are.
  int (*pack_even)(const WordColumn& x, WordColumn& y);
};

namespace isa_baseline {
extern const LanesKernels lanes_kernels;
}
#if defined(__x86_64__)
namespace isa_avx2 {
extern const LanesKernels lanes_kernels;
}
namespace isa_avx512 {
extern const LanesKernels lanes_kernels;
}
#endif

inline const LanesKernels& lanes_kernels_for([[maybe_unused]] Isa isa) {
#if defined(__x86_64__)
  if (isa == Isa::avx512) return isa_avx512::lanes_kernels;
  if (isa == Isa::avx2) return isa_avx2::lanes_kernels;
#endif
  return isa_baseline::lanes_kernels;
}

}  // namespace rabiline
