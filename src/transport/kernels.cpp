#include "transport/kernels.hpp"

namespace rabiline {

namespace isa_baseline {
extern const Kernels table;
}
#if defined(__x86_64__)
namespace isa_avx2 {
extern const Kernels table;
}
namespace isa_avx512 {
extern const Kernels table;
}
#endif

const Kernels& kernels_for(Isa isa) {
#if defined(__x86_64__)
  if (isa == Isa::avx512) return isa_avx512::table;
  if (isa == Isa::avx2) return isa_avx2::table;
#endif
  static_cast<void>(isa);
  return isa_baseline::table;
}

}  // namespace rabiline
