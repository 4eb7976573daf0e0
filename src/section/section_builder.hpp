#pragma once
// Collects what parts contribute and cuts the beam at every edge.
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "section/section.hpp"

namespace rabiline {

class SectionBuilder {
 public:
  /// `wall` is the chamber's; every part's own bore narrows it.
  explicit SectionBuilder(Wall wall) : chamber_(wall) {}

  /// The following contributions come from this part.
  void begin_part(int part) { part_ = part; }

  void uniform(double begin, double end, UniformTerm);
  /// An oscillator: a RotatingTerm without amplitude, under the name that zones follow it by.
  void oscillator(const std::string& name, RotatingTerm clock);
  /// A zone that follows that oscillator, `phase` [rad] added to its own; the oscillator may be declared
  /// later.
  void zone(double begin, double end, double amplitude, double phase, const std::string& oscillator);
  void bore(double begin, double end, double radius);
  void plane(double y, decltype(Plane::term) term) { planes_.push_back({y, part_, term}); }

  /// The sections between neighbouring edges where anything stands, and the planes in order of y.
  Sections build() const;

 private:
  struct Extent {
    double begin, end;
    int part;
  };
  Wall chamber_;
  int part_ = 0;
  std::vector<std::pair<Extent, UniformTerm>> uniform_;
  struct Zone {
    double amplitude, phase;
    std::string oscillator;
  };
  RotatingTerm follow(const Zone&) const;

  std::map<std::string, RotatingTerm> oscillators_;
  std::vector<std::pair<Extent, Zone>> zones_;
  std::vector<std::pair<Extent, double>> bores_;
  std::vector<Plane> planes_;
};

}  // namespace rabiline
