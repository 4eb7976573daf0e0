#pragma once
// How a kernel is declared: one function for each instruction set, chosen at run time.
#include <type_traits>

#include "core/isa.hpp"

/// RABILINE_KERNEL(name, result(parameters)), in namespace rabiline: the host calls kernel::name(isa)(...);
/// the definition stands in namespace RABILINE_ISA, in a source that is compiled once for each instruction
/// set.
#if defined(RABILINE_ISA)
#define RABILINE_KERNEL(name, ...)        \
  namespace RABILINE_ISA {                \
  std::type_identity_t<__VA_ARGS__> name; \
  }
#elif defined(__x86_64__)
#define RABILINE_KERNEL(name, ...)                                 \
  namespace isa_baseline {                                         \
  std::type_identity_t<__VA_ARGS__> name;                          \
  }                                                                \
  namespace isa_avx2 {                                             \
  std::type_identity_t<__VA_ARGS__> name;                          \
  }                                                                \
  namespace isa_avx512 {                                           \
  std::type_identity_t<__VA_ARGS__> name;                          \
  }                                                                \
  namespace kernel {                                               \
  inline std::type_identity_t<__VA_ARGS__>* name(Isa isa) {        \
    if (isa == Isa::avx512) return isa_avx512::name;               \
    return isa == Isa::avx2 ? isa_avx2::name : isa_baseline::name; \
  }                                                                \
  }
#else
#define RABILINE_KERNEL(name, ...)                                                   \
  namespace isa_baseline {                                                           \
  std::type_identity_t<__VA_ARGS__> name;                                            \
  }                                                                                  \
  namespace kernel {                                                                 \
  inline std::type_identity_t<__VA_ARGS__>* name(Isa) { return isa_baseline::name; } \
  }
#endif
