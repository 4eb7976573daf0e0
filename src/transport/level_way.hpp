#pragma once
// Fields of any direction and shape that an atom passes from where its levels are known to where they are
// asked for.
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "transport/level_course.hpp"

namespace rabiline {

/// What a way consists of.
struct LevelFields {
  std::vector<CourseSection> sections{};  // ascending
  std::vector<ShapedTerm> shaped{};
  bool begins_in_field = false, ends_in_field = false;
  double tolerance = 1e-6;
  bool operator==(const LevelFields&) const = default;
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
  std::uint64_t reach(int level) const;
  /// Time for one particle [s].
  double cost() const;

 private:
  const LevelFields fields_;
  const std::shared_ptr<const LevelTable> table_;
  LevelCourse course_;
};

/// "coherent through fields of any direction from 0.1 to 0.3 m, ..."
std::string describe(const LevelWay&);

}  // namespace rabiline
