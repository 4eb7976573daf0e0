#include "commands/progress_line.hpp"

#include <cmath>
#include <cstdio>

#include <unistd.h>

#include "commands/say.hpp"

namespace rabiline {
namespace {

std::string duration(double seconds) {
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {:02} s", s / 60, s % 60);
  return fmt::format("{} h {:02} min", s / 3600, s / 60 % 60);
}

std::string reached(const Progress& p) {
  if (!(p.error > 0)) return "";
  const std::string centre = p.centre_error > 0 && std::isfinite(p.centre_error)
                                 ? fmt::format(", of the line's centre {:.2g} (SI)", p.centre_error)
                                 : "";
  return fmt::format(" of a part; error of `detected` so far {:.2g}{}", p.error, centre);
}

/// Back to the beginning of the terminal's line.
void return_carriage() { std::fputc('\r', stderr); }

}  // namespace

ProgressLine::ProgressLine(const std::string& kind)
    : terminal_(kind == "auto" && isatty(STDERR_FILENO) == 1),
      json_(kind == "json"),
      quiet_(kind == "none") {}

void ProgressLine::show(const std::string& text) {
  if (!terminal_) {
    say(stderr, "{}\n", text);
    return;
  }
  return_carriage();
  say(stderr, "{}      ", text);
  shown_ = true;
}

void ProgressLine::planning(std::size_t points) {
  constexpr std::size_t soon_planned = 50'000;
  if (!quiet_ && !json_ && points > soon_planned) show(fmt::format("planning {} scan points", points));
}

void ProgressLine::writing(std::size_t points, std::size_t of) {
  constexpr double tenth = 0.1;
  const double done = static_cast<double>(points) / static_cast<double>(of);
  if (quiet_ || json_ || (!terminal_ && done < written_ + tenth) || done == 1) return;
  written_ = done;
  show(fmt::format("writing {:5.1f} %", 100 * done));
}

void ProgressLine::operator()(const Progress& p) {
  if (quiet_) return;
  const bool foreseen = p.seconds_left > 0 || p.done >= 1;  // nothing is before the first have flown
  const std::string text =
      fmt::format("{:5.1f} %{}{}", 100 * p.done,
                  foreseen ? fmt::format("  {} left", duration(p.seconds_left)) : "", reached(p));
  if (terminal_) {
    show(text);
    return;
  }
  if (p.seconds < next_) return;
  next_ = p.seconds + 10;
  if (json_)
    say(stderr,
        "{{\"done\": {:.4f}, \"seconds\": {:.1f}, \"seconds_left\": {:.1f}, \"error\": {:.6g}, "
        "\"centre_error\": {}}}\n",
        p.done, p.seconds, p.seconds_left, p.error,
        std::isfinite(p.centre_error) ? fmt::format("{:.6g}", p.centre_error) : "null");
  else
    show(text);
}

void ProgressLine::clear() {
  if (!std::exchange(shown_, false)) return;
  return_carriage();
  say(stderr, "{:40}", "");
  return_carriage();
}

}  // namespace rabiline
