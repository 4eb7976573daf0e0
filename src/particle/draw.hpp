#pragma once
// How kernels draw speeds and directions: numbers that the laws work out once for each species. Plain,
// because kernels of every instruction set read it.

namespace rabiline {

inline constexpr double farthest_normal = 8.6;  // [sigma] no normal is drawn beyond: sqrt(-2 ln 2^-53) = 8.57

/// A density that is linear between points, or a few discrete values, to draw from (particle/law_tables.hpp).
/// All columns have cells + 1 entries but `guide`. Compared by address: a plan makes each table once.
struct SampledLaw {
  const double* at = nullptr;
  const double* density = nullptr;     // null: the discrete values `at`, one for each cell
  const double* cumulative = nullptr;  // from 0 to 1
  const int* guide = nullptr;          // [guides] the first cell that reaches a share k/guides of all
  int cells = 0;
  static constexpr int guides = 1024;
  bool operator==(const SampledLaw&) const = default;
};

enum class SpeedKind { single, gaussian, effusive, maxwell, sampled };
/// How a drawn number q becomes a speed: factor q, factor/q (a wavelength) or sqrt(factor q) (an energy).
enum class SpeedScale { proportional, inverse, root };
struct SpeedDraw {
  double mean = 0;  // [m/s] of the distribution; the speed of `single`
  SpeedKind kind = SpeedKind::single;
  double centre = 0, sigma = 0, least = 0;  // (gaussian) numbers that are not above the least are drawn again
  SampledLaw table{};                       // (sampled)
  SpeedScale scale = SpeedScale::proportional;
  double factor = 1;  // that of SpeedScale
  bool operator==(const SpeedDraw&) const = default;
};

/// j(theta) of a channel, between points of equal distance in p = tan(theta)/edge and, beyond p = 1, in 1/p.
struct ChannelShape {
  const double *inside = nullptr, *outside = nullptr;  // [cells + 1]
  int cells = 0;
  double edge = 1;  // tan(theta) where p = 1
  bool operator==(const ChannelShape&) const = default;
};

enum class DirectionKind { parallel, gaussian, cone, aimed, cosine, box, channel };
enum class AimedLaw { isotropic, cosine, channel };
struct DirectionDraw {
  DirectionKind kind = DirectionKind::parallel;
  double spread_x = 0, spread_z = 0;  // slopes (gaussian, box); in spread_x 1 - cos(half angle) (cone) or
                                      // sin^2(half angle) (cosine)
  SampledLaw angles{};                // of theta (channel)
  AimedLaw aimed_law = AimedLaw::isotropic;
  ChannelShape channel{};  // (aimed from a channel)
  bool operator==(const DirectionDraw&) const = default;
};

enum class PulseKind { none, rectangle, gaussian };
struct PulseDraw {
  PulseKind kind = PulseKind::none;
  double width = 0;  // [s] length; sigma (gaussian)
  bool operator==(const PulseDraw&) const = default;
};

}  // namespace rabiline
