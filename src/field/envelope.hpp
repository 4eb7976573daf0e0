#pragma once
// Plain, because kernels of every instruction set read it.

namespace rabiline {

enum class Shape { rectangular, half_sine, gaussian };

/// How the size of a field runs along the beam, as a share of its highest: 1, sin(pi (y - begin)/length), or
/// exp(-((y - middle)/sigma)^2/2).
struct Envelope {
  Shape shape = Shape::rectangular;
  double begin = 0, length = 0;  // [m] of the whole field, whose middle is begin + length/2
  double sigma = 0;              // [m] of a gaussian
  bool operator==(const Envelope&) const = default;
};

}  // namespace rabiline
