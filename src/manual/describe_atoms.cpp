// Species with levels for people.
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "core/constants.hpp"
#include "manual/describe_page.hpp"
#include "manual/describe_species.hpp"
#include "spin/atoms.hpp"
#include "spin/breit_rabi.hpp"
#include "spin/level_names.hpp"
#include "spin/levels.hpp"

namespace rabiline {
namespace {

using namespace constants;

/// "F=3, F=4 at +9192.63177 MHz": from the lowest up.
std::string terms_of(const Structure& s) {
  const CoupledSpins spins = coupled_spins(s);
  std::vector<std::pair<double, int>> terms;  // energy [Hz] and 2F
  for (int twice_f = std::abs(s.i.twice - s.j.twice); twice_f <= s.i.twice + s.j.twice; twice_f += 2)
    terms.emplace_back(zero_field_energy(spins, twice_f), twice_f);
  std::sort(terms.begin(), terms.end());
  std::string out = "F=" + write_half(terms.front().second);
  for (std::size_t i = 1; i < terms.size(); ++i)
    out += fmt::format(", F={} at +{:.9g} MHz", write_half(terms[i].second),
                       (terms[i].first - terms.front().first) / 1e6);
  return out;
}

/// All levels at one field; moments in Bohr magnetons, or of a molecule in nuclear ones.
std::string levels_of(const Structure& structure) {
  constexpr double field = 0.1;  // [T]
  const CoupledSpins spins = coupled_spins(structure);
  const Levels levels = levels_at(spins, field);
  double largest = 0, spread = 0;
  for (const double moment : levels.moment) largest = std::max(largest, std::abs(moment));
  const bool small = largest < 0.05 * bohr_magneton;
  for (int twice_f = std::abs(spins.twice_i - spins.twice_j); twice_f <= spins.twice_i + spins.twice_j;
       twice_f += 2)
    spread = std::max(spread, std::abs(zero_field_energy(spins, twice_f) - spins.offset));
  const double scale = spread / std::max(std::abs(spins.zeeman_i), std::abs(spins.zeeman_j));  // [T]
  std::string out = fmt::format(
      "\n  Levels at {}: energy E/h in MHz, moment -dE/dB in {} magnetons, and the "
      "fields where it vanishes\n",
      pretty_quantity(field, Dimension::magnetic_field), small ? "nuclear" : "Bohr");
  for (std::size_t n = 0; n < levels.labels.size(); ++n) {
    std::string vanishes;
    if (scale > 0)
      for (const double b : zero_moment_fields(spins, static_cast<int>(n), 1e-4 * scale, 1e2 * scale))
        vanishes +=
            fmt::format("{} {}", vanishes.empty() ? " " : ",", pretty_quantity(b, Dimension::magnetic_field));
    const double moment = levels.moment[n] / (small ? nuclear_magneton : bohr_magneton);
    out += fmt::format("    {:12} {:20} {:>14.6f}  {:+.6f}{}\n", weak_field_name(levels.labels[n]),
                       strong_field_name(levels.labels[n]), levels.energy[n] / planck / 1e6,
                       std::abs(moment) < 5e-7 ? 0.0 : moment, vanishes);
  }
  return out;
}

}  // namespace

std::string table_of_species_with_levels() {
  std::vector<std::array<std::string, 5>> rows{{"name", "I", "J", "levels", "without a field"}};
  for (const Species& s : species_with_levels())
    rows.push_back({s.name, write_half(s.structure->i.twice), write_half(s.structure->j.twice),
                    std::to_string(s.levels()), terms_of(*s.structure)});
  std::array<std::size_t, 5> width{};
  for (const auto& row : rows)
    for (std::size_t i = 0; i < width.size(); ++i) width[i] = std::max(width[i], row[i].size());
  std::string out;
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const std::string source = r == 0 ? "source" : species_with_levels()[r - 1].source;
    for (std::size_t i = 0; i < width.size(); ++i) out += fmt::format("  {:{}}", rows[r][i], width[i]);
    out += fmt::format("  {}\n", source);
  }
  return out;
}

