#include "commands/stop.hpp"

#include <fcntl.h>
#include <sys/time.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <csignal>
#include <cstdlib>
#include <ctime>
#include <mutex>
#include <string_view>
#include <utility>

#include "commands/common.hpp"
#include "storage/safe_file.hpp"

namespace rabiline {
namespace {

std::atomic<bool> stop{false};
std::atomic<int> insisted{0};
std::atomic<std::time_t> asked_at{0};  // [s] for the first time
static_assert(std::atomic<std::time_t>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

std::time_t seconds_now() {
  timespec now{};
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec;
}

extern "C" void on_signal(int signal) {
  if (!stop.exchange(true)) {
    asked_at = seconds_now();
    return;
  }
  // `timeout` and terminals send signals in pairs, the shell and the kernel HUP more often, XCPU comes every
  // second.
  if (signal != SIGTERM && signal != SIGINT) return;
  if (++insisted < 2 && seconds_now() - asked_at < 5) return;
  std::signal(signal, SIG_DFL);
  std::raise(signal);
}

/// Nothing but what is safe within a signal.
extern "C" void on_early_signal(int) {
  constexpr std::string_view told = "\nstopped before the flight began\n";
  [[maybe_unused]] const ssize_t written = ::write(STDERR_FILENO, told.data(), told.size());
  _exit(exit_code::stopped);
}

constexpr std::array stopping{SIGTERM, SIGINT, SIGHUP, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM};

void handle_signals(void (*handler)(int)) {
  for (const int signal : stopping)
    if (std::signal(signal, handler) == SIG_IGN && signal == SIGHUP) std::signal(signal, SIG_IGN);
}

}  // namespace

void ignore_failed_writes() {
  for (const int signal : {SIGPIPE, SIGXFSZ}) std::signal(signal, SIG_IGN);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (fcntl(stream, F_GETFD) == -1) open("/dev/null", stream == STDIN_FILENO ? O_WRONLY : O_RDONLY);
}

void end_at_signals() { handle_signals(on_early_signal); }
void watch_signals() { handle_signals(on_signal); }

void stop_after(double seconds) {
  itimerval timer{};
  timer.it_value.tv_sec = static_cast<std::time_t>(std::floor(seconds));
  timer.it_value.tv_usec = static_cast<suseconds_t>((seconds - std::floor(seconds)) * 1e6);
  if (seconds < 1e-6) timer.it_value.tv_usec = 1;  // a timer of zero never rings
  std::signal(SIGALRM, on_signal);
  setitimer(ITIMER_REAL, &timer, nullptr);
}

void hold_back_signals() {
  sigset_t held{};
  sigemptyset(&held);
  for (const int signal : stopping) sigaddset(&held, signal);
  sigprocmask(SIG_BLOCK, &held, nullptr);
}

const std::atomic<bool>& stop_requested() { return stop; }

StoppedAtOnce::StoppedAtOnce(std::string words)
    : waits_([words = std::move(words)](const std::stop_token& over) {
        std::mutex own;
        std::condition_variable_any call;
        std::unique_lock lock(own);
        while (!over.stop_requested()) {
          if (stop) {
            say(stderr, "\n{}", words);
            PassingFile::remove_all();
            std::_Exit(exit_code::stopped);
          }
          call.wait_for(lock, over, std::chrono::milliseconds(20), [] { return false; });
        }
      }) {}

}  // namespace rabiline
