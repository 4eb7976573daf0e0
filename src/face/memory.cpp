#include "face/memory.hpp"

#include <stdexcept>

#include <fmt/format.h>
#include <unistd.h>

namespace rabiline {
namespace {

/// Histograms of all points in a result, and what is packed of them when it is written [bytes].
double bytes_of_histograms(const Experiment& experiment) {
  double bins = 0;
  for (const PlacedPart& part : experiment.points.front().parts)
    if (const Detector* detector = detector_in(part.part))
      bins += static_cast<double>(detector->bins.x) * static_cast<double>(detector->bins.z);
  return 2.5 * sizeof(double) * bins * static_cast<double>(experiment.points.size());
}

}  // namespace

Form form_of(const Experiment& experiment, std::uint64_t max_memory, bool keep_moments, int threads) {
  MomentsWanted moments;
  moments.everywhere = keep_moments;
  return form_of(experiment, moments, max_memory == 0 ? default_memory : max_memory, threads);
}

void require_memory(const Experiment& experiment, const Plan& plan, int threads, std::uint64_t max_memory) {
  const double needed = static_cast<double>(plan.sums) * sizeof(Sum) * (threads + 2) +
                        static_cast<double>(bytes_of_stages(plan)) * threads +
                        bytes_of_histograms(experiment);
  const double there =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  const bool is_stated = max_memory > 0;
  if (needed > (is_stated ? static_cast<double>(max_memory) : 0.7 * there))
    throw std::invalid_argument(
        fmt::format("the histograms of {} scan points need {:.3g} GiB on {} threads, and {} {:.3g} GiB\n"
                    "  help: use fewer bins, fewer scan points or fewer threads{}",
                    experiment.points.size(), needed / 1073741824, threads,
                    is_stated ? "--max-memory is" : "this machine has",
                    (is_stated ? static_cast<double>(max_memory) : there) / 1073741824,
                    is_stated ? ", or more memory" : ""));
}

}  // namespace rabiline
