#pragma once
// The beamlines of a scan: listed, or made when they are asked for, so that a million points need no memory.
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <iterator>
#include <stdexcept>
#include <utility>
#include <vector>

#include "beamline/beamline.hpp"
#include "beamline/scan.hpp"

namespace rabiline {

class ScanPoints {
 public:
  using Make = std::function<Beamline(std::size_t)>;
  ScanPoints() = default;
  ScanPoints(std::vector<Beamline> listed) : listed_(std::move(listed)), size_(listed_.size()) {}
  ScanPoints(std::initializer_list<Beamline> listed) : ScanPoints(std::vector<Beamline>(listed)) {}
  /// The first point is kept, the others are made anew each time.
  ScanPoints(std::size_t size, Make make) : make_(std::move(make)), size_(size) {
    if (size_ > 0) listed_.push_back(make_(0));
  }

  std::size_t size() const { return size_; }
  bool empty() const { return size_ == 0; }
  const Beamline& front() const { return listed_.front(); }
  /// A value: keep it as long as something points into it.
  Beamline operator[](std::size_t point) const {
    return point < listed_.size() ? listed_[point] : make_(point);
  }
  void push_back(Beamline beamline) {
    if (make_) throw std::logic_error("points that are made on demand cannot be added to");
    listed_.push_back(std::move(beamline));
    size_ = listed_.size();
  }

  class Iterator {
   public:
    using iterator_category = std::input_iterator_tag;
    using value_type = Beamline;
    using difference_type = std::ptrdiff_t;
    using pointer = void;
    using reference = Beamline;
    Iterator(const ScanPoints& points, std::size_t at) : points_(&points), at_(at) {}
    Beamline operator*() const { return (*points_)[at_]; }
    Iterator& operator++() {
      ++at_;
      return *this;
    }
    Iterator operator++(int) {
      Iterator before = *this;
      ++at_;
      return before;
    }
    bool operator==(const Iterator& other) const { return at_ == other.at_; }

   private:
    const ScanPoints* points_;
    std::size_t at_;
  };
  Iterator begin() const { return {*this, 0}; }
  Iterator end() const { return {*this, size_}; }

 private:
  std::vector<Beamline> listed_;
  Make make_;
  std::size_t size_ = 0;
};

/// The experiment over its scan, row-major: the last axis changes fastest. A single point where nothing is
/// scanned.
struct Experiment {
  std::vector<ScanAxis> axes;
  ScanParticles particles = ScanParticles::shared;
  ScanPoints points;
  std::size_t first = 0;  // number of the first point in the whole scan, of which these may be a part
};

}  // namespace rabiline
