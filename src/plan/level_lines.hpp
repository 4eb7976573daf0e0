#pragma once
// Lines between levels that a field can drive, one zone by itself.
#include <string>
#include <vector>

#include "particle/species.hpp"
#include "spin/level_drive.hpp"

namespace rabiline {

/// A field that drives levels, which are those of a static one along the third axis.
struct DrivenZone {
  double begin = 0, end = 0;  // [m]
  double field = 0;           // [T] the static one, against +z where negative
  double frequency = 0;       // [Hz]
  DriveParts parts{};         // where the envelope is highest
  bool is_even = true;        // it is as large all along
  Gate gate{};
  int part = -1;  // of the beamline, whose field drives
  bool operator==(const DrivenZone&) const = default;
};
/// Of a zone with a drive.
DrivenZone driven_zone(const LevelZone&);

/// A transition that a field can drive: between which levels, and how far it is.
struct Transition {
  int upper = 0, lower = 0;
  double frequency = 0, detuning = 0, rabi = 0;  // [Hz]; detuning of the field from the transition
  double shift = 0;                              // [Hz] of the transition, by what does not drive it
  int photons = 1;                               // of the field, at a time
};
/// Those that the direction of a field and its sense allow, the nearest first.
std::vector<Transition> transitions_near(const Structure&, const DrivenZone&);
/// Those that two photons of it drive by way of levels far from either, within 100 of a width [Hz] and as
/// strong as a hundredth of it; detuning is that of both photons. The field shifts levels by
/// sum |g|^2 / (E_i +- f - E_k) over all k, one photon more or less (W. Demtroeder, Laser Spectroscopy 2,
/// 5th ed. (Springer, 2015), sect. 2.5; as pairs_of_two_photons() has it).
std::vector<Transition> transitions_of_two_photons(const Structure&, const DrivenZone&, double width);
/// "F=4 m=0 - F=3 m=0", or with "by two photons" behind it.
std::string name_of(const Structure&, const Transition&);

/// What an approximation leaves out, by its largest amplitude.
std::string left_out(double neglected);

bool is_pulsed(const DrivenZone&);
/// [Hz] 1 over the time for which its field, of that length [m], drives at a stretch, at a speed [m/s].
double width_of(const DrivenZone&, double length, double speed);

/// A frequency in hertz, of a line with the digits that it has.
std::string megahertz(double);
std::string tesla(double);

}  // namespace rabiline
