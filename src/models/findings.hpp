#pragma once
// Findings as the models collect them, each by what is expected of it.
#include <utility>

#include "models/motion.hpp"

namespace rabiline {

class Findings {
 public:
  void closed_form(std::string name, std::string unit, double value, double expected, std::string meaning) {
    add(Expectation::closed_form, std::move(name), std::move(unit), value, expected, std::move(meaning));
  }
  /// How far something drifts that the equations keep.
  void conserved(std::string name, std::string unit, double drift, std::string meaning) {
    add(Expectation::conserved, std::move(name), std::move(unit), drift, 0, std::move(meaning));
  }
  void approximate(std::string name, std::string unit, double value, double expected, std::string meaning) {
    add(Expectation::approximate, std::move(name), std::move(unit), value, expected, std::move(meaning));
  }
  void supposed(std::string name, std::string unit, double value, double expected, std::string meaning) {
    add(Expectation::supposed, std::move(name), std::move(unit), value, expected, std::move(meaning));
  }
  void add(Expectation expectation, std::string name, std::string unit, double value, double expected,
           std::string meaning) {
    all_.push_back({std::move(name), std::move(unit), std::move(meaning), expectation, value, expected});
  }
  std::vector<Finding> take() { return std::move(all_); }

 private:
  std::vector<Finding> all_{};
};

}  // namespace rabiline
