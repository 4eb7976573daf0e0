#pragma once
// The registry of parts: one line per kind.
#include <variant>

#include "parts/beam_stop.hpp"
#include "parts/coil.hpp"
#include "parts/chopper.hpp"
#include "parts/collimator.hpp"
#include "parts/detector.hpp"
#include "parts/gas_cell.hpp"
#include "parts/gradient_magnet.hpp"
#include "parts/guide_field.hpp"
#include "parts/iron_magnet.hpp"
#include "parts/monitor.hpp"
#include "parts/multipole_magnet.hpp"
#include "parts/oscillating_field.hpp"
#include "parts/polarizer.hpp"
#include "parts/rotating_field.hpp"
#include "parts/slit.hpp"
#include "parts/spin_filter.hpp"
#include "parts/two_wire_magnet.hpp"
#include "parts/uniform_field.hpp"
#include "parts/velocity_selector.hpp"

namespace rabiline {

using Part = std::variant<Polarizer,         //
                          SpinFilter,        //
                          UniformField,      //
                          GuideField,        //
                          RotatingField,     //
                          OscillatingField,  //
                          Coil,              //
                          GradientMagnet,    //
                          TwoWireMagnet,     //
                          IronMagnet,        //
                          MultipoleMagnet,   //
                          Slit,              //
                          Collimator,        //
                          BeamStop,          //
                          GasCell,           //
                          Chopper,           //
                          VelocitySelector,  //
                          Detector,          //
                          Monitor>;

/// Whether it deflects by the gradient of its field.
inline bool is_magnet(const Part& part) {
  return std::holds_alternative<GradientMagnet>(part) || std::holds_alternative<TwoWireMagnet>(part) ||
         std::holds_alternative<IronMagnet>(part) || std::holds_alternative<MultipoleMagnet>(part);
}

struct PlacedPart {
  Placement placement;
  Part part;
  bool operator==(const PlacedPart&) const = default;
};

}  // namespace rabiline
