#include "core/thread_stacks.hpp"

#include <cstddef>

#include <pthread.h>
#include <sys/resource.h>

namespace rabiline {
namespace {

constexpr std::size_t deep_enough = std::size_t{8} << 20;  // [bytes]

}  // namespace

void widen_thread_stacks() {
#ifdef __GLIBC__
  pthread_attr_t attributes;
  if (pthread_getattr_default_np(&attributes) != 0) return;
  std::size_t size = 0;
  if (pthread_attr_getstacksize(&attributes, &size) == 0 && size < deep_enough &&
      pthread_attr_setstacksize(&attributes, deep_enough) == 0)
    pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
#endif
}

bool first_thread_is_narrow() {
  rlimit stack{};
  return getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur < deep_enough;
}

}  // namespace rabiline
