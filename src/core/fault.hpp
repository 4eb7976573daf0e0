#pragma once
// What is wrong with values, wherever they come from. Only `input` knows where a file states them.
#include <string>
#include <vector>

namespace rabiline {

enum class Severity { error, warning };

struct Fault {
  std::string subject;  // a part's name, or `source`, `species`, `law`, `chamber`; empty: the whole
  std::string key;  // what to blame below the subject, "amplitude" or "tallies[1].axes[0].from"; may be empty
  std::string message;
  std::string help;  // empty where there is none
  Severity severity = Severity::error;
  double badness = 0;  // of faults that are alike but for the scan point, the worst is told
};

/// "C1.amplitude", "species[1].name", "parts".
inline std::string dotted_name(const std::string& subject, const std::string& key) {
  if (subject.empty() || key.empty()) return subject + key;
  return subject + (key.front() == '[' ? "" : ".") + key;
}

}  // namespace rabiline
