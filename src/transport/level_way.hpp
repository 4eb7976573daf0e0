#pragma once
// Fields of any direction and shape that an atom passes from where its levels are known to where they are
// asked for.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "spin/level_period.hpp"
#include "spin/wave_frame.hpp"
#include "transport/level_course.hpp"

namespace rabiline {

/// Drives at one place whose frequencies are near to one another [Hz], and their frame.
struct WaveFields {
  double frequency = 0;
  std::vector<DriveTerm> drives{};  // of kind turning; spin_rate is a field [T]
  WaveFrame frame{};
  bool operator==(const WaveFields&) const = default;
};

/// What a way consists of.
struct LevelFields {
  std::vector<CourseSection> sections{};  // ascending
  std::vector<ShapedTerm> shaped{};
  std::vector<WaveFields> waves{};
  bool begins_in_field = false, ends_in_field = false;
  bool begins_too_weak = false, ends_too_weak = false;  // a field that gives levels no axis
  double behind = 0;  // [T] of a field along +z that begins where the last one ends
  double tolerance = 1e-6;
  double apart = 0;  // [Hz] F whose zero-field energies differ by more exchange nothing but by waves
  bool operator==(const LevelFields&) const = default;

  /// Whether anything drives in a frame of its own, between all levels.
  bool need_pairs() const {
    return !waves.empty() ||
           std::ranges::any_of(sections, [](const CourseSection& s) { return s.period >= 0; });
  }
};

/// With the tables that it is flown by; stays where it is, since kernels see pointers.
class LevelWay {
 public:
  LevelWay(LevelFields fields, std::shared_ptr<const LevelTable> table);
  LevelWay(const LevelWay&) = delete;
  LevelWay& operator=(const LevelWay&) = delete;

  const LevelFields& fields() const { return fields_; }
  const LevelTable& table() const { return *table_; }
  const LevelCourse& course() const { return course_; }
  /// Bits of the levels that one can go to.
  std::uint64_t reachable_from(int level) const;
  /// Time for one particle [s].
  double cost() const;

 private:
  const LevelFields fields_;
  const std::shared_ptr<const LevelTable> table_;
  struct Wave {
    std::vector<DriveTerm> drives{};
    std::vector<int> to{}, from{}, photons{}, number{}, move{}, left_out{};
    std::vector<TwoPhotonPath> paths{};
    std::vector<double> rate{};
    LevelWave view() const;
  };
  std::vector<Wave> waves_;
  std::vector<LevelWave> wave_views_;
  void work_out_periods();
  std::vector<LevelPeriod> periods_;
  std::vector<LevelPeriodForm> period_views_;
  LevelCourse course_;
};

/// "coherent through fields of any direction from 0.1 to 0.3 m, ..."
std::string describe(const LevelWay&);

}  // namespace rabiline
