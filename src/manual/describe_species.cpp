#include "manual/describe_species.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/constants.hpp"
#include "core/units.hpp"

namespace rabiline {
namespace {

using namespace constants;

constexpr std::array<std::array<std::string_view, 2>, 3> references{{
    {"CODATA 2022", "P. Mohr, D. Newell, B. Taylor, E. Tiesinga, NIST (2024)"},
    {"AME2020", "M. Wang et al., Chinese Physics C 45, 030003 (2021); masses of neutral atoms"},
    {"Stone 2014", "N. Stone, INDC(NDS)-0658, IAEA (2014); moments of bare nuclei"},
}};

std::string in_units(const Species& s, double of_mass) {
  return write_measured(s.mass / of_mass, s.mass_uncertainty / of_mass);
}
std::string gamma_over(const Species& s, double unit) {
  return write_measured(s.gyromagnetic_ratio / unit, s.gyromagnetic_ratio_uncertainty / unit);
}
std::string name_of(HalfInteger spin) {
  return spin.twice % 2 ? fmt::format("{}/2", spin.twice) : fmt::format("{}", spin.twice / 2);
}
std::string charge_of(const Species& s) {
  return s.charge == 0 ? " 0" : fmt::format("{:+g}", s.charge / elementary_charge);
}
/// Where the point of a number stands, or would stand.
std::size_t point_of(std::string_view number) { return std::min(number.find('.'), number.find('(')); }

/// Numbers stand under each other with their points in one column.
void align_points(std::vector<std::array<std::string, 6>>& rows, std::size_t column) {
  std::size_t before = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) before = std::max(before, point_of(rows[i][column]));
  for (std::size_t i = 1; i < rows.size(); ++i)
    rows[i][column].insert(0, before - point_of(rows[i][column]), ' ');
}

}  // namespace

std::string species_table() {
  std::vector<std::array<std::string, 6>> rows{
      {"name", "spin", "mass, u", "charge, e", "gamma/2pi, MHz/T", "source"}};
  for (const Species& s : species_library())
    rows.push_back({s.name, name_of(s.spin), in_units(s, atomic_mass), charge_of(s),
                    gamma_over(s, two_pi * 1e6), s.source});
  align_points(rows, 2);
  align_points(rows, 4);
  std::array<std::size_t, 6> width{};
  for (const auto& row : rows)
    for (std::size_t i = 0; i < width.size(); ++i) width[i] = std::max(width[i], row[i].size());
  std::string out;
  for (const auto& row : rows) {
    for (std::size_t i = 0; i + 1 < width.size(); ++i) out += fmt::format("  {:{}}", row[i], width[i]);
    out += fmt::format("  {}\n", row.back());
  }
  out += "Atoms have the moment of their bare nucleus: their electrons' moment and shielding are left out.\n";
  for (const auto& [name, work] : references) out += fmt::format("{}: {}\n", name, work);
  return out;
}

std::string describe_species_of_library(const Species& s) {
  const double moment_of_one = hbar * s.spin.value();  // mu = gamma hbar I
  const auto moment_in = [&](double magneton) {
    return write_measured(s.gyromagnetic_ratio * moment_of_one / magneton,
                          s.gyromagnetic_ratio_uncertainty * moment_of_one / magneton);
  };
  const double larmor = std::abs(s.gyromagnetic_ratio) * 1e-3 / two_pi;  // [Hz] at 1 mT
  std::string out = fmt::format("{}: a species of the library\n", s.name);
  const auto line = [&](std::string_view what, const std::string& value) {
    out += fmt::format("  {:20}{}\n", what, value);
  };
  line("mass", fmt::format("{} u = {:.9g} kg", in_units(s, atomic_mass), s.mass));
  line("charge", fmt::format("{:g} e", s.charge / elementary_charge));
  line("spin", fmt::format("{}, {} levels", name_of(s.spin), s.spin.twice + 1));
  line("gyromagnetic ratio", fmt::format("gamma/2pi = {} MHz/T", gamma_over(s, two_pi * 1e6)));
  line("", fmt::format("gamma = {}e6 rad/s/T", gamma_over(s, 1e6)));
  line("moment", fmt::format("{} nuclear magnetons", moment_in(nuclear_magneton)));
  line("", fmt::format("{} Bohr magnetons, mu = gamma hbar I", moment_in(bohr_magneton)));
  line("Larmor frequency", fmt::format("{} at 1 mT; the spin turns {}-handed about the field",
                                       pretty_quantity(larmor, Dimension::frequency),
                                       s.gyromagnetic_ratio > 0 ? "left" : "right"));
  if (!s.left_out.empty()) line("left out", s.left_out);
  line("source", s.source);
  for (const auto& [name, work] : references)
    if (s.source.find(name) != std::string::npos) line("", fmt::format("{}: {}", name, work));
  if (find_species(s.name + " atom") != nullptr)
    line("with its electron", fmt::format("`rabiline describe \"{} atom\"`", s.name));
  return out + fmt::format("\nExample\n  species: {}\n", s.name);
}

std::string describe_mixture(const Mixture& mixture) {
  std::string out = fmt::format("{}: its isotopes as they are found on Earth, in one beam\n", mixture.name);
  for (const Component& isotope : mixture.components)
    out += fmt::format("  {:<16} {:>8.4f} %\n", isotope.species.name, 100 * isotope.fraction);
  return out +
         fmt::format("\n`rabiline describe \"{}\"` tells more of one.\n", mixture.components[0].species.name);
}

}  // namespace rabiline
