#pragma once
// Collects what parts contribute and cuts the beam at every edge.
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "section/section.hpp"

namespace rabiline {

/// What becomes of deflecting magnets.
enum class Magnets {
  deflect,  // a plane, and the field on the axis; with a fringe, or where other static fields overlap it, a
            // field among others
  fields,   // fields among others
  uniform   // their fields on the axis alone
};

class SectionBuilder {
 public:
  /// `wall` is the chamber's; every part's own bore narrows it. Levels of atoms tell static fields, which
  /// meet at edges without a flip, from what drives them: where there are any, a field that turns along the
  /// beam is one that differs from place to place.
  explicit SectionBuilder(Wall wall, bool atoms = false) : chamber_(wall), atoms_(atoms) {}

  /// The following contributions come from this part.
  void begin_part(int part) { part_ = part; }

  void uniform(double begin, double end, UniformTerm);
  /// An oscillator of this part, under the name that zones follow it by.
  void oscillator(const std::string& name, Oscillator);
  /// A zone that follows that oscillator, its own phase added; the oscillator may be declared later.
  void zone(double begin, double end, RotatingTerm, const std::string& oscillator);
  /// A field that turns along the beam only.
  void twisted(double begin, double end, const RotatingTerm&);
  void coil(double begin, double end, const CoilTerm&);
  /// A static field that differs from place to place; it ends where its stretch ends.
  void shaped(double begin, double end, ShapedTerm);
  /// One that swings by a clock of its own.
  void swinging(double begin, double end, ShapedTerm, Oscillator);
  /// One that swings by that oscillator, which may be declared later: its own phase is added, and what it
  /// lags in the sense of turning.
  void swinging(double begin, double end, ShapedTerm, const std::string& oscillator, double phase,
                double lag);
  /// Where a field jumps or bends sharply inside of its stretch: a step could pass such a place between those
  /// where it asks for the field.
  void kink(double y) { kinks_.push_back(y); }
  /// What terms point into: it must live as long as they, also where the beamline does not.
  void keep(std::shared_ptr<const void> table) { tables_.push_back(std::move(table)); }
  /// A static electric field, in V/m; it ends where its stretch ends.
  void electric(double begin, double end, ShapedTerm);
  /// Gravity acts along the beam from its source to there.
  void fall_along(double end) { fall_end_ = end; }
  void bore(double begin, double end, double radius, Offset);
  void plane(double y, decltype(Plane::term) term) { planes_.push_back({y, part_, std::move(term)}); }

  /// The sections between neighbouring edges where anything stands, and the planes in order of y.
  Sections build(Magnets = Magnets::deflect) const;

 private:
  struct Extent {
    double begin, end;
    int part;
  };
  Wall chamber_;
  bool atoms_;
  int part_ = 0;
  std::vector<std::pair<Extent, UniformTerm>> uniform_;
  struct Zone {
    RotatingTerm term;
    std::string oscillator;  // empty: no clock
  };
  struct Swing {
    SwingingTerm term;
    std::string oscillator;  // empty: its own
  };
  RotatingTerm follow(const Zone&) const;
  SwingingTerm follow(const Swing&) const;
  Sections cut();
  bool is_among_fields(const Plane& magnet) const;
  void make_field(const Plane& magnet);
  std::vector<double> edges() const;

  std::map<std::string, Oscillator> oscillators_;
  std::vector<std::pair<Extent, Zone>> zones_;
  std::vector<std::pair<Extent, CoilTerm>> coils_;
  std::vector<std::pair<Extent, ShapedTerm>> shaped_;
  std::vector<std::pair<Extent, Swing>> swinging_;
  std::vector<std::pair<Extent, ShapedTerm>> electric_;
  std::vector<std::pair<Extent, GapTerm>> gaps_;
  std::vector<std::pair<Extent, Wall>> bores_;
  std::vector<Plane> planes_;
  std::vector<double> kinks_;
  std::vector<std::shared_ptr<const void>> tables_;
  double fall_end_ = 0;  // [m]
};

}  // namespace rabiline
