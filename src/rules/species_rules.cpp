// Species that cannot be, or cannot fly together.
#include <cmath>

#include "rules/room.hpp"
#include "spin/level_names.hpp"

namespace rabiline {
namespace {

void check_mixture(const std::vector<Component>& mixture, Faults& out) {
  double sum = 0;
  for (std::size_t i = 0; i < mixture.size(); ++i) {
    sum += mixture[i].fraction;
    for (std::size_t k = 0; k < i; ++k)
      if (mixture[k].species.name == mixture[i].species.name)
        out.push_back({"species", key_of_species(i, "name"),
                       fmt::format("the species `{}` stands in the list twice", mixture[i].species.name),
                       "add its fractions up in one line"});
  }
  if (std::abs(sum - 1) > 1e-9)
    out.push_back({"species", "",
                   fmt::format("the fractions of the species add up to {:.10g}, not to 1", sum),
                   "the fractions are shares of all particles"});
}

/// What the Hamiltonian cannot mean.
void check_structure(const Species& species, std::size_t number, Faults& out) {
  const Structure& s = *species.structure;
  const auto add = [&](std::string_view key, std::string message, std::string help) {
    out.push_back({"species", key_of_species(number, fmt::format("structure.{}", key)), std::move(message),
                   std::move(help)});
  };
  const auto refuse_size = [&](std::string_view key, double value, double most, std::string_view unit) {
    if (std::abs(value) > most)
      add(key,
          fmt::format("`{}` of `{}` is {:.4g}{}, more than {:.4g}{}", key, species.name, value, unit, most,
                      unit),
          "no atom has that; is the unit wrong?");
  };
  refuse_size("coupling", s.coupling, 1e16, " Hz");
  refuse_size("quadrupole", s.quadrupole, 1e16, " Hz");
  refuse_size("g_J", s.g_j, 1e3, "");
  refuse_size("g_I", s.g_i, 1e3, "");
  if (s.quadrupole != 0 && s.i.twice > 0 && s.j.twice > 0 && (s.i.twice < 2 || s.j.twice < 2))
    add("quadrupole",
        fmt::format("the quadrupole interaction acts on spins of 1 or more, but I is {} and J is {}",
                    write_half(s.i.twice), write_half(s.j.twice)),
        "omit `quadrupole`");
  if (s.i.twice == 0) {
    if (s.coupling != 0)
      add("coupling", fmt::format("`{}` has I = 0, which nothing couples to", species.name),
          "omit `coupling`");
    return;
  }
  if (s.coupling == 0 && s.quadrupole == 0)
    add("coupling",
        fmt::format("I and J of `{}` are not coupled, so it has no hyperfine levels", species.name),
        "state `coupling`, A of A I.J; a species with one moment has `spin` and `gyromagnetic_ratio` instead "
        "of `structure`");
  else if (s.g_j == s.g_i)
    add("g_J", fmt::format("`g_J` and `g_I` of `{}` are equal: no field could mix its levels", species.name),
        "g_I is that of the nucleus in Bohr magnetons, about 1e-3 or smaller");
}

}  // namespace

void check_species(const Beamline& beamline, Faults& out) {
  check_mixture(beamline.species, out);
  for (std::size_t i = 0; i < beamline.species.size(); ++i)
    if (beamline.species[i].species.structure) check_structure(beamline.species[i].species, i, out);
}

}  // namespace rabiline
