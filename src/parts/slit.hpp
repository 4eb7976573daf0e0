#pragma once
#include "parts/placement.hpp"

namespace rabiline {

class SectionBuilder;

/// A plate of no thickness with one opening: what misses the opening stops there.
struct Slit {
  static constexpr std::string_view kind = "slit",
                                    meaning = "a thin plate with a rectangular or round opening";
  Opening opening;
  Offset offset;
  bool operator==(const Slit&) const = default;
};
template <>
inline constexpr auto parameters<Slit> = std::tuple{
    param("", &Slit::opening, "the hole: width and height, or radius"),  // its keys stand beside `at`
    param("offset", &Slit::offset, "displacement of the opening's centre from the axis", Offset{}),
};

void contribute(const Slit&, const Placement&, SectionBuilder&);

}  // namespace rabiline
