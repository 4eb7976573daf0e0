#pragma once
// Errors of the input, each with its place in a file. All of them are collected and shown at once.
#include <memory>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "core/fault.hpp"

namespace rabiline {

/// A text that messages can point into: a file, or an argument of the command line.
struct SourceText {
  std::string name;                // path as the user gave it, or "--set"
  std::vector<std::string> lines;  // without line ends
};

/// The whole text of an input file, as results keep it.
struct InputText {
  std::string path;
  std::string text;
};

/// Where something stands; line and column count from 1, column in bytes. No text: nowhere in particular.
struct Place {
  std::shared_ptr<const SourceText> text;
  int line = 0;
  int column = 0;
  int length = 1;  // how many characters the caret underlines
};

/// One problem: what is wrong and why, and what would mend it.
struct Diagnostic {
  Place place;
  std::string message;
  std::string suggestion;  // empty when there is none
  Severity severity = Severity::error;
};

/// "file:line:column: error: message", the line itself, carets under the place, "  help: suggestion".
std::string render(const Diagnostic&);
std::string render(const std::vector<Diagnostic>&);

/// Thrown by the input with every problem that was found; the command prints them and exits with 2.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Diagnostic> diagnostics);
  const std::vector<Diagnostic>& diagnostics() const { return diagnostics_; }

 private:
  std::vector<Diagnostic> diagnostics_;
};

/// The text without what would steer a terminal: a question mark for each control character but the end of a
/// line, for each that turns the direction of writing around, and for each byte that is not UTF-8.
std::string printable(std::string_view text);

/// The entry of `known` closest to `word` by edit distance, or empty when none is near.
std::string closest(std::string_view word, const std::vector<std::string>& known);

}  // namespace rabiline
