#include "face/machine.hpp"

#include <algorithm>
#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

#include "core/processors.hpp"
#include "particle/batch.hpp"

namespace rabiline {

int threads_of(const RunSettings& settings) {
  if (settings.threads < 0 || settings.threads > 1024)
    throw std::invalid_argument("`threads` must be from 1 to 1024, or 0 for as many as the process may use");
  if (settings.threads > 0) return settings.threads;
  // Processes that were bound to no cores of their own share those of the machine.
  const int sharing = settings.ranks != nullptr && processors() == sysconf(_SC_NPROCESSORS_ONLN)
                          ? settings.ranks->neighbours()
                          : 1;
  return std::max(1, processors() / sharing);
}

int batch_of(const RunSettings& settings) {
  if (settings.batch < 0 || settings.batch > Batch::capacity || settings.batch % 8 != 0)
    throw std::invalid_argument(
        fmt::format("`batch` must be a multiple of 8 up to {}, or 0 for the most", Batch::capacity));
  return settings.batch == 0 ? Batch::capacity : settings.batch;
}

}  // namespace rabiline
