#include "core/machine_memory.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

namespace rabiline {

double memory_there() {
  const double machine =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit allowed{};
  if (getrlimit(RLIMIT_AS, &allowed) != 0 || allowed.rlim_cur == RLIM_INFINITY) return machine;
  return std::min(machine, static_cast<double>(allowed.rlim_cur));
}

}  // namespace rabiline
