#pragma once
// What is noted of a run.
#include <chrono>
#include <string>
#include <vector>

#include "simulation/result.hpp"
#include "simulation/snapshot.hpp"

namespace rabiline {

/// Program, machine, command line and inputs; the times of its life are those of the work.
class Record {
 public:
  Record(const std::vector<InputText>& inputs, const std::vector<std::string>& changes,
         const std::vector<std::string>& arguments);
  /// Goes on with what was begun before.
  void continue_from(const Snapshot&);
  Provenance* operator->() { return &kept_; }
  double seconds() const;
  Provenance finish();

 private:
  using Clock = std::chrono::steady_clock;
  Provenance kept_;
  double before_ = 0;  // [s]
  Clock::time_point begin_ = Clock::now();
};

}  // namespace rabiline
