#include "commands/say.hpp"

#include <cerrno>
#include <cstring>
#include <string>

#include "core/diagnostics.hpp"

namespace rabiline {
namespace {

int failure = 0;  // of the first write to stdout that failed

void note(bool written) {
  if (!written && failure == 0) failure = errno;
}

}  // namespace

void put(FILE* to, std::string_view text) {
  const std::string shown = printable(text);
  const bool written = std::fwrite(shown.data(), 1, shown.size(), to) == shown.size();
  if (to == stdout) note(written);
}

std::string lost_text(bool is_asked_for) {
  note(std::fflush(stdout) == 0);
  if (failure == EBADF) return is_asked_for ? "it is closed" : "";
  const bool gone = failure == EPIPE || failure == EIO;  // a pipe, a terminal
  return failure == 0 || gone ? "" : std::strerror(failure);
}

}  // namespace rabiline
