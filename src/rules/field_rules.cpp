// Fields that cannot act as they are written.
#include <algorithm>

#include "rules/room.hpp"

namespace rabiline {
namespace {

/// A clock that is followed is of the same kind, and its own.
void check_followers(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    const std::string *clock = clock_of(part.part), &name = part.placement.name;
    if (!clock || *clock == name) continue;
    const std::string_view kind = kind_of(part.part);
    const PlacedPart* target = find_part(beamline, *clock);
    const std::vector<std::string> clocks = names_of_parts(beamline, [&](const PlacedPart& other) {
      return kind_of(other.part) == kind && other.placement.name != name;
    });
    if (!target)
      out.push_back({name, "oscillator",
                     fmt::format("there is no {} `{}` whose clock `{}` could follow", kind, *clock, name),
                     suggest_name(*clock, clocks)});
    else if (kind_of(target->part) != kind)
      out.push_back({name, "oscillator",
                     fmt::format("`{}` is a {}, whose clock {} cannot follow", *clock, kind_of(target->part),
                                 with_article(kind)),
                     suggest_name(*clock, clocks)});
    else if (const std::string* next = clock_of(target->part))
      out.push_back({name, "oscillator",
                     fmt::format("`{}` follows a clock itself, that of `{}`", *clock, *next),
                     fmt::format("write `oscillator: {}`", *next)});
  }
}

/// The sense of a field that has one of its own and turns in time.
std::optional<Sense> sense_of(const Part& part) {
  return std::visit(
      [](const auto& any) -> std::optional<Sense> {
        if constexpr (requires { any.sense; }) return any.sense;
        return std::nullopt;
      },
      part);
}

/// `co` and `counter` follow the sign of gamma; one field cannot follow two.
void check_senses(const Beamline& beamline, Faults& out) {
  const Species *positive = nullptr, *negative = nullptr;
  for (const Component& component : beamline.species)
    if (!is_quantum(beamline) || !component.species.structure)
      (component.species.gyromagnetic_ratio < 0 ? negative : positive) = &component.species;
  if (!positive || !negative) return;
  for (const PlacedPart& part : beamline.parts) {
    const std::optional<Sense> sense = sense_of(part.part);
    if (sense != Sense::co && sense != Sense::counter) continue;
    out.push_back(
        {part.placement.name, "sense",
         fmt::format("`{}` cannot say which way the field turns: `{}` has a positive and `{}` a negative "
                     "gyromagnetic ratio, so they precess in opposite senses",
                     *sense == Sense::co ? "co" : "counter", positive->name, negative->name),
         fmt::format("write `positive` to drive `{}`, or `negative` to drive `{}`, with the field along +z",
                     negative->name, positive->name)});
  }
}

bool aligns(const PlacedPart& part) {
  return std::visit(
      [](const auto& any) {
        return requires { any.alignment; };
      },
      part.part);
}

void check_polarizers(const Beamline& beamline, Faults& out) {
  const auto& parts = beamline.parts;
  for (std::size_t i = 0; i < parts.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      if (!aligns(parts[k]) || !aligns(parts[i])) continue;
      const double a = parts[k].placement.at, b = parts[i].placement.at;
      if (a < end_of(parts[i]) && b < end_of(parts[k]))
        out.push_back({parts[i].placement.name, "at",
                       fmt::format("the polarizers `{}` ({} to {}) and `{}` ({} to {}) overlap: only one of "
                                   "them can align the moments",
                                   parts[k].placement.name, metres(a), metres(end_of(parts[k])),
                                   parts[i].placement.name, metres(b), metres(end_of(parts[i]))),
                       "move one of them along the beam"});
    }
}

void check_coils(const Beamline& beamline, Faults& out) {
  const Species& first = beamline.species.front().species;
  if (first.gyromagnetic_ratio != 0) return;
  for (const PlacedPart& part : beamline.parts)
    if (std::visit(
            [](const auto& any) {
              return requires { any.angle; };
            },
            part.part))
      out.push_back({part.placement.name, "kind",
                     fmt::format("`{}` cannot turn the spin of {}, which has no magnetic moment",
                                 part.placement.name, first.name),
                     "a uniform_field has a field of its own"});
}

void check_filters(const Beamline& beamline, Faults& out) {
  for (const PlacedPart& part : beamline.parts) {
    if (!std::visit(
            [](const auto& any) {
              return requires { any.up; };
            },
            part.part))
      continue;
    const bool names_levels = std::visit(
        [](const auto& any) {
          if constexpr (requires { any.up; }) return !any.levels.empty();
          return false;
        },
        part.part);
    for (const Component& c : beamline.species)
      if (names_levels && !(is_quantum(beamline) && c.species.structure))
        out.push_back(
            {part.placement.name, "levels",
             fmt::format("`{}` filters levels, but {}", part.placement.name,
                         c.species.structure ? "they exist under the law `quantum` only"
                                             : fmt::format("`{}` has one moment and no levels of two "
                                                           "spins",
                                                           c.species.name)),
             "write `axis` in place of `levels`"});
      else if (is_quantum(beamline) && c.species.spin.twice > 1 && !c.species.structure)
        out.push_back({part.placement.name, "kind",
                       fmt::format("`{}` filters spins 1/2, but {} has another spin", part.placement.name,
                                   c.species.name),
                       "a polarizer prepares a beam of any spin"});
  }
}

/// Where paths turn, a plane may be crossed both ways and again, and a path through gas is no straight line.
void check_one_way(const Beamline& beamline, Faults& out) {
  if (!turns_paths(beamline)) return;
  constexpr double rounding = 1e-12;  // [m] 0.1 m + 0.2 m is more than 0.3 m, in binary digits
  for (const PlacedPart& part : beamline.parts) {
    if (!traits_of(part.part).one_way) continue;
    const double y = part.placement.at, end = end_of(part);
    const auto first_field = [&](const auto& where) {
      return std::ranges::find_if(beamline.parts, [&](const PlacedPart& p) {
        return traits_of(p.part).field && where(p.placement.at, end_of(p));
      });
    };
    const auto none = beamline.parts.end();
    const auto behind = first_field([&](double from, double to) { return from <= y && y < to; });
    const auto before = first_field([&](double from, double to) { return from < y && y <= to; });
    const auto along = first_field(
        [&](double from, double to) { return from < end - rounding && to > y + rounding && end > y; });
    const auto field = along != none ? along : behind != none ? before : none;
    if (field != none)
      out.push_back(
          {part.placement.name, "at",
           fmt::format(
               "`{}` stands in the field `{}`, which turns the path under this law, and a {} can only be "
               "passed {}",
               part.placement.name, field->placement.name, kind_of(part.part),
               along != none ? "along a straight line" : "in one direction"),
           "move it out of the field, or omit it under this law"});
  }
}

}  // namespace

