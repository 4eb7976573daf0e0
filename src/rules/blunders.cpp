// Experiments that cannot find what they look for.
#include <algorithm>
#include <array>
#include <cmath>

#include "core/portable_math.hpp"
#include "particle/draw.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

/// Whether a part changes spins in time, or turns them by a wound angle.
bool works_on_spins(const Part& part) {
  return std::visit(
      [](const auto& any) {
        if constexpr (requires { any.oscillator; }) return any.amplitude != 0;
        if constexpr (requires { any.angle; }) return any.angle != 0;
        return false;
      },
      part);
}
bool acts(const PlacedPart& part) { return traits_of(part.part).field || traits_of(part.part).sets_spins; }
bool aligns(const Part& part) {
  return std::visit(
      [](const auto& any) {
        return requires { any.alignment; };
      },
      part);
}
bool filters(const Part& part) {
  return std::visit(
      [](const auto& any) {
        return requires { any.up; };
      },
      part);
}
bool asks_for_spins(const Part& part, const Law& law) {
  if ((is_magnet(part) && law_traits(law).has_forces) || filters(part) || detector_in(part)) return true;
  const std::vector<Tally>* tallies = tallies_of(part);
  return tallies && std::any_of(tallies->begin(), tallies->end(), [](const Tally& tally) {
           return std::any_of(tally.axes.begin(), tally.axes.end(),
                              [](const TallyAxis& axis) { return asks_for_spin(axis.quantity); });
         });
}

bool has_levels(const Beamline& beamline) {
  return std::ranges::any_of(beamline.species,
                             [](const Component& c) { return c.species.structure.has_value(); });
}

// ---- what reaches what on a straight flight ----

/// A rectangle across the beam, along x and z.
struct Box {
  std::array<double, 2> centre{}, half{};
};
Box box_of(const Opening& opening, Offset offset, double roll) {
  if (const auto* disc = std::get_if<Disc>(&opening))
    return {{offset.x, offset.z}, {disc->radius, disc->radius}};
  if (const auto* ring = std::get_if<Ring>(&opening))
    return {{offset.x, offset.z}, {ring->outer_radius, ring->outer_radius}};
  const auto& r = std::get<Rectangle>(opening);
  const double c = std::abs(portable::cos(roll)), s = std::abs(portable::sin(roll));
  return {{offset.x, offset.z}, {(c * r.width + s * r.height) / 2, (s * r.width + c * r.height) / 2}};
}
std::array<double, 2> half_size(const Rectangle& r) { return {r.width / 2, r.height / 2}; }
std::array<double, 2> half_size(const Disc& d) { return {d.radius, d.radius}; }
std::array<double, 2> half_size(const Ring& r) { return {r.outer_radius, r.outer_radius}; }
std::array<double, 2> half_size(const GaussianSpot& s) {
  return {farthest_normal * s.sigma_x, farthest_normal * s.sigma_z};
}
/// The largest slopes along x and z; nothing where every direction is possible.
using Slopes = std::optional<std::array<double, 2>>;
Slopes slopes_of(const ParallelDirection&) { return {{0, 0}}; }
Slopes slopes_of(const GaussianDirection& law) {
  return {{farthest_normal * law.x, farthest_normal * law.z}};
}
Slopes slopes_of(const BoxDirection& law) { return {{portable::tan(law.x), portable::tan(law.z)}}; }
Slopes slopes_of(const ConeDirection& law) {
  return {{portable::tan(law.half_angle), portable::tan(law.half_angle)}};
}
template <class Law>
Slopes slopes_of(const Law&) {
  return std::nullopt;
}

/// The holes that a beam has to pass, in order: slits, screens, collimators and bores.
struct Hole {
  const PlacedPart* part;
  double y;
  Box box;
};
std::vector<Hole> holes_of(const Beamline& beamline) {
  std::vector<Hole> out;
  for (const PlacedPart& part : beamline.parts)
    std::visit(
        [&](const auto& any) {
          const double y = part.placement.at;
          if constexpr (requires { any.bore; })
            if (any.bore) out.push_back({&part, y, box_of(Disc{any.bore->radius}, any.offset, 0)});
          if constexpr (requires { Face{any.opening}; })
            out.push_back({&part, y, box_of(opening_of(any.opening), any.offset, any.tilt.y)});
          if (monitor_in(part.part)) return;
          if (const auto across = across_of(part.part))
            out.push_back({&part, y, box_of(across->opening, across->offset, across->tilt.y)});
        },
        part.part);
  std::stable_sort(out.begin(), out.end(), [](const Hole& a, const Hole& b) { return a.y < b.y; });
  return out;
}

