#include "input/beamline_reader.hpp"

#include <algorithm>

#include "input/places.hpp"
#include "input/reader.hpp"
#include "input/species_names.hpp"
#include "rules/rules.hpp"

namespace rabiline {
namespace {

constexpr Row fraction_row{"fraction",
                           Dimension::number,
                           {0, 1, false, true, "greater than 0 and at most 1"},
                           "share of all particles"};

bool find_in_library(const Node& name, Reading& reading, Species& out) {
  const Species* found = find_species(name.scalar);
  if (found)
    out = *found;
  else
    reading.error(name.place, fmt::format("{} is not a species of the library", quote(name)),
                  suggest_species(name.scalar));
  return found != nullptr;
}

bool read_with_moment(const Node& node, Keys& keys, Species& out) {
  SpeciesWithMoment own;
  if (!read_rows(keys, own)) return false;
  if (own.charge == 0 && std::holds_alternative<GFactor>(own.moment)) {
    keys.reading().error(
        place_of(node, "g_factor"),
        fmt::format("`{}` has no charge, and the moment of a `g_factor` is g q/(2m) S", own.name),
        "give its `gyromagnetic_ratio` instead");
    return false;
  }
  out.name = own.name, out.mass = own.mass, out.charge = own.charge, out.spin = own.spin;
  out.gyromagnetic_ratio = gyromagnetic_ratio(own.moment, own.charge, own.mass);
  out.electric_dipole_moment = own.electric_dipole_moment;
  out.source = own.source;
  return true;
}

/// A mapping with nothing but a name means the library; with more it is a definition.
bool read_species(const Node& node, Keys& keys, Species& out) {
  const Entry* name = node.find("name");
  const bool defined = std::any_of(node.entries.begin(), node.entries.end(),
                                   [](const Entry& e) { return e.key != "name" && e.key != "fraction"; });
  if (!defined && name && name->value.is_scalar()) {
    keys.take("name");
    return find_in_library(name->value, keys.reading(), out);
  }
  bool good = false;
  if (node.find("structure")) {
    SpeciesWithLevels own;
    good = read_rows(keys, own);
    out = with_levels(own.name, own.mass, own.structure, own.source);
    out.charge = own.charge;
  } else {
    good = read_with_moment(node, keys, out);
  }
  if (good && find_species(out.name)) {
    keys.reading().error(name->value.place,
                         fmt::format("`{}` is a species of the library, and defined anew here", out.name),
                         "leave its constants away, or give the definition another name");
    return false;
  }
  return good;
}

bool read_component(const Node& node, Reading& reading, Component& out) {
  if (!node.is_mapping()) {
    reading.error(
        node.place, fmt::format("each species of a list has a fraction, but {} stands here", quote(node)),
        fmt::format("write `- {{name: {}, fraction: 0.5}}`", node.is_scalar() ? node.scalar : "neutron"));
    return false;
  }
  const Entry* name = node.find("name");
  const std::string what =
      name && name->value.is_scalar() ? fmt::format("the species `{}`", name->value.scalar) : "the species";
  Keys keys(node, what, name ? name->value.place : node.place, reading);
  bool good = read_species(node, keys, out.species), given = false;
  if (const Entry* fraction = keys.take_value("fraction", given))
    good = read_quantity(fraction->value, fraction_row, reading, out.fraction) && good;
  else
    good = false;
  if (!given) keys.missing("fraction", fraction_row.meaning, "0.5");
  keys.finish();
  return good;
}

/// What messages call a part before its kind is known.
std::string name_of_part(const Node& node) {
  const Entry* name = node.find("name");
  return name && name->value.is_scalar() ? fmt::format("the part `{}`", name->value.scalar) : "this part";
}

/// `- uniform_field:`, the word for a part where a key is to stand.
const Entry* kind_as_key(const Node& node) {
  if (node.find(tag_key<Part>)) return nullptr;
  for (const Entry& entry : node.entries)
    for (const Word& word : words_of<Part>())
      if (entry.key == word.word) return &entry;
  return nullptr;
}

bool read_part(const Node& node, Reading& reading, PlacedPart& out) {
  if (!node.is_mapping()) {
    reading.error(node.place, fmt::format("a part is a mapping of keys, but {} stands here", quote(node)),
                  "write `- {name: B, kind: uniform_field, at: 0.3 m, ...}`");
    return false;
  }
  if (const Entry* kind = kind_as_key(node)) {
    reading.error(
        kind->key_place, fmt::format("a part says what it is by `kind`, but `{}` is a key here", kind->key),
        fmt::format("write `kind: {}`, with the other keys below `kind`, not further right", kind->key));
    return false;
  }
  const Entry* name = node.find("name");
  const std::string what = name_of_part(node);
  Keys keys(node, what, name ? name->value.place : node.place, reading);
  // The kind comes first, so that messages about the other keys can name it.
  bool kind_known = false;
  const std::string_view called = name && name->value.is_scalar() ? std::string_view(name->value.scalar) : "";
  const Row row{called, Dimension::number, range::any, "what the part is"};
  const bool part_read = read_tagged(keys, row, out.part, kind_known);
  const bool good = read_rows(keys, out.placement) && part_read;
  if (kind_known)
    keys.finish(&owners_of_key<Part>);
  else
    keys.finish_unknown();
  return good;
}

}  // namespace

void check_version(const Node& root, Keys& keys) {
  const Entry* version = keys.take("rabiline");
  if (!version)
    keys.reading().error(root.place, "the file does not say which version of the format it is written in",
                         "begin it with `rabiline: 1`");
  else if (!version->value.is_scalar() || version->value.scalar != "1")
    keys.reading().error(
        version->value.place,
        fmt::format("this program reads version 1 of the format, but {} stands here", quote(version->value)),
        "write `rabiline: 1`");
}

bool read_value(const Node& node, const Place& named_at, const Row& row, Reading& reading,
                std::vector<Component>& out) {
  out.clear();
  if (node.is_sequence()) {
    bool good = !node.items.empty();
    if (!good) reading.error(node.place, "the list of species is empty", "write `species: neutron`");
    for (const Node& item : node.items) good = read_component(item, reading, out.emplace_back()) && good;
    return good;
  }
  if (const Mixture* mixture = node.is_scalar() ? find_mixture(node.scalar) : nullptr) {
    out = mixture->components;
    return true;
  }
  Component& only = out.emplace_back();
  if (node.is_scalar()) return find_in_library(node, reading, only.species);
  Keys keys(node, fmt::format("`{}`", row.key), named_at, reading);
  const bool good = read_species(node, keys, only.species);
  keys.finish();
  return good;
}

/// Keeps the parts that could be read; all of them where nothing is reported.
bool read_value(const Node& node, const Place&, const Row& row, Reading& reading,
                std::vector<PlacedPart>& out) {
  out.clear();
  if (!node.is_sequence()) {
    reading.error(node.place, fmt::format("`{}` is a list, but {} stands here", row.key, quote(node)),
                  "begin each part with `- `");
    return false;
  }
  bool good = true;
  for (const Node& item : node.items) {
    PlacedPart part;
    if (read_part(item, reading, part))
      out.push_back(std::move(part));
    else
      good = false;
  }
  return good;
}

namespace {

/// What has such a key below the first level.
std::vector<std::string> owners_below(std::string_view key) {
  if (has_key<Source>(key)) return {"source"};
  return has_key<Chamber>(key) ? std::vector<std::string>{"chamber"} : owners_of_key<Part>(key);
}

/// Whether all of it could be read.
bool read_by_tables(const Node& root, Reading& reading, Beamline& out) {
  if (!root.is_mapping()) {
    reading.error(root.place,
                  fmt::format("a beamline file is a mapping of keys, but {} stands here", quote(root)),
                  "begin it with `rabiline: 1`");
    return false;
  }
  Keys keys(root, "the file", root.place, reading);
  check_version(root, keys);
  const bool all_read = read_rows(keys, out);
  for (const std::string_view key : {"geometry", "variables", "scan"}) keys.take(key);
  keys.finish(&owners_below);
  return all_read;
}

/// Gives those back.
std::vector<PlacedPart> omit_disabled(std::vector<PlacedPart>& parts) {
  const auto rest = std::stable_partition(parts.begin(), parts.end(),
                                          [](const PlacedPart& part) { return part.placement.enabled; });
  std::vector<PlacedPart> disabled(rest, parts.end());
  parts.erase(rest, parts.end());
  return disabled;
}

/// What is missed may be there, and not enabled.
void name_disabled(const std::vector<PlacedPart>& disabled, std::vector<Fault>& faults) {
  for (const PlacedPart& part : disabled) {
    const std::string name = fmt::format("`{}`", part.placement.name);
    for (Fault& fault : faults)
      if (fault.message.find(name) != std::string::npos ||
          (std::holds_alternative<Detector>(part.part) && fault.subject.empty() && fault.key == "parts"))
        fault.help = name + " is not enabled";
  }
}

/// What a part lacks since its key is misspelt, which is told of the key.
bool is_told(const Fault& fault, const std::vector<Diagnostic>& errors) {
  return std::ranges::any_of(errors, [&](const Diagnostic& error) {
    constexpr std::string_view meant = "did you mean ";
    return error.suggestion.starts_with(meant) &&
           error.message.find('`' + fault.subject + '`') != std::string::npos &&
           fault.message.ends_with(fmt::format(
               "`{}` needs {}", fault.subject,
               error.suggestion.substr(meant.size(), error.suggestion.rfind('`') + 1 - meant.size())));
  });
}

}  // namespace

Beamline read_beamline_values(const Node& root, Reading& reading) {
  Beamline out;
  read_by_tables(root, reading, out);
  return out;
}

void finish_beamline(Beamline& beamline) {
  omit_disabled(beamline.parts);
  const auto stands_before = [](const PlacedPart& a, const PlacedPart& b) {
    return a.placement.at < b.placement.at;
  };
  if (!std::ranges::is_sorted(beamline.parts, stands_before))
    std::ranges::stable_sort(beamline.parts, stands_before);
}

Beamline read_beamline(const Node& root, Reading& reading) {
  Beamline out;
  const bool all_read = read_by_tables(root, reading, out);
  const std::vector<PlacedPart> disabled = omit_disabled(out.parts);
  // Rules between parts are asked where all of them could be read.
  std::vector<Fault> faults;
  if (all_read)
    faults = faults_of(out);
  else
    for (const PlacedPart& part : out.parts)
      for (Fault& fault : faults_of(part)) faults.push_back(std::move(fault));
  name_disabled(disabled, faults);
  std::erase_if(faults, [&](const Fault& fault) { return is_told(fault, reading.errors); });
  if (!faults.empty()) {
    const Places places(root);
    for (const Fault& fault : faults) reading.errors.push_back(places.locate(fault));
  }
  finish_beamline(out);
  return out;
}

}  // namespace rabiline
