#pragma once
// Runs a piece of a test in a process of its own, which may change its limits, user or mounts, or be killed.
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <string>

#include "storage/storage_error.hpp"

namespace rabiline {

/// What `work` failed with in a child process; "" when it went through.
inline std::string failure_in_child(const std::function<void()>& work) {
  int channel[2];
  if (::pipe(channel) != 0) return "no pipe";
  const pid_t child = ::fork();
  if (child == 0) {
    std::string message;
    try {
      work();
    } catch (const std::exception& error) {
      message = error.what();
    }
    const ssize_t written = ::write(channel[1], message.data(), message.size());
    ::_exit(written < 0 ? 1 : 0);
  }
  ::close(channel[1]);
  std::string message;
  char block[4096];
  for (ssize_t size; (size = ::read(channel[0], block, sizeof block)) > 0;) message.append(block, size);
  ::close(channel[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0 ? message : "the child died";
}

}  // namespace rabiline
