#pragma once
// The registry of parts: one line per kind.
#include <variant>

#include "parts/detector.hpp"
#include "parts/monitor.hpp"
#include "parts/polarizer.hpp"
#include "parts/rotating_field.hpp"
#include "parts/slit.hpp"
#include "parts/uniform_field.hpp"

namespace rabiline {

using Part = std::variant<Polarizer,      //
                          UniformField,   //
                          RotatingField,  //
                          Slit,           //
                          Detector,       //
                          Monitor>;

struct PlacedPart {
  Placement placement;
  Part part;
  bool operator==(const PlacedPart&) const = default;
};

}  // namespace rabiline