/// The first hole that no straight path from the source meets; what bends paths may help behind it.
void find_holes_out_of_reach(const Beamline& beamline, Faults& out) {
  const Source& source = beamline.source;
  const Slopes slopes = std::visit([](const auto& law) { return slopes_of(law); }, source.direction);
  if (!slopes || !(source.tilt == SourceTilt{}) || beamline.gravity) return;
  const std::array<double, 2> start{source.offset.x, source.offset.z},
      size = std::visit([](const auto&hole) { return half_size(hole); }, source.opening);
  for (const Hole& hole : holes_of(beamline)) {
    for (const PlacedPart& part : beamline.parts)
      if (part.placement.at < hole.y && traits_of(part.part).field &&
          (is_magnet(part.part) || turns_paths(beamline)))
        return;
    for (std::size_t i = 0; i < 2; ++i) {
      const double apart = std::abs(hole.box.centre[i] - start[i]),
                   reach = hole.box.half[i] + size[i] + (*slopes)[i] * hole.y;
      if (apart <= reach * (1 + 1e-12)) continue;
      const std::string& name = hole.part->placement.name;
      const bool of_source = std::abs(start[i]) > std::abs(hole.box.centre[i]);
      out.push_back(warning(
          of_source ? "source" : name, "offset",
          fmt::format("nothing that starts at the source can reach `{}`: along {} its opening is {} from the "
                      "source's, and its directions reach {}",
                      name, i == 0 ? "x" : "z", metres(apart - hole.box.half[i] - size[i]),
                      metres((*slopes)[i] * hole.y)),
          "move one of them, or let the source send particles there"));
      return;
    }
  }
}

void find_closed_slits(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const auto across = across_of(part.part);
    if (!across) continue;
    const Box box = box_of(across->opening, across->offset, 0);
    const auto* ring = std::get_if<Ring>(&across->opening);
    if (box.half[0] > 0 && box.half[1] > 0 && !(ring && ring->inner_radius == ring->outer_radius)) continue;
    const auto* rectangle = std::get_if<Rectangle>(&across->opening);
    out.push_back(warning(
        part.placement.name,
        !rectangle              ? ring ? "inner_radius" : "radius"
        : rectangle->width == 0 ? "width"
                                : "height",
        fmt::format("`{}` is closed: its opening has no area, and nothing passes it", part.placement.name),
        "open it"));
  }
}

// ---- the order of the parts ----

/// Whether a face hides all of what stands behind it from all of the source.
bool hides(const Beamline& beamline, const PlacedPart& front, const PlacedPart& behind) {
  const Across face = across_of(front.part).value(), other = across_of(behind.part).value();
  const std::array<double, 2> size =
      std::visit([](const auto& h) { return half_size(h); }, beamline.source.opening);
  const Box target = box_of(other.opening, other.offset, other.tilt.y),
            own = box_of(face.opening, face.offset, 0);
  const double share = front.placement.at / behind.placement.at;
  const std::array<double, 2> start{beamline.source.offset.x, beamline.source.offset.z};
  const double shrunk = std::holds_alternative<Disc>(face.opening) ? std::sqrt(0.5) : 1;
  if (face.tilt.y != 0) return false;
  for (std::size_t i = 0; i < 2; ++i) {
    const double centre = start[i] + (target.centre[i] - start[i]) * share,
                 half = size[i] * (1 - share) + target.half[i] * share;
    if (std::abs(centre - own.centre[i]) + half > own.half[i] * shrunk) return false;
  }
  return true;
}

/// A screen that catches everything before anything has acted.
void find_screens_in_front(const Beamline& beamline, Faults& out) {
  double first = HUGE_VAL;
  for (const PlacedPart& part : beamline.parts)
    if (acts(part)) first = std::min(first, part.placement.at);
  if (!std::isfinite(first)) return;
  for (const PlacedPart& part : beamline.parts) {
    if (!detector_in(part.part) || part.placement.at >= first) continue;
    const bool is_last =
        std::all_of(beamline.parts.begin(), beamline.parts.end(), [&](const PlacedPart& other) {
          return !detector_in(other.part) || other.placement.at <= part.placement.at ||
                 hides(beamline, part, other);
        });
    if (is_last)
      out.push_back(warning(part.placement.name, "at",
                            fmt::format("`{}` at {} stands in front of everything that acts, which begins at "
                                        "{}: nothing has happened to what it catches",
                                        part.placement.name, metres(part.placement.at), metres(first)),
                            "place it behind the fields"));
  }
}

