#pragma once
// Which drives on an atom's way are taken in the rotating-wave approximation, and in which frames.
#include <functional>
#include <set>
#include <vector>

#include "beamline/beamline.hpp"
#include "plan/level_lines.hpp"
#include "plan/zones.hpp"
#include "section/section.hpp"
#include "transport/level_way.hpp"

namespace rabiline {

/// [rad/s] The fastest that a drive changes for a particle of that speed.
double angular_frequency(const DriveTerm&, double speed);

/// Clocks of the drives between two places that are not followed as whole fields: what swings in the
/// rotating-wave approximation, as its name says; and of what turns, which has no such name, the highest
/// frequencies as long as all that is whole has more than so many periods.
std::set<int> clocks_of_waves(const std::vector<Section>&, double from, double to, const ZoneMaker&,
                              const CoupledSpins&, double periods);
/// Whether all that drives in a section does so as a whole field with one period, beside a uniform static
/// one, and on a length [m] so long that LevelPeriod is worth its while.
bool repeats(const Section&, double length, const ZoneMaker&, const CoupledSpins&);

/// What whole fields that move do beside such drives.
struct MovingFields {
  std::function<double(double y)> rate;  // [T/s] how fast they change, at a place along the beam
  double fastest = 0;                    // [Hz]
};
/// The drives of a zone with the frame in which they stand nearly still, by what acts where the beam passes a
/// section.
WaveFields wave_fields(const SpinZone& drives, const Section&, const Species& atom,
                       const std::vector<int>& manifold_of, double speed, const Offset& beam,
                       const MovingFields&);

/// What drives on a way, in axes along the static field at the place of its section where a line is nearest,
/// with that one of the frequencies that it sweeps through.
std::vector<DrivenZone> zones_near_lines(const LevelFields&, const Structure&, double speed);

}  // namespace rabiline
