#include "input/checks.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace rabiline {
namespace {

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

std::string suggest_name(std::string_view wrong, const std::vector<std::string>& known) {
  const std::string near = closest(wrong, known);
  if (!near.empty()) return fmt::format("did you mean `{}`?", near);
  std::string out;
  for (const std::string& name : known) out += fmt::format("{}`{}`", out.empty() ? "there is " : ", ", name);
  return out;
}

/// The place of a part's key, or of the part where it is not given.
const Place& place_in(const PartNodes& nodes, const PlacedPart& part, std::string_view key) {
  static const Place nowhere;
  const Node* node = nodes.find(part.placement.name);
  return node ? place_of(*node, key) : nowhere;
}

bool is_field(const Part& part) {
  return std::visit(
      [](const auto& p) {
        return requires { p.length; };
      },
      part);
}

std::string metres(double y) { return pretty_quantity(y, Dimension::length); }

bool is_well_formed(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && name.size() <= 64 && letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

void check_names(const PartNodes& nodes, Reading& reading) {
  for (std::size_t i = 0; i < nodes.all().size(); ++i) {
    const Node& part = *nodes.all()[i];
    const std::string& name = PartNodes::name_of(part);
    const Place& place = place_of(part, "name");
    if (!is_well_formed(name))
      reading.error(
          place,
          fmt::format(
              "`{}` cannot be a part's name: a name is a letter, then letters, digits or `_`, at most 64",
              name),
          "`label` may hold any text for plots");
    else if (is_reserved(name))
      reading.error(
          place,
          fmt::format("a part cannot be called `{}`: the word means something else in files and results",
                      name),
          fmt::format("call it `{}_1`", name));
    for (std::size_t k = 0; k < i; ++k)
      if (PartNodes::name_of(*nodes.all()[k]) == name) {
        const Place& first = place_of(*nodes.all()[k], "name");
        const bool elsewhere = first.text != place.text;
        reading.error(place,
                      fmt::format("the name `{}` is taken by a part in {}line {}", name,
                                  elsewhere ? first.text->name + ", " : "", first.line),
                      "names must differ");
        break;
      }
  }
}

/// A detector's results stand beside each other under its name with an ending.
void check_result_names(const PartNodes& nodes, Reading& reading) {
  const std::vector<std::string> detectors = nodes.names({Detector::kind});
  for (const std::string& name : detectors)
    for (const std::string_view ending : {"_x", "_z", "_levels"})
      if (std::find(detectors.begin(), detectors.end(), name + std::string(ending)) != detectors.end())
        reading.error(
            place_of(*nodes.find(name + std::string(ending)), "name"),
            fmt::format("the detector `{}` keeps results under the name `{}{}`", name, name, ending),
            "choose another name");
}

void check_detectors(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const Entry* parts = root.find("parts");
  if (!parts || !parts->value.is_sequence()) return;
  const auto& items = parts->value.items;
  if (std::none_of(items.begin(), items.end(),
                   [](const Node& n) { return PartNodes::kind_of(n) == Detector::kind; }))
    reading.error(
        parts->key_place, "there is no detector among the parts, so the experiment would measure nothing",
        "add `- {name: screen, kind: detector, at: 1.2 m, width: 4 mm, height: 4 mm, bins: [80, 80]}`");
  for (std::size_t i = 0; i < beamline.parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const PlacedPart &a = beamline.parts[k], &b = beamline.parts[i];
      const auto *first = std::get_if<Detector>(&a.part), *second = std::get_if<Detector>(&b.part);
      if (!first || !second || a.placement.at != b.placement.at) continue;
      if (std::abs(first->offset.x - second->offset.x) < (first->width + second->width) / 2 &&
          std::abs(first->offset.z - second->offset.z) < (first->height + second->height) / 2)
        reading.error(
            place_in(nodes, b, "at"),
            fmt::format(
                "the detectors `{}` and `{}` cover each other at {}: which of them would catch a particle?",
                a.placement.name, b.placement.name, metres(b.placement.at)),
            "move one of them along the beam, or aside with `offset`");
    }
}

double area_of(const Opening& opening) {
  if (const auto* r = std::get_if<Rectangle>(&opening)) return r->width * r->height;
  return std::get<Disc>(opening).radius;
}

void check_aim(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  const auto* aimed = std::get_if<AimedDirection>(&beamline.source.direction);
  if (!aimed || aimed->target.empty()) return;
  const Place& place = place_of(root.find("source")->value.find("direction")->value, "target");
  const Node* target = nodes.find(aimed->target);
  if (!target ||
      (PartNodes::kind_of(*target) != Slit::kind && PartNodes::kind_of(*target) != Detector::kind)) {
    const std::string known = suggest_name(aimed->target, nodes.names({Slit::kind, Detector::kind}));
    reading.error(place,
                  target
                      ? fmt::format("`{}` is a {}, but a source is aimed at a slit or a detector",
                                    aimed->target, PartNodes::kind_of(*target))
                      : fmt::format("there is no slit or detector `{}` to aim the source at", aimed->target),
                  known);
    return;
  }
  for (const PlacedPart& part : beamline.parts) {
    if (part.placement.name != aimed->target) continue;
    if (!(part.placement.at > 0))
      reading.error(place_of(*target, "at"),
                    fmt::format("the source is aimed at `{}`, which must stand behind it, not in its plane",
                                aimed->target),
                    "give it an `at` greater than zero");
    if (const auto* slit = std::get_if<Slit>(&part.part); slit && area_of(slit->opening) == 0)
      reading.error(place,
                    fmt::format("the source is aimed at `{}`, whose opening has no area", aimed->target),
                    "open the slit");
    const auto field = std::find_if(beamline.parts.begin(), beamline.parts.end(), [&](const PlacedPart& p) {
      return is_field(p.part) && p.placement.at < part.placement.at;
    });
    if (field != beamline.parts.end())
      reading.error(place,
                    fmt::format("the field `{}` begins at {}, before `{}` at {}: nothing may act before the "
                                "opening that the source is aimed at",
                                field->placement.name, metres(field->placement.at), aimed->target,
                                metres(part.placement.at)),
                    "aim at an opening before the first field, or use `direction: {kind: cone, ...}`");
  }
}

void check_follower(const PlacedPart& part, const RotatingField& zone, const PartNodes& nodes,
                    Reading& reading) {
  const std::string& clock = *zone.oscillator;
  const Place& place = place_in(nodes, part, "oscillator");
  const Node* target = nodes.find(clock);
  std::vector<std::string> clocks = nodes.names({RotatingField::kind});
  std::erase(clocks, part.placement.name);
  if (clock == part.placement.name)
    reading.error(place, fmt::format("`{}` cannot follow its own clock", clock), "leave `oscillator` away");
  else if (!target)
    reading.error(place,
                  fmt::format("there is no rotating_field `{}` whose clock `{}` could follow", clock,
                              part.placement.name),
                  suggest_name(clock, clocks));
  else if (PartNodes::kind_of(*target) != RotatingField::kind)
    reading.error(place,
                  fmt::format("`{}` is a {} and has no clock to follow", clock, PartNodes::kind_of(*target)),
                  suggest_name(clock, clocks));
  else if (const Entry* next = target->find("oscillator"))
    reading.error(place, fmt::format("`{}` follows a clock itself, that of `{}`", clock, next->value.scalar),
                  fmt::format("write `oscillator: {}`", next->value.scalar));
  const Node& node = *nodes.find(part.placement.name);
  for (const std::string_view key : {"frequency", "sense"})
    if (const Entry* entry = node.find(key))
      reading.error(entry->key_place,
                    fmt::format("`{}` has a `{}` of its own, but it follows the clock of `{}`",
                                part.placement.name, key, clock),
                    fmt::format("leave `{}` away, or `oscillator`", key));
  if (zone.phase.kind == Phase::Kind::random)
    reading.error(place_in(nodes, part, "phase"),
                  fmt::format("the phase of `{}` cannot be random: it follows the clock of `{}`",
                              part.placement.name, clock),
                  "write `locked`, or the angle by which it runs ahead");
}

void check_oscillators(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  for (const PlacedPart& part : beamline.parts) {
    const auto* zone = std::get_if<RotatingField>(&part.part);
    if (!zone || !nodes.find(part.placement.name)) continue;
    if (zone->oscillator) {
      check_follower(part, *zone, nodes, reading);
      continue;
    }
    const auto need = [&](std::string_view key, std::string_view example) {
      reading.error(place_in(nodes, part, "kind"),
                    fmt::format("the rotating_field `{}` needs `{}`", part.placement.name, key),
                    fmt::format("add `{}: {}`, or `oscillator` and the name of a zone whose clock it follows",
                                key, example));
    };
    if (!zone->frequency) need("frequency", "291.6 kHz");
    if (!zone->sense) need("sense", "co");
  }
}

/// `co` and `counter` follow the sign of gamma; one field cannot follow two.
void check_senses(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const Species *positive = nullptr, *negative = nullptr;
  for (const Component& component : beamline.species)
    (component.species.gyromagnetic_ratio < 0 ? negative : positive) = &component.species;
  if (!positive || !negative) return;
  for (const PlacedPart& part : beamline.parts) {
    const auto* zone = std::get_if<RotatingField>(&part.part);
    if (!zone || (zone->sense != Sense::co && zone->sense != Sense::counter)) continue;
    reading.error(
        place_in(nodes, part, "sense"),
        fmt::format("`{}` cannot say which way the field turns: `{}` has a positive and `{}` a negative "
                    "gyromagnetic ratio, so they precess in opposite senses",
                    *zone->sense == Sense::co ? "co" : "counter", positive->name, negative->name),
        fmt::format("write `positive` to drive `{}`, or `negative` to drive `{}`, with the field along +z",
                    negative->name, positive->name));
  }
}

void check_polarizers(const Beamline& beamline, const PartNodes& nodes, Reading& reading) {
  const auto& parts = beamline.parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const auto *first = std::get_if<Polarizer>(&parts[k].part),
                 *second = std::get_if<Polarizer>(&parts[i].part);
      if (!first || !second) continue;
      const double a = parts[k].placement.at, b = parts[i].placement.at;
      if (a < b + second->length && b < a + first->length)
        reading.error(place_in(nodes, parts[i], "at"),
                      fmt::format("the polarizers `{}` ({} to {}) and `{}` ({} to {}) overlap: only one of "
                                  "them can align the moments",
                                  parts[k].placement.name, metres(a), metres(a + first->length),
                                  parts[i].placement.name, metres(b), metres(b + second->length)),
                      "move one of them along the beam");
    }
}

/// How far from the axis the nearest point of a hole or screen is.
double distance_from_axis(const Opening& opening, const Offset& offset) {
  if (const auto* disc = std::get_if<Disc>(&opening))
    return std::max(0.0, std::hypot(offset.x, offset.z) - disc->radius);
  const auto& r = std::get<Rectangle>(opening);
  return std::hypot(std::max(0.0, std::abs(offset.x) - r.width / 2),
                    std::max(0.0, std::abs(offset.z) - r.height / 2));
}

double farthest_point(const Opening& opening) {
  if (const auto* disc = std::get_if<Disc>(&opening)) return disc->radius;
  const auto& r = std::get<Rectangle>(opening);
  return std::hypot(r.width, r.height) / 2;
}

void check_chamber(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  if (!beamline.chamber || beamline.chamber->radius == 0) return;
  const double radius = beamline.chamber->radius;
  if (farthest_point(beamline.source.opening) >= radius)
    reading.error(
        root.find("source")->value.find("opening") ? root.find("source")->value.find("opening")->key_place
                                                   : root.find("source")->key_place,
        fmt::format("the source's opening reaches {} from the axis, into the wall of the chamber at {}",
                    metres(farthest_point(beamline.source.opening)), metres(radius)),
        "make the opening smaller or the chamber wider");
  for (const PlacedPart& part : beamline.parts) {
    double nearest = 0;
    if (const auto* slit = std::get_if<Slit>(&part.part))
      nearest = distance_from_axis(slit->opening, slit->offset);
    if (const auto* screen = std::get_if<Detector>(&part.part))
      nearest = distance_from_axis(Rectangle{screen->width, screen->height}, screen->offset);
    if (nearest >= radius)
      reading.error(
          place_in(nodes, part, "offset"),
          fmt::format("`{}` lies outside the chamber: it begins {} from the axis, and the wall is at {}",
                      part.placement.name, metres(nearest), metres(radius)),
          "reduce its offset or make the chamber wider");
  }
}

}  // namespace

