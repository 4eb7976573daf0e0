#pragma once
// Plain, because kernels of every instruction set read it.

namespace rabiline {

enum class Shape { rectangular, half_sine, gaussian, standing_wave };

/// How the size of a field runs along the beam, as a share of its highest: 1, sin(pi (y - begin)/length),
/// exp(-((y - middle)/sigma)^2/2), or sin or cos of half_waves pi (y - begin)/length.
struct Envelope {
  Shape shape = Shape::rectangular;
  double begin = 0, length = 0;  // [m] of the whole field, whose middle is begin + length/2
  double sigma = 0;              // [m] of a gaussian
  double half_waves = 1;         // of a standing wave
  bool is_cosine = false;        // a standing wave with antinodes at its ends
  bool operator==(const Envelope&) const = default;
};

/// A frequency that changes evenly from one moment to another one, and not before or behind:
/// d omega/dt = rate there.
struct Sweep {
  double rate = 0;            // [Hz/s]; [rad/s^2] as a species sees it
  double begin = 0, end = 0;  // [s]
  bool operator==(const Sweep&) const = default;
};

/// When a field is on: from begin to end, and again after each period, so many times in all.
struct Gate {
  double begin = 0, end = 0;  // [s]; always where they are equal
  double period = 0;          // [s] not shorter than end - begin, unless times is 1
  double times = 1;
  bool operator==(const Gate&) const = default;
};

/// How a field differs across the beam: its phase is more by phase . (r - centre), its size is multiplied by
/// 1 + size . (r - centre).
struct Slopes {
  double phase_x = 0, phase_z = 0;  // [rad/m]
  double size_x = 0, size_z = 0;    // [1/m]
  double x = 0, z = 0;              // [m] the centre
  bool operator==(const Slopes&) const = default;
};

}  // namespace rabiline
