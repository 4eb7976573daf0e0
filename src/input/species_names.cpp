#include "input/species_names.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <span>
#include <vector>

#include <fmt/format.h>

#include "core/diagnostics.hpp"
#include "core/text.hpp"
#include "input/words.hpp"
#include "particle/species.hpp"

namespace rabiline {
namespace {

struct Element {
  std::string_view word, symbol;
};
constexpr std::array elements{
    Element{"hydrogen", "H"}, Element{"deuterium", "D"}, Element{"helium", "He"},   Element{"lithium", "Li"},
    Element{"fluorine", "F"}, Element{"sodium", "Na"},   Element{"potassium", "K"}, Element{"rubidium", "Rb"},
    Element{"silver", "Ag"},  Element{"xenon", "Xe"},    Element{"cesium", "Cs"},   Element{"caesium", "Cs"},
    Element{"mercury", "Hg"},
};
struct Molecule {
  std::string_view word, name;
};
constexpr std::array molecules{
    Molecule{"h2", "ortho-H2"},
    Molecule{"d2", "para-D2"},
    Molecule{"hydrogen molecule", "ortho-H2"},
    Molecule{"deuterium molecule", "para-D2"},
};

/// `87Rb`, `Rb87` and `rubidium 87` taken apart; no number where there is none.
struct Isotope {
  std::string element, number;
};
Isotope isotope_in(std::string_view word) {
  Isotope out;
  for (const char c : word)
    if (c >= '0' && c <= '9')
      out.number += c;
    else if (c != ' ' && c != '-' && c != '_' && c != '^')
      out.element += c;
  return out;
}

/// Those of an element, by its symbol.
std::vector<std::string> of_element(std::span<const Species> library, std::string_view symbol,
                                    std::string_view ending) {
  std::vector<std::string> out;
  for (const Species& species : library) {
    const std::string name = lower(species.name), own = lower(symbol);
    if (name == own + std::string(ending) || (name.starts_with(own + "-") && name.ends_with(ending)))
      out.push_back(species.name);
  }
  return out;
}

}  // namespace

std::string species_of_element(std::string_view name) {
  std::string word = lower(name);
  for (const Molecule& molecule : molecules)
    if (word == molecule.word) return fmt::format("did you mean `{}`?", molecule.name);
  bool of_atom = false;
  for (const std::string_view ending : {" atoms", " atom"})
    if (word.ends_with(ending)) {
      word.resize(word.size() - ending.size());
      of_atom = true;
    }
  const Isotope isotope = isotope_in(word);
  const auto known = std::find_if(elements.begin(), elements.end(),
                                  [&](const Element& e) { return e.word == isotope.element; });
  std::string symbol = known != elements.end() ? std::string(known->symbol) : isotope.element;
  if (lower(symbol) == "h" && isotope.number == "2") symbol = "D";
  std::vector<std::string> points = of_element(species_library(), symbol, ""),
                           atoms = of_element(species_with_levels(), symbol, " atom");
  const std::string ending = "-" + isotope.number, of_the_atom = ending + " atom";
  const auto is_of = [](std::string_view behind) {
    return [behind](const std::string& species) { return species.ends_with(behind); };
  };
  const bool is_known = std::ranges::any_of(points, is_of(ending));
  if (is_known) {
    std::erase_if(points, std::not_fn(is_of(ending)));
    std::erase_if(atoms, std::not_fn(is_of(of_the_atom)));
  }
  if (atoms.empty() && (points.empty() || of_atom)) return {};
  if (of_atom)
    return atoms.size() == 1 ? fmt::format("did you mean `{}`?", atoms[0])
                             : fmt::format("write which isotope: {}", list_of(atoms));
  const bool is_clear = is_known || (points.size() == 1 && points[0].find('-') == std::string::npos);
  std::string out = fmt::format("write {}{}", is_clear ? "" : "which isotope: ", list_of(points));
  if (!atoms.empty()) out += fmt::format(", or with the electron {}", list_of(atoms));
  return out;
}

std::string suggest_species(std::string_view name) {
  std::vector<std::string> names;
  for (const auto& library : {species_with_levels(), species_library()})
    for (const Species& species : library) names.push_back(species.name);
  if (std::string isotopes = species_of_element(name); !isotopes.empty()) return isotopes;
  if (const std::string near = closest(name, names); !near.empty())
    return fmt::format("did you mean `{}`? `rabiline describe species` lists them all", near);
  return "`rabiline describe species` lists them, and says how to define one of your own";
}

}  // namespace rabiline
