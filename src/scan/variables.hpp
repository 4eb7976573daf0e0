#pragma once
// `variables` at the top of a file: values with a name, put where `${name}` stands.
#include "input/document.hpp"
#include "input/values.hpp"

namespace rabiline {

/// Puts the values of the file's variables in place, everywhere in the tree but in `variables` itself; false
/// where one is missing or has no value.
bool put_variables(Node& root, Reading&);
/// A warning of each one that stands nowhere.
std::vector<Diagnostic> unused_variables(const Node& root);

}  // namespace rabiline
