// The JSON Schema of beamlines and models, from the same tables that read them. It says less than the reader:
// rules between keys and exact ranges of quantities stay with the reader.
#include "input/beamline_reader.hpp"
#include "manual/describe.hpp"
#include "manual/schema_page.hpp"
#include "scan/model_file.hpp"
#include "scan/scan.hpp"

namespace rabiline {
namespace {

std::string joined(const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : ", ") + item;
  return out;
}
std::string list(const std::vector<std::string>& items) { return fmt::format("[{}]", joined(items)); }

/// A text as a regular expression: m/s^2 has a letter that means the beginning there.
std::string in_pattern(std::string_view text) {
  std::string out;
  for (const char c : text) {
    if (std::string_view("\\^$.|?*+()[]{}").find(c) != std::string_view::npos) out += '\\';
    out += c;
  }
  return out;
}

}  // namespace

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string any_of(const std::vector<std::string>& schemas) {
  return schemas.size() == 1 ? schemas.front() : fmt::format(R"({{"anyOf": {}}})", list(schemas));
}

void Mapping::add(std::string_view key, const std::string& schema, bool needed) {
  properties.push_back(in_quotes(key) + ": " + schema);
  if (needed) required.push_back(in_quotes(key));
}
std::string Mapping::schema() const {
  return fmt::format(
      R"({{"type": "object", "properties": {{{}}}, "required": {}, "additionalProperties": false}})",
      joined(properties), list(required));
}

std::string schema_of_quantity(Dimension d) {
  if (d == Dimension::number)
    return R"({"anyOf": [{"type": "number"}, {"type": "string", "pattern": "\\$\\{"}]})";
  std::string units;
  for (const UnitSymbol& unit : unit_table())
    if (unit.dimension == d) units += fmt::format("{}{}", units.empty() ? "" : "|", in_pattern(unit.symbol));
  return fmt::format(
      R"({{"type": "string", "pattern": {}}})",
      in_quotes(
          fmt::format(R"(^\s*[-+]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?\s*({})\s*$|\$\{{)", units)));
}

std::string schema_of_words(std::span<const Word> words) {
  std::vector<std::string> out;
  for (const Word& w : words)
    out.push_back(
        fmt::format(R"({{"const": {}, "description": {}}})", in_quotes(w.word), in_quotes(w.meaning)));
  return any_of(out);
}

std::string with_dimensions(std::string_view text) {
  std::string out(text);
  for (const auto& [word, dimension] :
       {std::pair{"@angle", Dimension::angle}, std::pair{"@speed", Dimension::speed},
        std::pair{"@length", Dimension::length}, std::pair{"@energy", Dimension::energy},
        std::pair{"@frequency", Dimension::frequency}})
    for (std::size_t at = out.find(word); at != out.npos; at = out.find(word))
      out.replace(at, std::string_view(word).size(), schema_of_quantity(dimension));
  return out;
}

std::string schema_of_species() {
  std::vector<Word> names;
  for (const auto& library : {species_library(), species_with_levels()})
    for (const Species& species : library) names.push_back({species.name, species.source});
  const std::string fraction = R"({"type": "number", "exclusiveMinimum": 0, "maximum": 1})";
  Mapping named, share, alone;
  alone.add("name", schema_of_words(names), true);
  named.add("name", schema_of_words(names), true);
  named.add("fraction", fraction, true);
  share.add("fraction", fraction, true);
  std::vector<Word> mixtures;
  for (const Mixture& mixture : natural_mixtures())
    mixtures.push_back({mixture.name, "isotopes in the shares in which nature has them"});
  std::vector<std::string> items = schemas_of_rows<SpeciesWithMoment>(share);
  for (std::string& item : schemas_of_rows<SpeciesWithLevels>(share)) items.push_back(std::move(item));
  items.push_back(named.schema());
  std::vector<std::string> out = schemas_of_rows<SpeciesWithMoment>();
  for (std::string& own : schemas_of_rows<SpeciesWithLevels>()) out.push_back(std::move(own));
  out.push_back(schema_of_words(names));
  out.push_back(schema_of_words(mixtures));
  out.push_back(alone.schema());
  out.push_back(fmt::format(R"({{"type": "array", "minItems": 1, "items": {}}})", any_of(items)));
  return any_of(out);
}

namespace {

std::string schema_of_parts() {
  std::vector<std::string> kinds;
  for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
    for (std::string& schema : schemas_of_part<A>()) kinds.push_back(std::move(schema));
  });
  return fmt::format(R"({{"type": "array", "items": {}}})", any_of(kinds));
}

constexpr const char* schema_of_version = R"({"const": 1, "description": "version of the format"})";
constexpr const char* schema_of_variables =
    R"({"type": "object", "description": "values with a name, put where ${name} stands"})";

std::string schema_of_beamlines() {
  std::vector<Mapping> file(1);
  file.front().add("rabiline", schema_of_version, true);
  file.front().add("geometry", R"({"type": "string", "description": "path of a file with shared parts"})",
                   false);
  add_rows<Beamline>(file);
  std::erase(file.front().required, in_quotes("parts"));  // all may stand in the geometry
  file.front().add("variables", schema_of_variables, false);
  const std::string entry = any_of(schemas_of_rows<ScanEntry>());
  file.front().add("scan", any_of({entry, fmt::format(R"({{"type": "array", "items": {}}})", entry)}), false);
  return file.front().schema();
}

/// What experiments share.
std::string schema_of_geometries() {
  const Row plain{};
  Mapping file;
  file.add("rabiline", schema_of_version, true);
  file.add("title", schema_of<std::string>(plain), false);
  file.add("chamber", schema_of<Chamber>(plain), false);
  file.add("parts", schema_of<std::vector<PlacedPart>>(plain), true);
  return file.schema();
}

std::string schema_of_models() {
  std::vector<Mapping> file(1);
  file.front().add("rabiline", schema_of_version, true);
  add_rows<ModelFile>(file);
  file.front().add("variables", schema_of_variables, false);
  file.front().add("scan", any_of(schemas_of_rows<ScanEntry>()), false);
  return file.front().schema();
}

}  // namespace

std::string json_schema() {
  std::string out = any_of({schema_of_beamlines(), schema_of_geometries(), schema_of_models()});
  out.insert(1,
             fmt::format(R"("$schema": "http://json-schema.org/draft-07/schema#", "title": "rabiline file", )"
                         R"("definitions": {{"parts": {}}}, )",
                         schema_of_parts()));
  return out + "\n";
}

}  // namespace rabiline
