#include "face/record.hpp"

#include <algorithm>
#include <ctime>
#include <fstream>
#include <utility>

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <sys/utsname.h>

#include "core/commit.hpp"
#include "core/version.hpp"

namespace rabiline {
namespace {

/// This moment as ISO 8601 with offset.
std::string now() { return fmt::format("{:%Y-%m-%dT%H:%M:%S%z}", fmt::localtime(std::time(nullptr))); }

/// As Linux calls it, or the architecture.
std::string processor_of(const utsname& machine) {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);)
    if (line.starts_with("model name")) return line.substr(std::min(line.size(), line.find(':') + 2));
  return machine.machine;
}

}  // namespace

Record::Record(const std::vector<InputText>& inputs, const std::vector<std::string>& changes,
               const std::vector<std::string>& arguments) {
  utsname machine{};
  uname(&machine);
  kept_.arguments = arguments;
  kept_.inputs = inputs;
  kept_.changes = changes;
  kept_.version = version;
  kept_.commit = commit();
  kept_.compiler = compiler;
  kept_.host = machine.nodename;
  kept_.processor = processor_of(machine);
  kept_.start_time = now();
}

void Record::continue_from(const Snapshot& snapshot) {
  kept_.start_time = snapshot.begun;
  before_ = snapshot.seconds;
}

double Record::seconds() const {
  return before_ + std::chrono::duration<double>(Clock::now() - begin_).count();
}

Provenance Record::finish() {
  kept_.seconds = seconds();
  kept_.end_time = now();
  return std::move(kept_);
}

}  // namespace rabiline
