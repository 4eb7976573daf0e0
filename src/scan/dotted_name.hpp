#pragma once
// Dotted names such as `H0.frequency` and `law`: the same for --set, --scan and `scan`.
#include <string>

#include "input/document.hpp"
#include "input/values.hpp"

namespace rabiline {

/// Puts a value where a dotted name points to and gives back the node that holds it now. Short forms on the
/// way are written out (`law: dorado` becomes `law: {name: dorado}`), and keys that the file leaves to their
/// default are added; whether such a key exists shows when the tree is read. nullptr and an error where it
/// cannot be.
Node* put_value(Node& root, const std::string& name, const Place& name_place, const Node& value, Reading&);

/// Whether one name is the other, or a part of what it names: `law` and `law.kappa`.
bool names_overlap(const std::string& a, const std::string& b);

}  // namespace rabiline
