#include "particle/species.hpp"

#include <cmath>
#include <vector>

#include "core/constants.hpp"
#include "core/units.hpp"

namespace rabiline {
namespace {

using constants::elementary_charge;
using constants::hbar;
using constants::nuclear_magneton;

/// A row of the library, its numbers as the source prints them: 2.75131(12) is 2.75131 +- 0.00012.
struct Entry {
  std::string_view name;
  std::string_view mass;  // in kg or u
  int charge;             // [e]
  HalfInteger spin;
  std::string_view moment;  // in nuclear magnetons mu_N, or in MHz/T as gamma/2pi; signed
  std::string_view source;
  std::string_view left_out;
};

// CODATA 2022: P. Mohr, D. Newell, B. Taylor, E. Tiesinga, NIST, May 2024.
// AME2020: M. Wang et al., Chinese Physics C 45, 030003 (2021), masses of neutral atoms.
// Stone 2014: N. Stone, INDC(NDS)-0658, IAEA, February 2014, moments of bare nuclei.
constexpr std::string_view codata = "CODATA 2022";
constexpr std::string_view ame_codata_p = "AME2020 (mass), CODATA 2022 (proton)";
constexpr std::string_view ame_codata_d = "AME2020 (mass), CODATA 2022 (deuteron)";
constexpr std::string_view ame_codata_h = "AME2020 (mass), CODATA 2022 (helion)";
constexpr std::string_view ame_shielded = "AME2020 (mass), CODATA 2022 (shielded helion)";
constexpr std::string_view ame_stone = "AME2020 (mass), Stone 2014 (moment)";

// Li-7 is rounded from AME2020 7.01600343426(450) u and Stone's 3.256427(2) mu_N.

// What an atom has beside its nucleus. Its moment is that of the bare nucleus, as the sources give it;
// shielded by the electrons it precesses more slowly. He-3: CODATA 2022, helion shielding shift 5.9967e-5.
// Xe-129 and Hg-199: 11.78 and 7.590 MHz/T are what atoms of the gas show.
constexpr std::string_view electrons = "the electrons' moment and their shielding of the nucleus";
constexpr std::string_view shield_he = "the electrons' shielding of the nucleus, 60 ppm";
constexpr std::string_view shield_xe = "the electrons' shielding of the nucleus, 0.7 %";
constexpr std::string_view shield_hg = "the electrons' shielding of the nucleus, 1.6 %";

// clang-format off
constexpr Entry entries[] = {
    {"neutron",  "1.67492750056(85)e-27 kg",  0, {1}, "-29.1646935(69) MHz/T",     codata,       ""},
    {"proton",   "1.67262192595(52)e-27 kg", +1, {1}, "42.577478461(18) MHz/T",    codata,       ""},
    {"deuteron", "2.013553212544(15) u",     +1, {2}, "0.8574382335(22) mu_N",     codata,       ""},
    {"electron", "9.1093837139(28)e-31 kg",  -1, {1}, "-28024.9513861(87) MHz/T",  codata,       ""},
    {"muon+",    "0.1134289257(25) u",       +1, {1}, "8.89059704(20) mu_N",       codata,       ""},
    {"muon-",    "0.1134289257(25) u",       -1, {1}, "-8.89059704(20) mu_N",      codata,       ""},
    {"H",        "1.007825031898(14) u",      0, {1}, "42.577478461(18) MHz/T",    ame_codata_p, electrons},
    {"D",        "2.014101777844(15) u",      0, {2}, "0.8574382335(22) mu_N",     ame_codata_d, electrons},
    {"He-3",     "3.01602932197(6) u",        0, {1}, "-2.1276253498(17) mu_N",    ame_codata_h, shield_he},
    {"He-3 gas", "3.01602932197(6) u",        0, {1}, "-32.434100033(28) MHz/T",   ame_shielded, ""},
    {"Li-6",     "6.01512288742(155) u",      0, {2}, "0.8220473(6) mu_N",         ame_stone,    electrons},
    {"Li-7",     "7.01600340(4) u",           0, {3}, "16.54828(1) MHz/T",         ame_stone,    electrons},
    {"F-19",     "18.99840316207(88) u",      0, {1}, "2.628868(8) mu_N",          ame_stone,    electrons},
    {"Na-23",    "22.98976928195(194) u",     0, {3}, "2.217522(2) mu_N",          ame_stone,    electrons},
    {"K-39",     "38.96370648482(489) u",     0, {3}, "0.39147(3) mu_N",           ame_stone,    electrons},
    {"K-41",     "40.96182525611(403) u",     0, {3}, "0.2148701(2) mu_N",         ame_stone,    electrons},
    {"Rb-85",    "84.91178973604(537) u",     0, {5}, "1.35298(10) mu_N",          ame_stone,    electrons},
    {"Rb-87",    "86.909180529(6) u",         0, {3}, "2.75131(12) mu_N",          ame_stone,    electrons},
    {"Ag-107",   "106.905091509(2556) u",     0, {1}, "-0.11357(2) mu_N",          ame_stone,    electrons},
    {"Ag-109",   "108.904755778(1381) u",     0, {1}, "-0.13056(2) mu_N",          ame_stone,    electrons},
    {"Xe-129",   "128.90478085742(542) u",    0, {1}, "-0.777976(8) mu_N",         ame_stone,    shield_xe},
    {"Cs-133",   "132.905451958(8) u",        0, {7}, "2.582025(3) mu_N",          ame_stone,    electrons},
    {"Hg-199",   "198.968280994(564) u",      0, {1}, "0.5058855(9) mu_N",         ame_stone,    shield_hg},
};
// clang-format on

struct Measured {
  double value, uncertainty;
  bool in_magnetons;  // else SI: kg, Hz/T
};

/// Reads "42.577478461(18) MHz/T": 42.577478461 MHz/T, and 18 of the last digit.
Measured read(std::string_view text) {
  const std::size_t open = text.find('('), close = text.find(')'), blank = text.find(' ');
  const std::string mantissa(text.substr(0, open));
  std::string spread = mantissa;
  std::string_view digits = text.substr(open + 1, close - open - 1);
  for (auto c = spread.rbegin(); c != spread.rend(); ++c) {
    if (*c < '0' || *c > '9') continue;
    *c = digits.empty() ? '0' : digits.back();
    if (!digits.empty()) digits.remove_suffix(1);
  }
  const std::string_view unit = text.substr(blank, text.find('/') - blank);
  const bool in_magnetons = unit == " mu_N";
  std::string rest(text.substr(close + 1, blank - close - 1));
  if (!in_magnetons) rest += unit;
  return {parse_quantity(mantissa + rest).value, std::abs(parse_quantity(spread + rest).value), in_magnetons};
}

Species species_of(const Entry& entry) {
  // The uncertainty of u and of mu_N themselves, 3.1e-10, is left out: all species share it.
  const Measured mass = read(entry.mass), moment = read(entry.moment);
  // mu = gamma hbar I
  const double gamma_of_one =
      moment.in_magnetons ? nuclear_magneton / (hbar * entry.spin.value()) : constants::two_pi;
  return {.name = std::string(entry.name),
          .mass = mass.value,
          .charge = entry.charge * elementary_charge,
          .spin = entry.spin,
          .gyromagnetic_ratio = gamma_of_one * moment.value,
          .source = std::string(entry.source),
          .left_out = std::string(entry.left_out),
          .mass_uncertainty = mass.uncertainty,
          .gyromagnetic_ratio_uncertainty = gamma_of_one * moment.uncertainty};
}

}  // namespace

std::span<const Species> species_library() {
  static const std::vector<Species> library = [] {
    std::vector<Species> out;
    for (const Entry& entry : entries) out.push_back(species_of(entry));
    return out;
  }();
  return library;
}

double gyromagnetic_ratio(const Moment& moment, double charge, double mass) {
  if (const auto* g = std::get_if<GFactor>(&moment)) return g->g_factor * charge / (2 * mass);
  return std::get<GyromagneticRatio>(moment).gyromagnetic_ratio;
}

const Species* find_species(std::string_view name) {
  for (const Species& species : species_library())
    if (species.name == name) return &species;
  for (const Species& species : species_with_levels())  // made from those above
    if (species.name == name) return &species;
  return nullptr;
}

}  // namespace rabiline
