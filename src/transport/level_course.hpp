#pragma once
// Fields of any direction and shape along a straight path, through which the levels of an atom are carried as
// amplitudes, as kernels see them.
#include <algorithm>

#include "field/shaped_term.hpp"
#include "spin/level_period.hpp"
#include "transport/kernels.hpp"

namespace rabiline {

/// A part of the way with a field.
struct CourseSection {
  SpinZone field;                        // all that does not differ across the beam: its rates are fields [T]
  int shaped_begin = 0, shaped_end = 0;  // of the course's terms
  double longest = 0;                    // [m] way in one step
  double fastest = 0;                    // [rad/s] of what drives there as a whole field; 0: nothing does
  bool has_courses = false;              // that fields go through in time
  int wave = -1;           // of the course's: what drives there in the rotating-wave approximation
  int period = -1;         // of the course's, where whole fields drive that have one
  bool is_pulsed = false;  // by any of its drives, at times of the clock
  bool operator==(const CourseSection&) const = default;

  /// Whether any whole field does, in time.
  bool moves() const { return fastest > 0 || has_courses; }
  /// [m] By so much inside of where a field begins or ends it is asked for: rounding would find it absent.
  double hair() const { return std::min(1e-12 * field.end, 1e-9 * (field.end - field.begin)); }
};

/// <low|H|high> of one of the manifold's pairs, or behind them a level's own element, where `low` takes a
/// photon up (side 0) or gives one off (1); conjugate: <high|H|low>.
struct PhotonLeg {
  int pair = 0, side = 0;
  bool conjugate = false;
};
/// Two of them, from level to level by way of one that does not stand still.
struct TwoPhotonPath {
  int coupling = 0;  // of LevelWave::standing
  int by = 0;
  PhotonLeg last{}, first{};                     // to `to` of the coupling, from its `from`
  double last_taken_up = 0, first_taken_up = 0;  // photons, 1 or -1
};

/// What drives in a section, all near one frequency, and the frame of WaveFrame, as kernels see them: places
/// of levels in the manifold.
struct LevelWave {
  double omega = 0;                  // [rad/s] of that frequency
  int drives = 0;                    // their angles are less by omega t
  const DriveTerm* drive = nullptr;  // spin_rate is a field [T]
  LevelManifold standing{};          // levels and what couples them in the frame, without any numbers
  int of_first = 0;                  // couplings that are not of two photons; those come behind
  // By coupling: 1 or -1 for the photons that `to` has taken up more, 0 for the motion of the static field;
  // then which of the pairs it is, or of the couplings.
  const int *photons = nullptr, *number = nullptr;
  int paths = 0;
  const TwoPhotonPath* path = nullptr;
  int moves = 0;  // couplings by the motion that do not stand still
  const int* move = nullptr;
  const int* left_out =
      nullptr;  // [pair] 1: by what takes a photon up in `low` does, 2: by what gives one off
  const double* rate = nullptr;  // [level] [rad/s] amplitudes have exp(i rate t)
};

/// LevelPeriod of a section, as kernels see it.
struct LevelPeriodForm {
  double third[3] = {0, 0, 1}, first[3] = {1, 0, 0};  // axes of its levels
  int first_harmonic = 0, harmonics = 0;
  const int* end = nullptr;  // [harmonic] of its terms
  const LevelPeriod::Term* term = nullptr;
  const double *photons = nullptr, *rate = nullptr;  // [level]
  const double* quasi = nullptr;                     // [mode]
};

/// From where levels are known to where they are asked for. At both ends they are those of the static field
/// there, or in no field those along +z; between fields they stay as if a weak field kept its direction.
/// Where one static field ends and another begins, levels keep their names in the frame of the old direction,
/// as if the size changed slowly; directions change at once. What moves in time is switched on behind that,
/// and off before it, at once: the state stays.
struct LevelCourse {
  const LevelManifold* manifolds = nullptr;
  const int *manifold_of = nullptr, *place_of = nullptr;  // [level]
  const CourseSection* sections = nullptr;
  int count = 0;
  const ShapedTerm* shaped = nullptr;
  const LevelWave* waves = nullptr;
  const LevelPeriodForm* periods = nullptr;
  bool begins_in_field = false, ends_in_field = false;
  double behind = 0;        // [T] of a field along +z that begins where the last one ends
  double tolerance = 1e-6;  // of probabilities
};

}  // namespace rabiline
