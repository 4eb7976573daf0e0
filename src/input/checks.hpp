#pragma once
// Rules that hold between the keys and parts of a beamline, after each was read for itself.
#include "beamline/beamline.hpp"
#include "input/document.hpp"
#include "input/scan.hpp"
#include "input/values.hpp"

namespace rabiline {

/// `beamline` holds the parts of `root` that could be read; rules about names look at all of them.
void check_beamline(const Beamline& beamline, const Node& root, Reading&);

/// What may not change along an axis of a scan; `points` are the beamline at each of its values.
void check_axis(const Axis&, const std::vector<Beamline>& points, Reading&);

/// Words that a part may not be called, because dotted names or results mean something else by them.
bool is_reserved(std::string_view name);

}  // namespace rabiline
