// A source that cannot be as it is written.
#include <cmath>
#include <numbers>
#include <numeric>

#include "input/check_nodes.hpp"

namespace rabiline {
namespace {

double area_of(const Opening& opening) {
  if (const auto* r = std::get_if<Rectangle>(&opening)) return r->width * r->height;
  if (const auto* ring = std::get_if<Ring>(&opening)) return ring->outer_radius - ring->inner_radius;
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

/// The node below `source` that a path of keys leads to, as far as it is there.
const Node& node_below_source(const Node& root, std::initializer_list<std::string_view> keys) {
  const Entry* entry = root.find("source");
  const Node* node = entry ? &entry->value : &root;
  for (const std::string_view key : keys)
    if (const Entry* next = node->find(key)) node = &next->value;
  return *node;
}

// ---- speeds ----

/// Where a key of the law stands: "value", "lines[0].value".
const Place& place_of_key(const Node& speed, std::string_view key) {
  if (const std::size_t bracket = key.find('['); bracket != key.npos) {
    const Entry* list = speed.find(key.substr(0, bracket));
    const std::size_t index = std::stoul(std::string(key.substr(bracket + 1)));
    if (list == nullptr || index >= list->value.items.size()) return speed.place;
    return place_of(list->value.items[index], key.substr(key.find("].") + 2));
  }
  return place_of(speed, key);
}

/// How fast a species flies that is too fast, and how to mend it.
std::pair<std::string, std::string> too_fast(const StatedSpeed& stated, const Species& species) {
  const std::string limit =
      fmt::format("{:.4g} m/s{}, faster than 0.05 c = {:.4g} m/s: this program knows no relativity",
                  speed_of(stated.value, species.mass), stated.is_mean ? " on average" : "", fastest_speed);
  if (stated.is_mean)
    return {fmt::format("at that temperature the species `{}` flies at {}", species.name, limit),
            "make it colder"};
  const Dimension quantity = stated.value.dimension;
  if (quantity == Dimension::speed)
    return {fmt::format("the species `{}` flies at {}", species.name, limit), "make it slower"};
  return {fmt::format("at {} the species `{}` flies at {}", pretty_quantity(stated.value.value, quantity),
                      species.name, limit),
          quantity == Dimension::length ? "make the wavelength longer" : "make the energy smaller"};
}

/// The first species that is too fast, for each key of the law.
void check_speeds(const Beamline& beamline, const Node& root, Reading& reading) {
  std::vector<std::string> reported;
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    if (!(species.mass > 0)) continue;
    for (const StatedSpeed& stated : std::visit(
             [&](const auto& law) { return law.stated_speeds(species.mass); }, beamline.source.speed)) {
      if (!(stated.value.value > 0) || speed_of(stated.value, species.mass) <= fastest_speed ||
          std::ranges::count(reported, stated.key) > 0)
        continue;
      const auto [message, help] = too_fast(stated, species);
      reading.error(place_of_key(node_below_source(root, {"speed"}), stated.key), message, help);
      reported.push_back(stated.key);
    }
  }
}

/// A normal law is normal in one quantity.
void check_gaussian(const GaussianSpeed& law, const Node& root, Reading& reading) {
  const Node& sigma = node_below_source(root, {"speed", "sigma"});
  if (law.mean.value > 0 && law.mean.dimension != law.sigma.dimension && sigma.is_scalar())
    reading.error(
        sigma.place,
        fmt::format("the mean is {} and sigma is {}: the law is normal in one of them",
                    law.mean.dimension == Dimension::length ? "a wavelength"
                                                            : with_article(name_of(law.mean.dimension)),
                    law.sigma.dimension == Dimension::length ? "a wavelength"
                                                             : with_article(name_of(law.sigma.dimension))),
        fmt::format("write sigma like the mean, in a unit such as `{}`",
                    law.mean.dimension == Dimension::length   ? "angstrom"
                    : law.mean.dimension == Dimension::energy ? "meV"
                                                              : "m/s"));
}

// ---- directions ----

constexpr double right_angle = std::numbers::pi / 2;
constexpr double farthest_normal = 8.6;  // [sigma] the kernels draw none beyond: sqrt(-2 ln 2^-53) = 8.57

std::string degrees(double angle) { return fmt::format("{:.4g} deg", angle / right_angle * 90); }

/// Nothing may start backwards.
void check_tilt(const Source& source, const Node& root, Reading& reading) {
  if (source.tilt == SourceTilt{}) return;
  const Node& node = node_below_source(root, {"tilt"});
  const double forward = std::cos(source.tilt.x) * std::cos(source.tilt.z);  // y of the axis
  const double tilt = std::acos(std::clamp(forward, -1.0, 1.0));
  if (tilt >= right_angle - 1e-9)
    return reading.error(node.place,
                         fmt::format("the tilt turns the source's axis by {}, off the beam", degrees(tilt)),
                         "tilt it by less than 90 deg");
  if (std::holds_alternative<AimedDirection>(source.direction)) return;
  const double angle =
      std::visit([](const auto& law) { return law.widest_angle(farthest_normal); }, source.direction);
  if (tilt + angle < right_angle) return;
  const bool limited = std::holds_alternative<CosineDirection>(source.direction) ||
                       std::holds_alternative<ConeDirection>(source.direction);
  reading.error(
      node.place,
      fmt::format("tilted by {}, the source sends particles backwards: its directions reach {} from the axis",
                  degrees(tilt), degrees(angle)),
      limited ? fmt::format("write `half_angle: {}` or less",
                            degrees(std::floor((right_angle - tilt) * 1e3) / 1e3))
              : "tilt it less, or aim it: `direction: {kind: aimed, target: ..., emission: ...}`");
}

void check_channel(const DirectionLaw& direction, const Node& root, Reading& reading) {
  const auto* channel = std::get_if<ChannelDirection>(&direction);
  const auto* aimed = std::get_if<AimedDirection>(&direction);
  if (aimed) channel = std::get_if<ChannelDirection>(&aimed->emission);
  if (channel == nullptr || !(channel->radius > 0)) return;
  constexpr double longest = 1000;  // [radii]
  if (channel->length <= longest * channel->radius) return;
  const Node& node =
      aimed ? node_below_source(root, {"direction", "emission"}) : node_below_source(root, {"direction"});
  reading.error(place_of(node, "length"),
                fmt::format("the channel is {:.4g} times as long as its radius, more than {}",
                            channel->length / channel->radius, longest),
                "such a tube hardly lets anything through; is one of the units wrong?");
}

// ---- spins ----

void check_populations(const Beamline& beamline, const Node& root, Reading& reading) {
  const auto* populated = std::get_if<PopulatedSpin>(&beamline.source.spin);
  if (!populated || populated->values.empty()) return;
  const Node& values = node_below_source(root, {"spin", "values"});
  if (!values.is_sequence() || values.items.size() != populated->values.size()) return;
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    const auto levels = static_cast<std::size_t>(species.spin.twice) + 1;
    if (species.spin.twice < 1 || species.structure || levels == populated->values.size()) continue;
    return reading.error(values.place,
                         fmt::format("`values` has {} entries, but the species `{}` has {} levels",
                                     populated->values.size(), species.name, levels),
                         "give one share for each m, from m = I down to m = -I");
  }
  if (!reading.errors.empty()) return;  // a share that could not be read counts as none
  const double sum = std::accumulate(populated->values.begin(), populated->values.end(), 0.0);
  if (std::abs(sum - 1) > 1e-9)
    reading.error(values.place, fmt::format("the populations add up to {:.10g}, not to 1", sum),
                  "they are shares of all particles");
}

/// Atoms start in levels of their Hamiltonian, which no axis tells apart; point moments have no such levels.
void check_levels(const Beamline& beamline, const Node& root, Reading& reading) {
  const StartSpin& spin = beamline.source.spin;
  const bool names_levels =
      std::holds_alternative<LevelsSpin>(spin) || std::holds_alternative<ThermalSpin>(spin);
  const bool names_axis =
      std::holds_alternative<PolarisedSpin>(spin) || std::holds_alternative<PopulatedSpin>(spin);
  const bool quantum = std::holds_alternative<QuantumLaw>(beamline.law);
  const Node& node = node_below_source(root, {"spin"});
  const Place& place = node.is_mapping() ? place_of(node, "kind") : node.place;
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    if (!(species.mass > 0)) continue;  // it could not be read
    if (names_levels && !quantum)
      return reading.error(
          place,
          fmt::format("levels exist under the law `quantum` only, not under `{}`", describe(beamline.law)),
          "give the spin a direction: `spin: {kind: polarised, axis: z}`");
    if (names_levels && !species.structure)
      return reading.error(
          place, fmt::format("the species `{}` has one moment and no levels of two spins", species.name),
          find_species(species.name + " atom") != nullptr
              ? fmt::format("write `species: {} atom` for the atom with its electron", species.name)
              : "its levels m are given by `{kind: populations, values: [...]}`");
    if (names_axis && species.structure && quantum)
      return reading.error(
          place, fmt::format("the levels of `{}` are no levels of one spin along an axis", species.name),
          fmt::format("write `spin: unpolarised`, or name levels: `{{kind: levels, levels: [{}]}}`",
                      names_of_levels(coupled_spins(*species.structure)).front()));
  }
}

