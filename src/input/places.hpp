#pragma once
// Where a file states what: the way from a fault to the line that has it.
#include <map>
#include <string>

#include "core/diagnostics.hpp"
#include "core/fault.hpp"
#include "input/document.hpp"

namespace rabiline {

/// Dotted names and their places in the text. Parts go by their names, by `parts[3]` too, and a species that
/// is written alone by `species[0]`.
class Places {
 public:
  Places() = default;
  explicit Places(const Node& root);

  /// The value of a key, or the key where its value is a list or a mapping; of one that is not written the
  /// nearest that encloses it.
  const Place& of(std::string dotted_name) const;
  Diagnostic locate(const Fault&) const;

 private:
  void add(const Node&, const Place&, const std::string& name);

  std::map<std::string, Place> places_;  // the whole file by the empty name
};

}  // namespace rabiline
