#pragma once
// Screens whose counts no spin can change.
#include <string>

#include "beamline/experiment.hpp"

namespace rabiline {

/// A line for people where the scan turns spins alone and nothing in front of the screens sorts them, so that
/// all of its points count alike; else nothing. Levels at a screen are seen all the same.
std::string note_on_blind_screens(const Experiment&);

}  // namespace rabiline
