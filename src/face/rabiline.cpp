#include "face/rabiline.hpp"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <omp.h>
#include <sys/utsname.h>
#include <unistd.h>

#include <chrono>
#include <ctime>
#include <stdexcept>

#include "core/isa.hpp"
#include "core/version.hpp"
#include "face/tell_model.hpp"
#include "input/model_file.hpp"
#include "plan/explain.hpp"
#include "simulation/finish.hpp"
#include "simulation/run.hpp"
#include "storage/results_file.hpp"

namespace rabiline {

struct Setup::Contents {
  Loaded file;
  std::string title, fingerprint;
};

namespace {

using Clock = std::chrono::steady_clock;

std::string fingerprint_of(const std::vector<InputText>& inputs, const Changes& changes) {
  std::uint64_t hash = 14695981039346656037ULL;  // FNV-1a
  const auto mix = [&](const std::string& text) {
    for (const char c : text + '\0') hash = (hash ^ static_cast<unsigned char>(c)) * 1099511628211ULL;
  };
  mix(version);
  for (const InputText& input : inputs) mix(input.text);
  for (const std::string& change : changes.set) mix(change);
  for (const std::string& scan : changes.scan) mix(scan);
  mix(changes.without_scan ? "without scan" : "");
  mix(changes.particles.value_or(""));
  mix(changes.seed.value_or(""));
  return fmt::format("{:016x}", hash);
}

Setup setup_of(LoadedFile file, const std::filesystem::path& folder, const Changes& changes) {
  auto contents = std::make_shared<Setup::Contents>();
  contents->file = load(std::move(file), folder.string(), changes);
  contents->title = std::visit([](const auto& any) { return any.title(); }, contents->file);
  contents->fingerprint = fingerprint_of(
      std::visit([](const auto& any) { return any.inputs; }, contents->file), changes);
  return Setup(std::move(contents));
}

/// This moment as ISO 8601 with offset.
std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%S%z}", fmt::localtime(std::time(nullptr))); }

/// What is known before anything is computed.
Provenance provenance_of(const Setup& setup, const std::vector<std::string>& arguments) {
  Provenance p;
  p.arguments = arguments;
  p.inputs = setup.inputs();
  p.version = version;
  p.compiler = compiler;
  utsname machine{};
  if (uname(&machine) == 0) p.host = machine.nodename;
  p.start_time = now();
  return p;
}

void finish(Provenance& provenance, Clock::time_point begin) {
  provenance.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  provenance.end_time = now();
}

Isa isa_of(const RunSettings& settings) {
  if (settings.isa.empty()) return best_isa();
  const std::optional<Isa> isa = parse_isa(settings.isa);
  if (!isa)
    throw std::invalid_argument(fmt::format(
        "there is no instruction set \"{}\"; choose x86-64, avx2 or avx512", settings.isa));
  if (!supported(*isa))
    throw std::invalid_argument(fmt::format("this processor has no {}; the best one here is {}",
                                            settings.isa, name_of(best_isa())));
  return *isa;
}

/// Sums of every thread and of the whole, and what threads keep at planes, must fit into the machine.
void require_memory(const Plan& plan, int threads) {
  const double needed = static_cast<double>(plan.sums) * sizeof(Sum) * (threads + 2) +
                        static_cast<double>(bytes_of_stages(plan)) * threads;
  const double there =
      static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  if (needed > 0.7 * there)
    throw std::invalid_argument(fmt::format(
        "the histograms of {} scan points need {:.1f} GiB on {} threads, and this machine has {:.1f} GiB\n"
        "  help: use fewer bins, fewer scan points or fewer threads",
        plan.points, needed / 1073741824, threads, there / 1073741824));
}

}  // namespace
}  // namespace rabiline
