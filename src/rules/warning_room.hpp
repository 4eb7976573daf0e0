#pragma once
// The warnings by theme.
#include <algorithm>
#include <cmath>
#include <vector>

#include "rules/room.hpp"

namespace rabiline {

struct Plan;

/// [T] About what lasts for microseconds in a coil that bursts (D. Nakamura et al., Rev. Sci. Instrum. 89,
/// 095106 (2018)).
inline constexpr double most_magnetic_field = 1200;

inline Fault warning(std::string subject, std::string key, std::string message, std::string help = {},
                     double badness = 0) {
  return {std::move(subject), std::move(key),    std::move(message),
          std::move(help),    Severity::warning, badness};
}

/// How near a field comes to its resonance over the points of a scan, in one unit of frequency.
struct Approach {
  double lowest = HUGE_VAL, highest = -HUGE_VAL;  // detuning
  double nearest = HUGE_VAL;                      // its least size
  bool is_met = false;

  /// `strength`: of the field, or its width if that is larger. Whether it is nearer than before.
  bool look_at(double detuning, double strength) {
    lowest = std::min(lowest, detuning);
    highest = std::max(highest, detuning);
    is_met = is_met || std::abs(detuning) < 2 * strength;
    if (!(std::abs(detuning) < nearest)) return false;
    nearest = std::abs(detuning);
    return true;
  }
  bool keeps_off() const { return !is_met && lowest * highest > 0; }
  bool moves() const { return highest - lowest > 1e-9 * nearest; }
};

/// What makes one scan point pointless.
Faults blunders_of(const Beamline&);
/// Fields that are far from every resonance, or turn the wrong way, at one scan point.
Faults idle_drives_of(const Beamline&);
/// Scans that change how far a field is from its resonance, none of whose points comes near it.
Faults missed_resonances_of(const ScanPoints&);
/// Whether any field that such a fault is about has a size at this scan point.
bool is_driven(const Beamline&, const Fault&);
/// Species whose moment is too small for every magnet there is, where an atom of that name exists, at one
/// scan point.
Faults nuclei_among_atoms_of(const Beamline&);
/// Whether any magnet is on there.
bool is_deflected(const Beamline&, const Fault&);
/// Deflecting magnets with fields that nobody can make, at one scan point.
Faults impossible_magnets_of(const Beamline&);
/// Magnets of an even gradient whose field is 0 where atoms fly, which their levels are taken to follow.
Faults zeros_of_magnets_of(const Beamline&);
/// Deflecting magnets whose field stands at an angle to +z, which levels of atoms are taken to follow.
Faults turned_magnets_of(const Beamline&);
/// Edges in fields that sort levels where the direction jumps, which spins are taken to follow.
Faults jumps_of_sorting_fields_of(const Beamline&);
/// Numbers that no apparatus has, at one scan point.
Faults absurd_numbers_of(const Beamline&);
/// Fields that drive spins round and round: through more than so many Rabi cycles on resonance.
inline constexpr double most_turns = 100;
Faults endless_turns_of(const Beamline&);
Fault fault_of_turns(const std::string& name, double turns, const std::string& what);
/// Fields that drive levels of atoms in vain, too often, or less well known than they should be.
Faults line_warnings_of(const Experiment&, const Plan&);
/// What would fall by more than a tenth of the lowest opening, where nothing is said of gravity.
Faults untold_falls_of(const Beamline&);
/// Shutters that a beam of a given rate passes which starts all at once.
Faults unpulsed_choppers_of(const Beamline&);
/// Where the physics that is left out matters at one scan point.
Faults approximations_of(const Beamline&);

}  // namespace rabiline
