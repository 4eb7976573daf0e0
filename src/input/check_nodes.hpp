#pragma once
// What the checks of a whole beamline share: the tree behind the parts, for names and places in the text.
#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "beamline/beamline.hpp"
#include "input/reader.hpp"
#include "input/scan.hpp"
#include "transport/stage.hpp"

namespace rabiline {

/// The tree behind the parts: names and places in the text.
class PartNodes {
 public:
  explicit PartNodes(const Node& root) {
    const Entry* parts = root.find("parts");
    if (!parts) return;
    for (const Node& item : parts->value.items) {
      const Entry* name = item.find("name");
      if (name && name->value.is_scalar()) named_.push_back(&item);
    }
  }
  const std::vector<const Node*>& all() const { return named_; }
  const Node* find(std::string_view name) const {
    for (const Node* node : named_)
      if (name_of(*node) == name) return node;
    return nullptr;
  }
  std::vector<std::string> names(std::initializer_list<std::string_view> kinds) const {
    std::vector<std::string> out;
    for (const Node* node : named_)
      if (std::find(kinds.begin(), kinds.end(), kind_of(*node)) != kinds.end()) out.push_back(name_of(*node));
    return out;
  }
  static const std::string& name_of(const Node& part) { return part.find("name")->value.scalar; }
  static std::string kind_of(const Node& part) {
    const Entry* kind = part.find("kind");
    return kind ? kind->value.scalar : "part";
  }

 private:
  std::vector<const Node*> named_;
};

inline std::string suggest_name(std::string_view wrong, const std::vector<std::string>& known) {
  const std::string near = closest(wrong, known);
  if (!near.empty()) return fmt::format("did you mean `{}`?", near);
  std::string out;
  for (const std::string& name : known) out += fmt::format("{}`{}`", out.empty() ? "there is " : ", ", name);
  return out;
}

/// The place of a part's key, or of the part where it is not given.
inline const Place& place_in(const PartNodes& nodes, const PlacedPart& part, std::string_view key) {
  static const Place nowhere;
  const Node* node = nodes.find(part.placement.name);
  return node ? place_of(*node, key) : nowhere;
}

/// Whether it is a stage of its own, which can be passed in one direction only.
inline bool is_own_stage(const Part& part) {
  return std::visit([](const auto& p) { return requires(const StageSite& site) { stage_of(p, site); }; }, part);
}

inline bool is_field(const Part& part) {
  if (is_own_stage(part)) return false;
  return std::visit(
      [](const auto& p) {
        return requires { p.length; }
        &&!std::is_same_v<std::decay_t<decltype(p)>, Collimator> &&
            !std::is_same_v<std::decay_t<decltype(p)>, Monitor>;
      },
      part);
}

inline double end_of(const PlacedPart& part) {
  return part.placement.at + std::visit(
                                 [](const auto& any) {
                                   if constexpr (requires { any.length; }) return any.length;
                                   return 0.0;
                                 },
                                 part.part);
}

inline std::string metres(double y) { return pretty_quantity(y, Dimension::length); }

// One file for each; all report into the Reading.
void check_fields(const Beamline&, const PartNodes&, Reading&);
void check_magnets(const Beamline&, const PartNodes&, Reading&);
void check_atoms(const Beamline&, const Node& root, const PartNodes&, Reading&);
void check_detectors(const Beamline&, const Node& root, const PartNodes&, Reading&);
void check_source(const Beamline&, const Node& root, const PartNodes&, Reading&);
void check_tallies(const Beamline&, const PartNodes&, Reading&);
/// Tallies that not all points of a scan can fill.
void check_scanned_tallies(const Axis&, const std::vector<Beamline>& points, Reading&);

/// Whether a name is a letter, then letters, digits or `_`, at most 64.
bool is_well_formed(std::string_view name);

}  // namespace rabiline
