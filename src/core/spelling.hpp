#pragma once
// Numbers as they are written elsewhere.
#include <string>
#include <string_view>

namespace rabiline {

/// The text with a plain minus for each typographic one, U+2212.
std::string with_plain_minus(std::string_view);
/// "90 deg" for `pi/2`, `0.5 pi` or `π/2 rad`; empty where it is no such angle.
std::string degrees_of_pi(std::string_view);
/// "kHz" of `280 kHz`; empty where no unit is written.
std::string unit_in(std::string_view quantity);
/// "6834682610 Hz" for `6.834.682.610 Hz`, `6 834 682 610 Hz`, `6'834'682'610 Hz` or `6_834_682_610 Hz`.
std::string without_thousands(std::string_view quantity);
/// Whether it is a number such as `20.000`, which is 20, and 20000 where a point stands between thousands.
bool has_point_before_thousands(std::string_view number);

}  // namespace rabiline
