#pragma once
// How far a run is: one line that renews itself on a terminal, a line every ten seconds elsewhere.
#include <string>

#include "rabiline.hpp"

namespace rabiline {

class ProgressLine {
 public:
  /// "auto", "lines", "json" or "none".
  explicit ProgressLine(const std::string& kind);
  void operator()(const Progress&);
  void clear();

 private:
  bool terminal_, json_, quiet_, shown_ = false;
  double next_ = 0;
};

}  // namespace rabiline