void check_fields(const Beamline& beamline, Faults& out) {
  check_followers(beamline, out);
  check_senses(beamline, out);
  check_polarizers(beamline, out);
  check_coils(beamline, out);
  check_filters(beamline, out);
  check_one_way(beamline, out);
}

/// Where a particle is deflected in one level, static fields may overlap the magnet, but nothing may drive
/// that level or ask about it. Parts may touch a magnet: 0.1 m + 0.2 m is more than 0.3 m, in binary digits.
void check_magnets(const Beamline& beamline, Faults& out) {
  if (!law_traits(beamline.law).has_forces) return;
  constexpr double rounding = 1e-12;  // [m]
  for (const PlacedPart& magnet : beamline.parts) {
    if (!is_magnet(magnet.part)) continue;
    const std::string& name = magnet.placement.name;
    for (const Component& c : beamline.species)
      if (c.species.charge != 0)
        out.push_back(
            {name, "kind",
             fmt::format(
                 "`{}` cannot deflect `{}`, which has a charge: the Lorentz force would be larger by far",
                 name, c.species.name),
             "deflecting magnets are for neutral particles"});
    for (const PlacedPart& part : beamline.parts) {
      const double begin = part.placement.at, end = end_of(part);
      const double first = magnet.placement.at + rounding, last = end_of(magnet) - rounding;
      const bool overlaps = begin < end ? begin < last && end > first : begin > first && begin < last;
      const bool is_static = traits_of(part.part).field && !traits_of(part.part).drives && !aligns(part);
      if (&part == &magnet || is_static || !overlaps) continue;
      out.push_back({part.placement.name, "at",
                     fmt::format("`{}` stands in the deflecting magnet `{}` ({} to {})", part.placement.name,
                                 name, metres(magnet.placement.at), metres(end_of(magnet))),
                     "move it out of the magnet"});
    }
  }
}

}  // namespace rabiline
