// Tallies that cannot be counted, and results that would have the same name.
#include <algorithm>
#include <cmath>

#include "input/check_nodes.hpp"
#include "input/checks.hpp"
#include "plan/tally_plan.hpp"

namespace rabiline {
namespace {

const std::vector<Tally>* tallies_of(const Part& part) {
  if (const auto* detector = std::get_if<Detector>(&part)) return &detector->tallies;
  if (const auto* monitor = std::get_if<Monitor>(&part)) return &monitor->tallies;
  return nullptr;
}

/// The tree behind a tally of a part.
const Node* node_of(const PartNodes& nodes, const PlacedPart& part, std::size_t number) {
  const Node* node = nodes.find(part.placement.name);
  const Entry* list = node ? node->find("tallies") : nullptr;
  return list && number < list->value.items.size() ? &list->value.items[number] : nullptr;
}
const Node& axis_node(const Node& tally, std::size_t number) {
  return tally.find("axes")->value.items[number];
}
/// Where an axis says what it is over.
const Place& quantity_place(const Node& axis) { return place_of(axis, "quantity"); }

int levels_of(const Beamline& beamline) { return beamline.species.front().species.levels(); }

void check_axes(const Tally& tally, const Node& node, Reading& reading) {
  if (tally.axes.size() > most_tally_axes)
    reading.error(
        quantity_place(axis_node(node, most_tally_axes)),
        fmt::format("the tally `{}` has {} axes, and three are the most", tally.name, tally.axes.size()),
        "make two tallies of it");
  for (std::size_t i = 0; i < tally.axes.size(); ++i)
    for (std::size_t k = 0; k < i; ++k)
      if (tally.axes[i].quantity == tally.axes[k].quantity && tally.axes[i].axis == tally.axes[k].axis) {
        reading.error(
            quantity_place(axis_node(node, i)),
            fmt::format("the tally `{}` has two axes over `{}`", tally.name, word_of(tally.axes[i].quantity)),
            "keep one of them");
        break;
      }
}

std::uint64_t planes_of(const Part& part) {
  const auto* monitor = std::get_if<Monitor>(&part);
  return monitor ? monitor->planes : 1;
}

void check_size(const Tally& tally, const Node& node, int levels, std::uint64_t planes, Reading& reading) {
  const std::uint64_t bins = bins_of(tally, levels);
  if (tally.axes.size() > 1 && bins > most_tally_bins)
    reading.error(node.find("axes")->key_place,
                  fmt::format("the tally `{}` has {} bins in all, and {} are the most", tally.name, bins,
                              most_tally_bins),
                  "give its axes fewer bins, or make several tallies of it");
  else if (bins * planes > most_tally_bins)
    reading.error(node.find("axes")->key_place,
                  fmt::format("the tally `{}` has {} bins in each of {} planes, and {} in all are the most",
                              tally.name, bins, planes, most_tally_bins),
                  "give its axes fewer bins, or the monitor fewer planes");
}

/// A length without planes, planes without a length, or an axis that the planes are already.
void check_planes(const PlacedPart& part, const PartNodes& nodes, Reading& reading) {
  const auto* monitor = std::get_if<Monitor>(&part.part);
  if (!monitor) return;
  if (monitor->planes > 1 && monitor->length == 0)
    reading.error(
        place_in(nodes, part, "planes"),
        fmt::format("`{}` has {} planes and no length to stand on", part.placement.name, monitor->planes),
        "write for example `length: 0.2 m`, from the first plane to the last");
  if (monitor->planes == 1 && monitor->length > 0)
    reading.error(place_in(nodes, part, "length"),
                  fmt::format("`{}` has a length and one plane only", part.placement.name),
                  "write for example `planes: 101`, or leave `length` away");
  for (std::size_t i = 0; monitor->planes > 1 && i < monitor->tallies.size(); ++i)
    for (std::size_t k = 0; k < monitor->tallies[i].axes.size(); ++k)
      if (const Node* node = node_of(nodes, part, i);
          node && monitor->tallies[i].axes[k].quantity == Quantity::y)
        reading.error(quantity_place(axis_node(*node, k)),
                      fmt::format("`{}` has {} planes, which are the first axis of its tallies, `y`",
                                  part.placement.name, monitor->planes),
                      "leave this axis away");
}

/// Under `quantum` a spin has outcomes and no direction.
void check_angles(const Beamline& beamline, const Tally& tally, const Node& node, Reading& reading) {
  if (!std::holds_alternative<QuantumLaw>(beamline.law)) return;
  for (std::size_t i = 0; i < tally.axes.size(); ++i)
    if (is_of_vector_spin(tally.axes[i].quantity))
      reading.error(
          quantity_place(axis_node(node, i)),
          fmt::format("`{}` is an angle of a spin that is a vector, but under the law quantum "
                      "measuring a spin has outcomes",
                      word_of(tally.axes[i].quantity)),
          "tally the outcomes along an axis, `{quantity: spin, axis: z, from: -1, to: 1, bins: 2}`, "
          "or use the law classical");
}

/// Whether the levels have the same names.
bool has_same_levels(const Species& a, const Species& b) {
  if (a.spin != b.spin || a.structure.has_value() != b.structure.has_value()) return false;
  return !a.structure || a.structure->i == b.structure->i;
}

/// Levels are those of the law `quantum`, and of one spin.
void check_levels(const Beamline& beamline, const Tally& tally, const Node& node, Reading& reading) {
  const bool quantum = std::holds_alternative<QuantumLaw>(beamline.law);
  for (std::size_t i = 0; i < tally.axes.size(); ++i) {
    const Quantity quantity = tally.axes[i].quantity;
    if (!is_categorical(quantity)) continue;
    if (!quantum)
      reading.error(quantity_place(axis_node(node, i)),
                    fmt::format("`{}` counts the levels of the law quantum, but the law is {}",
                                word_of(quantity), describe(beamline.law)),
                    "a spin that is a vector has a projection: "
                    "`{quantity: spin, axis: z, from: -1, to: 1, bins: 20}`");
    for (const Component& component : beamline.species)
      if (quantum && !has_same_levels(component.species, beamline.species.front().species)) {
        reading.error(
            quantity_place(axis_node(node, i)),
            fmt::format("`{}` cannot have bins for the levels of both `{}` and `{}`, whose spins "
                        "differ",
                        word_of(quantity), beamline.species.front().species.name, component.species.name),
            component.species.structure || beamline.species.front().species.structure
                ? "fly one of them at a time"
                : "tally `spin` along `axis: z`, in units of I, or fly one of them at a time");
        break;
      }
  }
}

/// Under `quantum` a measurement is along one direction.
void check_directions(const Beamline& beamline, const Tally& tally, const Node& node, Reading& reading) {
  if (!std::holds_alternative<QuantumLaw>(beamline.law)) return;
  const TallyAxis* first = nullptr;
  for (std::size_t i = 0; i < tally.axes.size(); ++i) {
    const TallyAxis& axis = tally.axes[i];
    if (!asks_for_spin(axis.quantity)) continue;
    if (first && axis.axis.value_or(UnitVector{}) != first->axis.value_or(UnitVector{}))
      reading.error(quantity_place(axis_node(node, i)),
                    fmt::format("the tally `{}` measures the spin along two directions at once, which no "
                                "measurement can under the law quantum",
                                tally.name),
                    "make two tallies of it");
    if (!first) first = &axis;
  }
}

void check_tally_names(const PlacedPart& part, const std::vector<Tally>& tallies, const PartNodes& nodes,
                       Reading& reading) {
  for (std::size_t i = 0; i < tallies.size(); ++i) {
    const Node* node = node_of(nodes, part, i);
    if (!node) continue;
    const Place& place = place_of(*node, "name");
    if (!is_well_formed("a" + tallies[i].name))
      reading.error(place,
                    fmt::format("`{}` cannot be a tally's name: a name is letters, digits or `_`, at most 63",
                                tallies[i].name),
                    "results call it by the part's name, `_` and this name");
    else if (const std::string name = part.placement.name + "_" + tallies[i].name; is_reserved(name))
      reading.error(place,
                    fmt::format("this tally would be called `{}`, which means something else in the "
                                "results",
                                name),
                    "choose another name");
  }
}

/// Groups of the results, each with who has them.
struct Claim {
  std::string name, owner;
  const Place* place;
  enum { own_name, histogram, tally } kind;
};

std::vector<Claim> claims_of(const Beamline& beamline, const PartNodes& nodes) {
  std::vector<Claim> claims;
  for (const PlacedPart& part : beamline.parts) {
    const std::string& name = part.placement.name;
    const std::vector<Tally>* tallies = tallies_of(part.part);
    if (!tallies || !nodes.find(name)) continue;
    const Place& place = place_in(nodes, part, "name");
    const bool detector = std::holds_alternative<Detector>(part.part);
    const std::string owner = fmt::format("the {} `{}`", detector ? "detector" : "monitor", name);
    claims.push_back({name, owner, &place, Claim::own_name});
    if (detector)
      for (const std::string_view ending : {"_x", "_z", "_levels"})
        claims.push_back({name + std::string(ending), owner, &place, Claim::histogram});
    for (std::size_t i = 0; i < tallies->size(); ++i)
      if (const Node* node = node_of(nodes, part, i))
        claims.push_back({name + "_" + (*tallies)[i].name,
                          fmt::format("the tally `{}` of `{}`", (*tallies)[i].name, name),
                          &place_of(*node, "name"), Claim::tally});
  }
  return claims;
}

void check_result_names(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const std::vector<Claim> claims = claims_of(beamline, nodes);
  for (std::size_t i = 0; i < claims.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Claim *blamed = &claims[i], *other = &claims[k];
      if (blamed->name != other->name) continue;
      if (blamed->kind == Claim::own_name && other->kind == Claim::own_name) continue;  // names differ anyway
      if (other->kind == Claim::tally && blamed->kind == Claim::histogram) std::swap(blamed, other);
      if (blamed->kind == Claim::histogram) std::swap(blamed, other);
      reading.error(*blamed->place,
                    fmt::format("{} keeps results under the name `{}`{}", other->owner, other->name,
                                blamed->kind == Claim::tally ? ", as this tally would" : ""),
                    "choose another name");
    }
}

}  // namespace

void check_tallies(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  check_result_names(beamline, nodes, reading);
  if (beamline.species.empty()) return;
  for (const PlacedPart& part : beamline.parts) {
    const std::vector<Tally>* tallies = tallies_of(part.part);
    if (!tallies) continue;
    check_planes(part, nodes, reading);
    check_tally_names(part, *tallies, nodes, reading);
    for (std::size_t i = 0; i < tallies->size(); ++i) {
      const Node* node = node_of(nodes, part, i);
      if (!node) continue;
      check_axes((*tallies)[i], *node, reading);
      check_size((*tallies)[i], *node, levels_of(beamline), planes_of(part.part), reading);
      check_levels(beamline, (*tallies)[i], *node, reading);
      check_directions(beamline, (*tallies)[i], *node, reading);
      check_angles(beamline, (*tallies)[i], *node, reading);
    }
  }
}

/// All points count in the same planes, which are an axis of the results.
bool check_scanned_planes(const Axis& axis, const std::vector<Beamline>& points, Reading& reading) {
  for (const Beamline& point : points)
    for (const PlacedPart& now : point.parts) {
      const auto* monitor = std::get_if<Monitor>(&now.part);
      if (!monitor) continue;
      // Parts stand in the order of their places, which a scan may change.
      const auto first =
          std::find_if(points.front().parts.begin(), points.front().parts.end(),
                       [&](const auto& part) { return part.placement.name == now.placement.name; });
      const auto& then = std::get<Monitor>(first->part);
      if (monitor->planes == 1 && then.planes == 1) continue;
      if (monitor->planes == then.planes && monitor->length == then.length &&
          now.placement.at == first->placement.at)
        continue;
      reading.error(axis.place,
                    fmt::format("`{}` cannot be scanned: all points count in the same planes of `{}`",
                                axis.parameter, now.placement.name),
                    "make one run for each");
      return false;
    }
  return true;
}

void check_scanned_tallies(const Axis& axis, const std::vector<Beamline>& points, Reading& reading) {
  if (!check_scanned_planes(axis, points, reading)) return;
  static constexpr std::uint64_t most_bins = 100'000'000;
  for (const PlacedPart& part : points.front().parts) {
    const std::vector<Tally>* first = tallies_of(part.part);
    if (!first || first->empty()) continue;
    std::uint64_t bins = 0;
    bool levels = false;
    for (const Tally& tally : *first) {
      bins += bins_of(tally, levels_of(points.front())) * planes_of(part.part);
      for (const TallyAxis& a : tally.axes) levels = levels || is_categorical(a.quantity);
    }
    if (bins * points.size() > most_bins)
      return reading.error(
          axis.place,
          fmt::format("the tallies of `{}` have {} bins at each of {} scan points: {} in all, and {} are the "
                      "most",
                      part.placement.name, bins, points.size(), bins * points.size(), most_bins),
          "scan fewer points, or give the axes fewer bins");
    for (const Beamline& point : points) {
      if (levels && !has_same_levels(point.species.front().species, points.front().species.front().species))
        return reading.error(axis.place,
                             fmt::format("`{}` cannot be scanned: a tally of `{}` counts levels, and the "
                                         "spins at the scan points differ",
                                         axis.parameter, part.placement.name),
                             "make one run for each spin, or tally `spin` instead, in units of I");
      for (const PlacedPart& now : point.parts)
        if (now.placement.name == part.placement.name && *tallies_of(now.part) != *first)
          return reading.error(axis.place,
                               fmt::format("`{}` cannot be scanned: all points fill the same tallies of `{}`",
                                           axis.parameter, part.placement.name),
                               "make one run for each");
    }
  }
}

}  // namespace rabiline
