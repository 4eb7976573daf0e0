#pragma once
// What ends the program before its work is done.
#include <atomic>
#include <string>
#include <thread>

namespace rabiline {

/// At the start of the program: a pipe or a terminal that has gone and a file that may not grow are errors of
/// the write, and so is one to a stream that was closed, whose number no file gets.
void ignore_failed_writes();

/// From here on, while nothing flies yet, these signals end the program at once, with the exit code of what
/// was stopped.
void end_at_signals();
/// From here on TERM, INT, HUP, XCPU, USR1, USR2 and ALRM only ask to stop. Where somebody insists, by the
/// third TERM or INT, or one 5 s after the first, it ends the program at once. A HUP that was ignored (nohup)
/// still is.
void watch_signals();
/// The same when so much time has gone by [s].
void stop_after(double seconds);
/// From here on they wait, until what the program becomes is ready for them.
void hold_back_signals();

const std::atomic<bool>& stop_requested();

/// While it lives, the program ends as stopped when it is asked to, whatever it does, with these words and
/// without the files that it has begun: for what takes long and is lost by nobody.
class StoppedAtOnce {
 public:
  explicit StoppedAtOnce(std::string words);

 private:
  std::jthread waits_;
};

}  // namespace rabiline
