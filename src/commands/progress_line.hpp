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
  /// What takes its time before and behind the flight of a long scan.
  void planning(std::size_t points);
  void writing(std::size_t points, std::size_t of);
  void clear();

 private:
  void show(const std::string& text);

  bool terminal_, json_, quiet_, shown_ = false;
  double next_ = 0, written_ = 0;
};

}  // namespace rabiline
