#pragma once
// Text for people. Nothing of it steers a terminal, and nothing is lost but text where nobody reads it.
#include <cstdio>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

namespace rabiline {

/// Control characters come from files; our own are in `format`.
void put(FILE* to, std::string_view text);

template <class... Args>
void say(FILE* to, fmt::format_string<Args...> format, Args&&... args) {
  put(to, fmt::format(format, std::forward<Args>(args)...));
}

/// Why text on `stdout` was lost although somebody waits for it, such as a full disk; empty where none was.
/// That it was closed from the beginning counts where the text is what was asked for.
std::string lost_text(bool is_asked_for);

}  // namespace rabiline