std::string describe_species_with_levels(const Species& s) {
  const Structure& structure = *s.structure;
  std::string out = fmt::format("{}: a species of the library, with levels\n", s.name);
  const auto line = [&](std::string_view what, const std::string& value) {
    out += fmt::format("  {:20}{}\n", what, value);
  };
  line("mass", fmt::format("{} u = {:.9g} kg",
                           write_measured(s.mass / atomic_mass, s.mass_uncertainty / atomic_mass), s.mass));
  line("charge", fmt::format("{:g} e", s.charge / elementary_charge));
  line("spins", fmt::format("I = {}, J = {}: {} levels", write_half(structure.i.twice),
                            write_half(structure.j.twice), s.levels()));
  line("coupling", fmt::format("A = {:.10g} MHz{}", structure.coupling / 1e6,
                               structure.quadrupole == 0
                                   ? ""
                                   : fmt::format(", quadrupole B = {:.9g} MHz", structure.quadrupole / 1e6)));
  line("g factors", fmt::format("g_J = {:.10g}, g_I' = {:.8g} in Bohr magnetons, mu = -g mu_B I",
                                structure.g_j, structure.g_i));
  line("without a field", terms_of(structure));
  const std::string_view symbol = std::string_view(s.name).substr(0, s.name.find(' '));
  if (const HyperfineAtom* atom = find_atom(symbol); atom && atom->twice_i % 2 == 1)
    line("clock shift", fmt::format("{:.6g} Hz/G^2 of the line between the levels m=0, at small fields",
                                    clock_quadratic_shift(*atom) / 1e8));
  line("classical", fmt::format("that law takes J alone: spin {}, gamma/2pi = {:.7g} MHz/T",
                                write_half(s.spin.twice), s.gyromagnetic_ratio / two_pi / 1e6));
  line("source", s.source);
  const std::string some = weak_field_name(level_labels(coupled_spins(structure)).front());
  return out + levels_of(structure) +
         fmt::format(
             "\nExample\n  species: {}\n  law: quantum\n  source: {{..., spin: {{kind: levels, levels: "
             "[{}]}}}}\n",
             s.name, some);
}

std::string describe_structure() {
  Page page("structure: the levels of a species, those of two coupled angular momenta in a field");
  add_rows<Structure>(page);
  page.line(
      "H/h = A I.J + B [3 (I.J)^2 + (3/2) I.J - I(I+1) J(J+1)] / (2I(2I-1) J(2J-1)) + (mu_B/h) B_z (g_J J_z "
      "+ "
      "g_I I_z)");
  page.line("A level is called F=4 m=0, or by what it becomes in a strong field, m_J=1/2 m_I=-7/2.");
  page.line(
      "\nExample\n  species: {name: my_caesium, mass: 132.905 u, charge: 0 e, structure: {I: 7/2, J: 1/2, "
      "coupling: 2298.158 MHz, g_J: 2.00254, g_I: -0.000398854}}");
  return page.finish();
}

std::string describe_species() {
  Page page("species: what flies");
  page.line(fmt::format("\nPoints with one moment, standard uncertainties of the last digits in brackets\n{}",
                        species_table()));
  page.line(fmt::format("Atoms and molecules with levels, for the law quantum\n{}",
                        table_of_species_with_levels()));
  page.line("`rabiline describe Rb-87` and `rabiline describe \"Rb-87 atom\"` tell more of one.");
  page.line("\nOr a definition of your own");
  add_rows<SpeciesWithMoment>(page);
  page.line("\nOr one with levels");
  add_rows<SpeciesWithLevels>(page);
  add_rows<Structure>(page);
  page.line(
      "\nExamples\n  species: neutron\n  species: Cs-133 atom\n  species: [{name: Li-7, fraction: 0.92}, "
      "{name: "
      "H, fraction: 0.08}]");
  page.line(fmt::format("  species: {}", example_of_type<SpeciesWithMoment>({})));
  page.line(
      "  species: {name: my_atom, mass: 132.905 u, charge: 0 e, structure: {I: 7/2, J: 1/2, coupling: "
      "2298.158 MHz, g_J: 2.00254, g_I: -0.000398854}}");
  return page.finish();
}

}  // namespace rabiline
