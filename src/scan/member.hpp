#pragma once
// A parameter of a struct by its dotted name, through the tables.
#include <span>
#include <string>

#include "beamline/beamline.hpp"
#include "input/reader.hpp"

namespace rabiline {

using Path = std::span<const std::string>;  // the words of a dotted name

/// Calls f(row, member) for the member that a path leads to; false where the value as it stands has none.
template <class T, class F>
bool visit_member(T& value, Path path, F& f) {
  if constexpr (is_optional<T>)
    return value && visit_member(*value, path, f);
  else if constexpr (is_variant<T>)
    return std::visit([&](auto& any) { return visit_member(any, path, f); }, value);
  else if constexpr (has_table<T>) {
    bool found = false;
    for_each_row<T>([&](const auto& p) {
      if (found) return;
      auto& member = value.*p.member;
      if (p.key.empty())
        found = visit_member(member, path, f);
      else if (p.key == path.front() && path.size() > 1)
        found = visit_member(member, path.subspan(1), f);
      else if (p.key == path.front()) {
        f(p, member);
        found = true;
      }
    });
    return found;
  } else
    return false;
}

/// A part is found by its name; everything else by its key.
template <class F>
bool visit_parameter(Beamline& beamline, Path path, F& f) {
  for (PlacedPart& part : beamline.parts)
    if (part.placement.name == path.front())
      return path.size() > 1 && (visit_member(part.placement, path.subspan(1), f) ||
                                 visit_member(part.part, path.subspan(1), f));
  return visit_member(beamline, path, f);
}
template <class File, class F>
bool visit_parameter(File& file, Path path, F& f) {
  return visit_member(file, path, f);
}

}  // namespace rabiline
