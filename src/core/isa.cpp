#include "core/isa.hpp"

#include <fmt/format.h>

#include <initializer_list>
#include <stdexcept>

namespace rabiline {

bool supported(Isa isa) {
#if defined(__x86_64__)
  // These ask the operating system too: it has to save the wide registers. The features are those that
  // cmake/kernels.cmake compiles for.
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  switch (isa) {
    case Isa::baseline:
      return true;
    case Isa::avx2:
      return avx2;
    case Isa::avx512:
      return avx2 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
             __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512bw");
  }
  return false;
#else
  return isa == Isa::baseline;
#endif
}

Isa best_isa() {
  for (const Isa isa : {Isa::avx512, Isa::avx2})
    if (supported(isa)) return isa;
  return Isa::baseline;
}

std::string_view name_of(Isa isa) {
  switch (isa) {
    case Isa::avx512:
      return "avx512";
    case Isa::avx2:
      return "avx2";
    case Isa::baseline:
      break;
  }
#if defined(__x86_64__)
  return "x86-64";
#else
  return "generic";
#endif
}

std::optional<Isa> parse_isa(std::string_view name) {
  for (const Isa isa : {Isa::baseline, Isa::avx2, Isa::avx512})
    if (name == name_of(isa)) return isa;
  return std::nullopt;
}

Isa isa_called(std::string_view name) {
  if (name.empty()) return best_isa();
  const std::optional<Isa> isa = parse_isa(name);
  if (!isa)
    throw std::invalid_argument(
        fmt::format("there is no instruction set \"{}\"; choose x86-64, avx2 or avx512", name));
  if (!supported(*isa))
    throw std::invalid_argument(
        fmt::format("this processor has no {}; the best one here is {}", name, name_of(best_isa())));
  return *isa;
}

}  // namespace rabiline
