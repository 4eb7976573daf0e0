#pragma once
// The registry of parts: one line per kind.
#include <variant>

#include "parts/beam_stop.hpp"
#include "parts/chopper.hpp"
#include "parts/coil.hpp"
#include "parts/coil_pair.hpp"
#include "parts/collimator.hpp"
#include "parts/current_loop.hpp"
#include "parts/current_sheet.hpp"
#include "parts/detector.hpp"
#include "parts/electric_field.hpp"
#include "parts/formula_field.hpp"
#include "parts/gas_cell.hpp"
#include "parts/gradient_magnet.hpp"
#include "parts/guide_field.hpp"
#include "parts/iron_magnet.hpp"
#include "parts/mapped_field.hpp"
#include "parts/monitor.hpp"
#include "parts/multipole_field.hpp"
#include "parts/multipole_magnet.hpp"
#include "parts/oscillating_field.hpp"
#include "parts/polarizer.hpp"
#include "parts/rotating_field.hpp"
#include "parts/slit.hpp"
#include "parts/solenoid.hpp"
#include "parts/spin_filter.hpp"
#include "parts/straight_wire.hpp"
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
                          CurrentLoop,       //
                          Solenoid,          //
                          CoilPair,          //
                          StraightWire,      //
                          CurrentSheet,      //
                          MultipoleField,    //
                          ElectricField,     //
                          MappedField,       //
                          FormulaField,      //
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

struct PlacedPart {
  Placement placement;
  Part part;
  bool operator==(const PlacedPart&) const = default;
};

PartTraits traits_of(const Part&);
/// "rotating_field".
std::string_view kind_of(const Part&);
/// How far it reaches along the beam [m]: 0 of a plane.
double extent_of(const Part&);
inline double end_of(const PlacedPart& part) { return part.placement.at + extent_of(part.part); }
/// Whether it deflects by the gradient of its field.
inline bool is_magnet(const Part& part) { return traits_of(part).deflects; }

/// The screen or the monitor that a part is, else null.
inline const Detector* detector_in(const Part& part) { return std::get_if<Detector>(&part); }
inline const Monitor* monitor_in(const Part& part) { return std::get_if<Monitor>(&part); }
/// What a part tallies, null where it cannot, and in how many planes.
const std::vector<Tally>* tallies_of(const Part&);
std::uint64_t planes_of(const Part&);

/// What a part has across the beam: its hole, or the face of a screen.
struct Across {
  Opening opening;
  Offset offset;
  Roll tilt;
};
/// None of fields, and of what lets pass all that misses it.
std::optional<Across> across_of(const Part&);
/// The name of the part whose clock it follows; null where it has no clock, or one of its own.
const std::string* clock_of(const Part&);

/// None of fields with a clock, and of magnets that point elsewhere from place to place.
std::optional<StaticField> static_field_of(const Part&);
/// Whether its field is an electric one.
bool is_electric(const Part&);
/// Whether any static magnetic field acts there on spins.
bool holds_spins(const Part&);

/// What is wrong with a part, whatever stands beside it.
std::vector<Fault> faults_of(const PlacedPart&);

}  // namespace rabiline
