// Numbers that no apparatus has, and that are read all the same.
#include <array>
#include <cmath>

#include "rules/each_number.hpp"
#include "rules/warning_room.hpp"

namespace rabiline {
namespace {

/// What a quantity of an apparatus hardly comes to, in SI, and by what that is known.
struct Limit {
  Dimension dimension;
  double most;
  std::string_view why;
};
constexpr std::array largest_made{
    Limit{Dimension::length, 1e6, "no beam is so long or so wide"},
    Limit{Dimension::time, 1e9, "that is thirty years"},
    Limit{Dimension::magnetic_field, most_magnetic_field, "no coil has more than 1200 T"},
    Limit{Dimension::electric_field, 1e10, "10 GV/m pulls electrons out of every metal"},
    Limit{Dimension::frequency, 1e20, "gamma rays have that"},
    Limit{Dimension::temperature, 1e6, "no oven stands it"},
    Limit{Dimension::current, 1e9, "no wire stands it"},
    Limit{Dimension::acceleration, 300, "on the Sun it is 274 m/s^2"},
    Limit{Dimension::pressure, 1e8, "no gas cell stands it"},
};
/// [m] What a size is that atoms hardly fit into.
constexpr double an_atom = 1e-10;

bool is_size(const NumberRow& row) { return row.dimension == Dimension::length && row.range.low == 0; }

}  // namespace

Faults absurd_numbers_of(const Beamline& beamline) {
  Faults out;
  each_number(
      beamline, [&](std::string_view subject, double value, const NumberKey& key, const NumberRow& row) {
        if (!row.dimension || value == 0) return;
        const auto limit = std::ranges::find(largest_made, *row.dimension, &Limit::dimension);
        const bool too_large = limit != largest_made.end() && std::abs(value) > limit->most,
                   too_small = is_size(row) && value < an_atom;
        if (!too_large && !too_small) return;
        const PlacedPart* part = find_part(beamline, subject);
        if (part != nullptr && is_magnet(part->part) && row.dimension == Dimension::magnetic_field)
          return;  // impossible_magnets_of
        const std::string name = key.text();
        out.push_back(warning(
            std::string(subject), name,
            fmt::format("`{}` of `{}` is {}: {}", name, subject, pretty_quantity(value, *row.dimension),
                        too_large ? limit->why : "an atom is larger than that"),
            "is one of the units wrong?"));
      });
  return out;
}

}  // namespace rabiline