bool is_reserved(std::string_view name) {
  static constexpr std::array words{// keys of the file
                                    "rabiline", "title", "geometry", "species", "law", "source", "chamber",
                                    "parts", "particles", "seed", "scan",
                                    // names in the results
                                    "entry", "fates", "simulation", "instrument", "sample", "user", "data",
                                    "definition", "program_name", "start_time", "end_time", "duration",
                                    "detected", "axes", "signal", "default"};
  return std::find(words.begin(), words.end(), name) != words.end();
}

void check_axis(const Axis& axis, const std::vector<Beamline>& points, Reading& reading) {
  for (const Beamline& point : points)
    for (const PlacedPart& part : point.parts) {
      const auto* now = std::get_if<Detector>(&part.part);
      for (const PlacedPart& other : points.front().parts) {
        const auto* then = std::get_if<Detector>(&other.part);
        if (!now || !then || part.placement.name != other.placement.name || now->bins == then->bins) continue;
        return reading.error(axis.place,
                             fmt::format("`{}` cannot be scanned: all points fill the same histogram of `{}`",
                                         axis.parameter, part.placement.name),
                             "make one run for each number of bins");
      }
    }
}

void check_beamline(const Beamline& beamline, const Node& root, Reading& reading) {
  const PartNodes nodes(root);
  check_names(nodes, reading);
  check_result_names(nodes, reading);
  check_detectors(beamline, root, nodes, reading);
  check_aim(beamline, root, nodes, reading);
  check_oscillators(beamline, nodes, reading);
  check_senses(beamline, nodes, reading);
  check_polarizers(beamline, nodes, reading);
  check_chamber(beamline, root, nodes, reading);
}

}  // namespace rabiline
