#include "core/processors.hpp"

#include <algorithm>
#include <thread>

#include <sched.h>

namespace rabiline {

int processors() {
  cpu_set_t bound;
  if (sched_getaffinity(0, sizeof bound, &bound) == 0) return CPU_COUNT(&bound);
  return static_cast<int>(std::max(1u, std::thread::hardware_concurrency()));  // more than CPU_SETSIZE
}

}  // namespace rabiline