/// A homogeneous field may hold the spins of a target; any other one has not done its work inside.
void find_screens_in_fields(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const double y = part.placement.at;
    const auto field = std::find_if(beamline.parts.begin(), beamline.parts.end(), [&](const PlacedPart& p) {
      const PartTraits traits = traits_of(p.part);
      return traits.field && !traits.homogeneous && p.placement.at < y && y < end_of(p);
    });
    if (!detector_in(part.part) || field == beamline.parts.end()) continue;
    out.push_back(
        warning(part.placement.name, "at",
                fmt::format("`{}` at {} stands inside `{}` ({} to {}), which has not done all of its "
                            "work there",
                            part.placement.name, metres(y), field->placement.name,
                            metres(field->placement.at), metres(end_of(*field))),
                "place it behind the field"));
  }
}

/// Calls tell(first, second, where) for each two parts that share a stretch of the beam.
template <class Tell>
void each_overlap(const Beamline& beamline, Tell tell) {
  const auto& parts = beamline.parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const double begin = std::max(parts[i].placement.at, parts[k].placement.at),
                   end = std::min(end_of(parts[i]), end_of(parts[k]));
      if (begin + 1e-12 < end)
        tell(parts[k], parts[i], [=] { return fmt::format("from {} to {}", metres(begin), metres(end)); });
    }
}

/// Two fields of one clock at one place are one field, and poles do not fit into poles.
void find_overlaps(const Beamline& beamline, Faults& out) {
  const auto clock = [](const PlacedPart& part) -> const std::string& {
    const std::string* followed = clock_of(part.part);
    return followed ? *followed : part.placement.name;
  };
  each_overlap(beamline, [&](const PlacedPart& one, const PlacedPart& other, const auto& where) {
    const std::string &name = other.placement.name, help = "place them one behind the other";
    if (traits_of(one.part).drives && traits_of(other.part).drives && clock(one) == clock(other))
      out.push_back(warning(name, "at",
                            fmt::format("`{}` and `{}` follow one clock and overlap {}, where their "
                                        "fields add up",
                                        one.placement.name, name, where()),
                            help));
    if (is_magnet(one.part) && is_magnet(other.part))
      out.push_back(warning(name, "at",
                            fmt::format("the magnets `{}` and `{}` stand one inside the other {}; their "
                                        "fields are added",
                                        one.placement.name, name, where()),
                            help));
  });
}

/// A winding has many turns; where `turns` is missing it has one.
void find_single_turns(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const auto* solenoid = std::get_if<Solenoid>(&part.part);
    const auto* current = solenoid ? std::get_if<CoilCurrent>(&solenoid->strength) : nullptr;
    if (current && current->turns == 1)
      out.push_back(warning(part.placement.name, "current",
                            fmt::format("the solenoid `{}` has one turn on a winding of {}",
                                        part.placement.name, metres(solenoid->winding)),
                            "add `turns`, or state `field` instead of the current"));
  }
}

/// Nobody sees what becomes of particles there.
void find_parts_behind_counters(const Beamline& beamline, Faults& out) {
  double last = -HUGE_VAL;
  for (const PlacedPart& part : beamline.parts)
    if (tallies_of(part.part)) last = std::max(last, end_of(part));
  for (const PlacedPart& part : beamline.parts)
    if (!tallies_of(part.part) && part.placement.at > last)
      out.push_back(warning(
          part.placement.name, "at",
          fmt::format("`{}` stands behind everything that counts: no detector or monitor sees what it does",
                      part.placement.name),
          "place it in front of the detector"));
}

