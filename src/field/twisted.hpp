#pragma once
#include "field/field_here.hpp"

namespace rabiline {

/// A field of one size whose direction turns along y, from `first` at y = 0 towards `second`, which is
/// perpendicular to it.
struct TwistedShape {
  double first[3], second[3];  // [T]
  double rate;                 // [rad/m]
  bool operator==(const TwistedShape&) const = default;
};

/// B = first cos(k y) + second sin(k y)
template <class Maths, class Number>
[[gnu::always_inline]] inline FieldHere<Number> field_of(const TwistedShape& twisted, Number /*x*/, Number y,
                                                         Number z) {
  const Number none = z - z;
  Number sine, cosine;
  Maths::sine_and_cosine(twisted.rate * y, sine, cosine);
  FieldHere<Number> here;
  for (int i = 0; i < 3; ++i) {
    here.field[i] = twisted.first[i] * cosine + twisted.second[i] * sine;
    here.slope[3 * i + 1] = twisted.rate * (twisted.second[i] * cosine - twisted.first[i] * sine);
    here.slope[3 * i] = here.slope[3 * i + 2] = none;
  }
  return here;
}

}  // namespace rabiline
