#include "scan/parameter_value.hpp"

#include <sstream>
#include <vector>

#include "input/beamline_reader.hpp"
#include "input/tables.hpp"
#include "scan/member.hpp"

namespace rabiline {
namespace {

struct TakeNumber {
  std::optional<ParsedQuantity> found{};
  template <class Row, class Member>
  void operator()(const Row& row, const Member& member) {
    if constexpr (std::is_same_v<Member, double>) found = ParsedQuantity{member, row.dimension, {}, {}};
    if constexpr (std::is_same_v<Member, std::optional<double>>)
      if (member) found = ParsedQuantity{*member, row.dimension, {}, {}};
    if constexpr (std::is_same_v<Member, SpeedQuantity>)
      found = ParsedQuantity{member.value, member.dimension, {}, {}};
    if constexpr (std::is_same_v<Member, Phase>)
      if (member.kind != Phase::Kind::random) found = ParsedQuantity{member.angle, Dimension::angle, {}, {}};
  }
};

/// Of the beam's one species: what the file has of its own.
std::optional<ParsedQuantity> number_of_species(const std::string& key, const Beamline& beamline) {
  if (beamline.species.size() != 1) return std::nullopt;
  const Species& species = beamline.species.front().species;
  if (key == "gyromagnetic_ratio" && !species.structure)
    return ParsedQuantity{species.gyromagnetic_ratio, Dimension::gyromagnetic, {}, {}};
  if (key == "mass") return ParsedQuantity{species.mass, Dimension::mass, {}, {}};
  return std::nullopt;
}

}  // namespace

std::optional<ParsedQuantity> number_called(const std::string& name, const Beamline& beamline) {
  std::vector<std::string> words;
  std::istringstream text(name);
  for (std::string word; std::getline(text, word, '.');) words.push_back(word);
  if (words.empty()) return std::nullopt;
  if (words.size() == 2 && words[0] == "species") return number_of_species(words[1], beamline);
  Beamline file = beamline;
  TakeNumber take;
  visit_parameter(file, words, take);
  return take.found;
}

}  // namespace rabiline