/// A polariser sets spins anew, along its field.
void find_useless_polarisers(const Beamline& beamline, Faults& out) {
  std::vector<const PlacedPart*> order;
  for (const PlacedPart& part : beamline.parts) order.push_back(&part);
  std::stable_sort(order.begin(), order.end(), [](const PlacedPart* a, const PlacedPart* b) {
    return a->placement.at < b->placement.at;
  });
  const PlacedPart* worked = nullptr;  // on spins that nobody has asked for since
  for (const PlacedPart* part : order) {
    const std::string& name = part->placement.name;
    if (const auto* polarizer = std::get_if<Polarizer>(&part->part); polarizer && polarizer->field == 0)
      out.push_back(warning(
          name, "field", fmt::format("`{}` has no field: it aligns the moments along +z nevertheless", name),
          "give it the field that aligns them"));
    if (aligns(part->part) && worked && !turns_paths(beamline))
      out.push_back(warning(name, "at",
                            fmt::format("`{}` aligns the moments anew behind `{}`: what that has done to "
                                        "them is lost, and nothing in between has measured it",
                                        name, worked->placement.name),
                            "polarise in front of what turns spins; a `spin_filter` analyses them"));
    if (works_on_spins(part->part))
      worked = part;
    else if (aligns(part->part) || asks_for_spins(part->part, beamline.law))
      worked = nullptr;
  }
}

/// A filter that passes all alike, or nothing.
void find_idle_filters(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const auto* filter = std::get_if<SpinFilter>(&part.part);
    if (!filter) continue;
    const std::string& name = part.placement.name;
    const bool names_all = std::ranges::any_of(beamline.species, [&](const Component& component) {
      return component.species.structure &&
             filter->levels.size() == static_cast<std::size_t>(component.species.levels());
    });
    if (filter->up == 0 && (filter->down == 0 || names_all))
      out.push_back(
          warning(name, "up", fmt::format("`{}` lets nothing pass", name), "make `up` larger than 0"));
    else if (filter->up == filter->down)
      out.push_back(warning(
          name, "down",
          fmt::format("`{}` passes all {} alike: it sorts nothing", name, filter->axis ? "spins" : "levels"),
          "let `up` and `down` differ"));
    else if (names_all)
      out.push_back(warning(name, "levels", fmt::format("`{}` names all levels: it sorts nothing", name),
                            "name those that pass alone"));
  }
}

/// Unpolarised spins look the same however they are turned.
void find_unpolarised_spins(const Beamline& beamline, Faults& out) {
  const bool one_moment = !law_traits(beamline.law).has_levels || !has_levels(beamline);
  if (!std::holds_alternative<UnpolarisedSpin>(beamline.source.spin) || !one_moment ||
      law_traits(beamline.law).kappa != 0)
    return;
  const PlacedPart *first = nullptr, *last = nullptr;
  for (const PlacedPart& part : beamline.parts)
    if (works_on_spins(part.part)) {
      if (!first || part.placement.at < first->placement.at) first = &part;
      if (!last || part.placement.at > last->placement.at) last = &part;
    }
  const bool can_be_seen = std::ranges::any_of(beamline.parts, [&](const PlacedPart& part) {
    const std::vector<Tally>* tallies = tallies_of(part.part);
    const bool by_level = tallies && std::ranges::any_of(*tallies, [](const Tally& tally) {
                            return std::ranges::any_of(tally.axes, [](const TallyAxis& axis) {
                              return axis.quantity == Quantity::prepared_level;
                            });
                          });
    const bool selects = aligns(part.part) || filters(part.part) ||
                         (is_magnet(part.part) && law_traits(beamline.law).has_forces);
    return by_level || (last && selects && part.placement.at < end_of(*last));
  });
  if (first && !can_be_seen)
    out.push_back(
        warning(first->placement.name, "at",
                fmt::format("`{}` acts on unpolarised spins: nothing in front of it polarises them, so "
                            "nothing that it does to them can be seen",
                            first->placement.name),
                "write `spin: {kind: polarised, axis: z}` for the source, or put a spin_filter, a "
                "polarizer or a deflecting magnet in front"));
}

}  // namespace

Faults blunders_of(const Beamline& beamline) {
  Faults out;
  find_closed_slits(beamline, out);
  if (out.empty()) find_holes_out_of_reach(beamline, out);
  const std::size_t before = out.size();
  find_screens_in_front(beamline, out);
  if (out.size() == before) {
    find_useless_polarisers(beamline, out);
    find_parts_behind_counters(beamline, out);
  }
  find_screens_in_fields(beamline, out);
  find_overlaps(beamline, out);
  find_single_turns(beamline, out);
  find_idle_filters(beamline, out);
  if (out.empty()) find_unpolarised_spins(beamline, out);
  return out;
}

}  // namespace rabiline
