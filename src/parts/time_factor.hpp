#pragma once
// Fields that swing as a whole.
#include <optional>

#include "parts/phase.hpp"
#include "parts/placement.hpp"
#include "section/section_builder.hpp"

namespace rabiline {

/// cos(2 pi f t + phase), t the time in the laboratory from a particle's emission, or a pulse's t = 0, on.
struct TimeFactor {
  static constexpr std::string_view example = "frequency: 10 kHz, phase: random";
  double frequency = 0;  // [Hz]
  Phase phase;
  bool operator==(const TimeFactor&) const = default;
};
template <>
inline constexpr auto parameters<TimeFactor> = std::tuple{
    param("frequency", &TimeFactor::frequency, Dimension::frequency, range::positive, "periods per second"),
    param("phase", &TimeFactor::phase, "phase at emission: random, locked (zero) or an angle"),
};

inline std::optional<Oscillator> clock_of(const std::optional<TimeFactor>& oscillates) {
  if (!oscillates) return std::nullopt;
  return Oscillator{.frequency = oscillates->frequency,
                    .phase = oscillates->phase.angle,
                    .random_phase = oscillates->phase.kind == Phase::Kind::random};
}
/// A field that stands, or swings.
inline void add_shaped(const std::optional<Oscillator>& clock, double begin, double end,
                       const ShapedTerm& term, SectionBuilder& builder) {
  clock ? builder.swinging(begin, end, term, *clock) : builder.shaped(begin, end, term);
}

}  // namespace rabiline
