#pragma once
// What a run hands to storage: exact sums turned into numbers with errors, as plain values.
// Index order everywhere: scan point first, row-major: the last axis changes fastest.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "beamline/scan.hpp"
#include "core/diagnostics.hpp"
#include "simulation/flight_record.hpp"
#include "simulation/snapshot.hpp"

namespace rabiline {

/// A histogram axis of a detector.
struct BinAxis {
  std::string name;           // "x" or "z"
  std::vector<double> edges;  // [m] n + 1 of them
};

/// By their slowness, the particles of one species that a detector catches on some path: that they fly if
/// found in one level in front of the fields that turn spins, and in another one behind them.
struct TransitResult {
  std::string species;                 // empty where one flies alone
  std::vector<double> edges;           // [s/m] of equal cells, n + 1 of them
  std::vector<std::string> paths;      // "+1/2 to -1/2", or "+1/2" where what follows is alike for all levels
  std::vector<double> caught, errors;  // [paths][n] particles
};

/// One detector's histograms over the scan.
struct DetectorResult {
  std::string name, label;
  double y = 0;  // [m] where it stands
  BinAxis x, z;
  std::vector<double> offset_x, offset_z;  // [points] [m] of its centre where the scan moves it: the axes
                                           // are counted from there; else empty, and they are from the beam
  std::vector<double> counts;              // [points][nx][nz], in particles
  std::vector<double> counts_errors;       // same shape
  std::vector<double> counts_x, counts_x_errors;  // [points][nx]
  std::vector<double> counts_z, counts_z_errors;  // [points][nz]
  std::vector<double> detected;                   // [points] fraction of emitted
  std::vector<double> detected_errors;            // [points]
  std::vector<double> detected_covariance;        // [points][points]; empty where there is one point only
  std::vector<double> detected_of_all,
      detected_of_all_errors;  // [points] fraction of all that leave an aimed
                               // source; empty where no source is aimed
  /// Spin of what was detected: the fraction of the detected weight in each level. For `quantum` the levels
  /// are m = I ... -I of the spin along +z; for the vector laws two rows, (1 + S_z)/2 and (1 - S_z)/2.
  std::vector<std::string> level_labels;
  std::vector<double> levels, levels_errors;  // [points][levels]; NaN where nothing was detected
  double background = 0;                      // [1/s] counts without a beam
  std::vector<double> count_rate,
      count_rate_errors;                // [points] [1/s] with the background; empty without a rate
  std::vector<TransitResult> transits;  // where moments of the slowness are kept
};

/// One monitor over the scan.
struct MonitorResult {
  std::string name, label;
  double y = 0;                           // [m] where it stands, or its first plane does
  std::vector<double> passed;             // [points][planes] fraction of emitted that flew through its face
  std::vector<double> passed_errors;      // [points][planes]
  std::vector<double> passed_covariance;  // [planes][points][points]; empty where there is one point only
  std::vector<double> planes{};           // [m] where they are, of several
};

/// An axis of a tally: a range with equal bins, or levels with a label each.
struct TallyAxisResult {
  std::string quantity;  // "time_of_flight"
  Dimension dimension = Dimension::number;
  std::vector<double> edges;        // [SI] n + 1 of them; around 0, 1, ... for levels
  std::vector<std::string> labels;  // of levels, else empty
  std::vector<double> direction;    // that a spin is projected on, else empty
  /// Of what is inside the ranges of all axes; empty for levels and planes. NaN where nothing is. Of an axis
  /// that goes in a circle: the direction of the mean vector of length R, and sqrt(-2 ln R) (K. V. Mardia,
  /// Statistics of Directional Data, 1972).
  std::vector<double> mean, mean_errors, deviation, deviation_errors;  // [points][planes] [SI]
};

/// One tally of a monitor or a detector over the scan.
struct TallyResult {
  std::string part, part_label, name;
  bool of_monitor = false;                      // of what passed, else of what was counted
  bool asks_for_spin = false;                   // under `quantum` weights are split over the outcomes
  std::vector<TallyAxisResult> axes;            // one to three, before them `y` where there are planes
  std::vector<double> counts, counts_errors;    // [points][bins of the axes], in particles
  std::vector<double> outside, outside_errors;  // [points][planes] what crossed outside of the ranges
  std::size_t planes = 1;                       // of the monitor
};

/// One line of the ledger, over the scan.
struct FateResult {
  std::string fate;   // "detected", "stopped", "passed", "left_backwards", "gave_up"
  std::string where;  // the part's name, "chamber", or "" where it does not apply
  std::vector<std::uint64_t> quanta_high,
      quanta_low;                 // [points] exact sum in quanta of 2^-40 particle: high * 2^64 + low
  std::vector<double> particles;  // [points] the same in particles
  std::vector<double>
      by_level;  // [points][levels] of those prepared in each; NaN where a point has no ledger
};

struct Provenance {
  std::vector<std::string> arguments;
  std::vector<InputText> inputs;
  std::vector<std::string> changes;  // of them, as options: "--set", "B.field=9 mT"
  std::string start_time, end_time;  // ISO 8601 with offset
  std::string version, compiler, instruction_set, host;
  std::vector<std::string> warnings;  // one text each, its help in a further line
  int threads = 1;
  double seconds = 0;
  KeptTransit transit = KeptTransit::if_small;
  std::uint64_t max_memory = 0;       // [bytes] that the run was given; 0: none was stated
  std::uint64_t slabs = 1;            // of scan points, worked out one behind the other from one flight
  std::string commit{}, processor{};  // of the program's source; as the machine calls it
  int ranks = 1;                      // processes, each with so many threads
  bool rescanned = false;             // worked out from a flight that was kept, mostly for another scan
};

/// A parameter of the experiment as it was flown.
struct ResolvedParameter {
  std::string name, unit;      // "H0.frequency"; of SI, empty for plain numbers and words
  std::vector<double> values;  // [SI] one where all points agree, else [points]; NaN for a word, or where a
  std::vector<std::string> words;  // point has no such parameter; the same of words: one, empty, for numbers
};

/// The largest deviations of flights in steps from an independent integration, over a sample of particles.
struct FieldCheck {
  std::uint64_t particles = 0;
  double place = 0;           // over the length of the stretch
  double direction = 0;       // [rad]
  double spin = 0;            // of S, or of the image of z: that of a probability is about as large
  double levels = 0;          // of the probability of a level of an atom
  double tolerance = 0;       // that steps were chosen for
  bool approximated = false;  // levels are driven in the rotating-wave approximation, and not integrated
  double largest() const { return std::max({place, direction, spin, levels}); }
};

struct Result {
  std::string title;
  std::vector<ScanAxis> axes;
  ScanParticles particles_mode = ScanParticles::shared;
  std::vector<std::string> laws;  // "dorado (torque, kappa = 1)"; one where all points agree, else [points]
  std::vector<std::string> species;  // "neutron", or "0.5 Li-7 + 0.5 H"; likewise
  std::uint64_t particles = 0;       // per point
  std::uint64_t seed = 0;
  double solid_angle = 0;              // [sr] of an aimed source; 0 where the source is not aimed
  std::vector<double> aimed_fraction;  // [points] of all particles leaving an aimed source, what weight 1
                                       // stands for; empty where no source is aimed
  double rate = 0;                     // [1/s] particles leaving the source; 0 where it is not stated
  std::vector<double> emitted;         // [points] in particles
  std::vector<std::uint64_t> emitted_quanta_high, emitted_quanta_low;  // [points]
  std::vector<DetectorResult> detectors;
  std::vector<MonitorResult> monitors;
  std::vector<TallyResult> tallies;
  std::vector<FateResult> fates;
  std::vector<std::string> ledger_levels;  // of the ledger by prepared level; empty where there is none
  std::vector<double> emitted_by_level;    // [points][levels] in particles; NaN where a point has no ledger
  std::optional<FlightRecord> flight;      // for other scans of it, where moments serve all points
  std::optional<FieldCheck> field_check;   // where particles were flown in steps or through magnets
  std::vector<ResolvedParameter> parameters;
  Provenance provenance;
};

/// A part as pictures show it.
struct PartName {
  std::string name, kind, label;  // the label is the name where the file has none
  double begin = 0, end = 0;      // [m] along the beam
  bool field = false, drives = false;
};

/// The path of one particle, for `rabiline trace`.
struct Track {
  std::uint64_t particle = 0;
  std::string law;  // "dorado (torque, kappa = 1)"
  std::string species, fate, where;
  std::vector<double> t;           // [s]
  std::vector<double> x, y, z;     // [m]
  std::vector<double> vx, vy, vz;  // [m/s]
  /// The spin's expectation over its size, <S>/(hbar I); of an atom m_F/(I + J) along z.
  std::vector<double> sx, sy, sz;
  std::vector<double> weight;  // what filters, gas and the like have left of it, 1 at first
};

/// Paths, and what they led through.
struct Tracks {
  std::string title;
  std::vector<PartName> parts;
  std::vector<ResolvedParameter> parameters;
  std::vector<Track> paths;
};

}  // namespace rabiline
