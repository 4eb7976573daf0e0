#include "core/thread_stacks.hpp"

#include <cstddef>

#include <pthread.h>

namespace rabiline {

void widen_thread_stacks() {
#ifdef __GLIBC__
  constexpr std::size_t wanted = std::size_t{1} << 20;
  pthread_attr_t attributes;
  if (pthread_getattr_default_np(&attributes) != 0) return;
  std::size_t size = 0;
  if (pthread_attr_getstacksize(&attributes, &size) == 0 && size < wanted &&
      pthread_attr_setstacksize(&attributes, wanted) == 0)
    pthread_setattr_default_np(&attributes);
  pthread_attr_destroy(&attributes);
#endif
}

}  // namespace rabiline
