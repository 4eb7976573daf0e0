#pragma once
// Free flight from plane to plane: what stands along it, and what of that a path meets first.
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/regions.hpp"
#include "transport/stage.hpp"

namespace rabiline {

/// Adds to a chain what ends paths between its planes: walls, gaps, what nothing may leave, gas up to them.
/// Whatever stands across the beam asks first for all that lies before it (`reach`).
class FreeFlight {
 public:
  /// All must outlive it.
  FreeFlight(const Beamline&, const Sections&, std::vector<Stage>& chain);

  /// Everything up to there.
  void reach(double y);
  /// Goes on in a section that it flies straight through, and leaves it at its end.
  void enter(const Section&);
  void leave(const Section&);
  /// Other stages fly up to there; gas acts along straight paths.
  void skip_to(double y);
  /// Gas begins.
  void fill(const Attenuation& gas) { gases_.push_back(gas); }
  /// Where walls have been asked about last [m].
  double reached() const { return reached_; }

 private:
  struct Barrier {
    Aperture opening;
    int part;
  };
  std::vector<Barrier> walls_up_to(double y) const;
  void attenuate_up_to(double y, const std::vector<Aperture>& walls);
  void keep_inside(double y, const std::vector<Aperture>& walls);

  const Beamline& beamline_;
  const std::vector<ChannelStretch> channels_;
  std::vector<Stage>& chain_;
  std::vector<Attenuation> gases_;
  const Section* section_ = nullptr;
  bool may_reach_chamber_;  // a parallel beam that nothing has bent stays where it started
  double reached_ = 0;
};

}  // namespace rabiline