/// "F=4 with m from -4 to 4, F=3 with m from -3 to 3"; of names in a strong field those.
std::string levels_of(const CoupledSpins& spins, bool strong_field) {
  if (strong_field)
    return fmt::format("m_J from {} to {} and m_I from {} to {}", write_half(-spins.twice_j),
                       write_half(spins.twice_j), write_half(-spins.twice_i), write_half(spins.twice_i));
  std::string text;
  int last = -1;
  for (const LevelLabel& label : level_labels(spins)) {
    if (label.twice_f == last) continue;
    last = label.twice_f;
    text += fmt::format("{}F={} with m from {} to {}", text.empty() ? "" : ", ", write_half(last),
                        write_half(-last), write_half(last));
  }
  return text;
}

void check_named_levels(const Beamline& beamline, const Node& root, Reading& reading) {
  const auto* named = std::get_if<LevelsSpin>(&beamline.source.spin);
  if (named == nullptr) return;
  const Node& list = node_below_source(root, {"spin", "levels"});
  if (!list.is_sequence() || list.items.size() != named->levels.size()) return;
  for (const Component& component : beamline.species) {
    if (!component.species.structure) continue;
    const CoupledSpins spins = coupled_spins(*component.species.structure);
    const std::vector<LevelLabel> labels = level_labels(spins);
    for (std::size_t i = 0; i < named->levels.size(); ++i) {
      const Node& item = list.items[i];
      if (!item.is_scalar() || !parse_level_name(item.scalar)) continue;  // which was said
      const std::optional<int> level = find_level(labels, named->levels[i]);
      if (!level)
        reading.error(item.place, fmt::format("`{}` has no level {}", component.species.name, quote(item)),
                      fmt::format("it has {}", levels_of(spins, named->levels[i].strong_field)));
      for (std::size_t k = 0; level && k < i; ++k)
        if (find_level(labels, named->levels[k]) == level) {
          reading.error(item.place,
                        fmt::format("{} is the level {} again", quote(item), quote(list.items[k])),
                        "name each level once; `shares` tells how many particles start in it");
          break;
        }
    }
  }
  if (!named->shares || !reading.errors.empty()) return;
  const Node& shares = node_below_source(root, {"spin", "shares"});
  if (named->shares->size() != named->levels.size())
    return reading.error(shares.place,
                         fmt::format("`shares` has {} entries, but `levels` has {}", named->shares->size(),
                                     named->levels.size()),
                         "give one share for each level");
  const double sum = std::accumulate(named->shares->begin(), named->shares->end(), 0.0);
  if (std::abs(sum - 1) > 1e-9)
    reading.error(shares.place, fmt::format("the shares add up to {:.10g}, not to 1", sum),
                  "they are shares of all particles");
}

}  // namespace

void check_source(const Beamline& beamline, const Node& root, const PartNodes& nodes, Reading& reading) {
  check_aim(beamline, root, nodes, reading);
  check_speeds(beamline, root, reading);
  if (const auto* gaussian = std::get_if<GaussianSpeed>(&beamline.source.speed))
    check_gaussian(*gaussian, root, reading);
  check_tilt(beamline.source, root, reading);
  check_channel(beamline.source.direction, root, reading);
  check_populations(beamline, root, reading);
  check_levels(beamline, root, reading);
  check_named_levels(beamline, root, reading);
}

}  // namespace rabiline
