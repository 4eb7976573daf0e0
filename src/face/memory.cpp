#include "face/memory.hpp"

#include <set>
#include <stdexcept>

#include <fmt/format.h>

#include "core/machine_memory.hpp"
#include "field/field_map.hpp"
#include "simulation/form_flight.hpp"

namespace rabiline {
namespace {

/// Histograms of so many points in a result, and what is packed of them when it is written [bytes].
double bytes_of_histograms(const Experiment& experiment, std::size_t points) {
  double bins = 0;
  for (const PlacedPart& part : experiment.points.front().parts)
    if (const Detector* detector = detector_in(part.part))
      bins += static_cast<double>(detector->bins.x) * static_cast<double>(detector->bins.z);
  return 2.5 * sizeof(double) * bins * static_cast<double>(points);
}

/// Of its field maps [bytes], each once.
double bytes_of_maps(const Experiment& experiment) {
  std::set<const FieldMap*> maps;
  for (const PlacedPart& part : experiment.points.front().parts)
    std::visit(
        [&](const auto& any) {
          if constexpr (requires { any.map.map; }) maps.insert(any.map.map.get());
        },
        part.part);
  double bytes = 0;
  for (const FieldMap* map : maps) bytes += static_cast<double>(map->bytes());
  return bytes;
}

/// That a run may take, for which so much may be stated [bytes].
std::uint64_t most_memory(std::uint64_t stated) {
  constexpr double share = 0.7;  // of the machine's, where nothing is stated
  return stated > 0 ? stated : static_cast<std::uint64_t>(share * memory_there());
}

}  // namespace

Form form_of(const Experiment& experiment, std::uint64_t max_memory, bool keep_moments, int threads) {
  MomentsWanted moments;
  moments.everywhere = keep_moments;
  MemoryLimits limits;
  if (max_memory > 0) limits.wanted = max_memory;
  limits.most = most_memory(max_memory);
  return form_of(experiment, moments, limits, threads);
}

std::size_t points_at_once(const Experiment& experiment, const Form& form) {
  return (experiment.points.size() + form.slabs - 1) / form.slabs;
}

std::string told_refusal(const Experiment& experiment, const Form& form, int threads,
                         std::uint64_t max_memory) {
  try {
    require_memory(experiment, form, points_at_once(experiment, form), threads, max_memory);
    return {};
  } catch (const std::invalid_argument& refusal) {
    return fmt::format("refused    by `rabiline run`: {}\n", refusal.what());
  }
}

void require_memory(const Experiment& experiment, const Form& form, std::size_t at_once, int threads,
                    std::uint64_t max_memory) {
  const double kept =
      form.flies_in_slabs() ? bytes_of_kept_sums(form.plan) * static_cast<double>(form.slabs) : 0;
  const double maps = bytes_of_maps(experiment);
  const double needed = kept + maps + static_cast<double>(form.plan.sums) * sizeof(Sum) * (threads + 2) +
                        static_cast<double>(bytes_of_stages(form.plan)) * threads +
                        bytes_of_histograms(experiment, at_once);
  const bool is_stated = max_memory > 0;
  const auto most = static_cast<double>(most_memory(max_memory));
  if (needed <= most) return;
  const auto size = [](double bytes) {
    return bytes < 0x1p30 ? fmt::format("{:.4g} MiB", bytes / 0x1p20)
                          : fmt::format("{:.3g} GiB", bytes / 0x1p30);
  };
  const std::size_t points = experiment.points.size();
  throw std::invalid_argument(fmt::format(
      "the histograms{}{} need {} on {}, and {}\n  help: use fewer `bins`{}{}, {}",
      maps > 0 ? " and maps" : "", points == 1 ? std::string() : fmt::format(" of {} scan points", points),
      size(needed), threads == 1 ? "one thread" : fmt::format("{} threads", threads),
      is_stated
          ? fmt::format("--max-memory allows {}", size(most))
          : fmt::format("a run may take {} of the {} of this machine", size(most), size(memory_there())),
      points == 1 ? "" : " or fewer scan points", threads == 1 ? "" : ", fewer --threads",
      is_stated ? "or allow more" : "or state with --max-memory that it may take more"));
}

}  // namespace rabiline
