// The JSON Schema of beamlines and models, from the same tables that read them. It says less than the reader:
// rules between keys and exact ranges of quantities stay with the reader.
#include "input/beamline_reader.hpp"
#include "input/describe.hpp"
#include "input/model_file.hpp"
#include "input/scan.hpp"
#include "input/tables.hpp"

namespace rabiline {
namespace {

std::string in_quotes(std::string_view text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') out += '\\';
    out += c;
  }
  return out + '"';
}

std::string joined(const std::vector<std::string>& items) {
  std::string out;
  for (const std::string& item : items) out += (out.empty() ? "" : ", ") + item;
  return out;
}
std::string list(const std::vector<std::string>& items) { return fmt::format("[{}]", joined(items)); }
std::string any_of(const std::vector<std::string>& schemas) {
  return schemas.size() == 1 ? schemas.front() : fmt::format(R"({{"anyOf": {}}})", list(schemas));
}

/// A mapping with these keys and no others.
struct Mapping {
  std::vector<std::string> properties, required;

  void add(std::string_view key, const std::string& schema, bool needed) {
    properties.push_back(in_quotes(key) + ": " + schema);
    if (needed) required.push_back(in_quotes(key));
  }
  std::string schema() const {
    return fmt::format(
        R"({{"type": "object", "properties": {{{}}}, "required": {}, "additionalProperties": false}})",
        joined(properties), list(required));
  }
};

std::string schema_of_quantity(Dimension d) {
  if (d == Dimension::number)
    return R"({"anyOf": [{"type": "number"}, {"type": "string", "pattern": "\\$\\{"}]})";
  std::string units;
  for (const UnitSymbol& unit : unit_table())
    if (unit.dimension == d) units += fmt::format("{}{}", units.empty() ? "" : "|", unit.symbol);
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

/// A ValueType's schema with the dimensions it names written out.
std::string with_dimensions(std::string_view text) {
  std::string out(text);
  for (const auto& [word, dimension] :
       {std::pair{"@angle", Dimension::angle}, std::pair{"@speed", Dimension::speed},
        std::pair{"@length", Dimension::length}, std::pair{"@energy", Dimension::energy}})
    if (const std::size_t at = out.find(word); at != out.npos)
      out.replace(at, std::string_view(word).size(), schema_of_quantity(dimension));
  return out;
}

template <class T>
std::string schema_of(const Row& row);

/// Adds the rows of a table to mappings. A row without a key multiplies them: one mapping for each
/// alternative.
template <class T>
void add_rows(std::vector<Mapping>& mappings) {
  for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
    if constexpr (is_variant<M>)
      if (p.key.empty()) {
        std::vector<Mapping> out;
        for_each_alternative<M>([&]<class A>(std::type_identity<A>) {
          std::vector<Mapping> copy = mappings;
          add_rows<A>(copy);
          out.insert(out.end(), copy.begin(), copy.end());
        });
        mappings = std::move(out);
        return;
      }
    std::string schema = schema_of<M>(row_of(p));
    schema.insert(1, fmt::format("\"description\": {}, ", in_quotes(p.meaning)));
    for (Mapping& m : mappings) m.add(p.key, schema, std::is_same_v<D, Required> && !is_optional<M>);
  });
}

template <class T>
std::vector<std::string> schemas_of_rows(Mapping begin = {}) {
  std::vector<Mapping> mappings{std::move(begin)};
  add_rows<T>(mappings);
  std::vector<std::string> out;
  out.reserve(mappings.size());
  for (const Mapping& m : mappings) out.push_back(m.schema());
  return out;
}

template <class V>
std::string schema_of_variant() {
  std::vector<std::string> out;
  for_each_alternative<V>([&]<class A>(std::type_identity<A>) {
    Mapping mapping;
    const std::string constant =
        fmt::format(R"({{"const": {}, "description": {}}})", in_quotes(A::kind), in_quotes(A::meaning));
    if (!tag_key<V>.empty()) {
      mapping.add(tag_key<V>, constant, true);
      if (example_of_rows<A>().empty()) out.push_back(constant);
    }
    for (std::string& schema : schemas_of_rows<A>(mapping)) out.push_back(std::move(schema));
  });
  return any_of(out);
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
  std::vector<std::string> items = schemas_of_rows<SpeciesWithMoment>(share);
  for (std::string& item : schemas_of_rows<SpeciesWithLevels>(share)) items.push_back(std::move(item));
  items.push_back(named.schema());
  std::vector<std::string> out = schemas_of_rows<SpeciesWithMoment>();
  for (std::string& own : schemas_of_rows<SpeciesWithLevels>()) out.push_back(std::move(own));
  out.push_back(schema_of_words(names));
  out.push_back(alone.schema());
  out.push_back(fmt::format(R"({{"type": "array", "minItems": 1, "items": {}}})", any_of(items)));
  return any_of(out);
}

std::string schema_of_parts() {
  std::vector<std::string> kinds;
  for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
    std::vector<Mapping> mappings(1);
    mappings.front().add(
        tag_key<Part>,
        fmt::format(R"({{"const": {}, "description": {}}})", in_quotes(A::kind), in_quotes(A::meaning)),
        true);
    add_rows<Placement>(mappings);
    add_rows<A>(mappings);
    for (const Mapping& m : mappings) kinds.push_back(m.schema());
  });
  return fmt::format(R"({{"type": "array", "items": {}}})", any_of(kinds));
}

template <class T>
std::string schema_of(const Row& row) {
  if constexpr (is_optional<T>)
    return schema_of<typename T::value_type>(row);
  else if constexpr (std::is_same_v<T, double>)
    return schema_of_quantity(row.dimension);
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return fmt::format(R"({{"type": "integer", "minimum": {}}})", row.range.low);
  else if constexpr (std::is_same_v<T, std::string>)
    return R"({"type": ["string", "number"]})";
  else if constexpr (std::is_same_v<T, TallyAxis>) {
    std::vector<std::string> ways = schemas_of_rows<TallyAxis>();
    ways.push_back(R"({"enum": ["level", "prepared_level"]})");
    return any_of(ways);
  } else if constexpr (has_value_type<T>)
    return with_dimensions(ValueType<T>::schema);
  else if constexpr (std::is_same_v<T, Node>)
    return "{\"not\": {\"type\": \"null\"}}";
  else if constexpr (std::is_enum_v<T>)
    return schema_of_words(words_of<T>());
  else if constexpr (is_variant<T>)
    return schema_of_variant<T>();
  else if constexpr (std::is_same_v<T, std::vector<Component>>)
    return schema_of_species();
  else if constexpr (std::is_same_v<T, std::vector<PlacedPart>>)
    return schema_of_parts();
  else if constexpr (is_list<T>)
    return fmt::format(R"({{"type": "array", "minItems": 1, "items": {}}})",
                       schema_of<typename T::value_type>(row));
  else
    return any_of(schemas_of_rows<T>());
}

constexpr const char* schema_of_variables =
    R"({"type": "object", "description": "values with a name, put where ${name} stands"})";

std::string schema_of_beamlines() {
  std::vector<Mapping> file(1);
  file.front().add("rabiline", R"({"const": 1, "description": "version of the format"})", true);
  file.front().add("geometry", R"({"type": "string", "description": "path of a file with shared parts"})",
                   false);
  add_rows<Beamline>(file);
  file.front().add("variables", schema_of_variables, false);
  const std::string entry = any_of(schemas_of_rows<ScanEntry>());
  file.front().add("scan", any_of({entry, fmt::format(R"({{"type": "array", "items": {}}})", entry)}), false);
  return file.front().schema();
}

std::string schema_of_models() {
  std::vector<Mapping> file(1);
  file.front().add("rabiline", R"({"const": 1, "description": "version of the format"})", true);
  add_rows<ModelFile>(file);
  file.front().add("variables", schema_of_variables, false);
  file.front().add("scan", any_of(schemas_of_rows<ScanEntry>()), false);
  return file.front().schema();
}

}  // namespace

std::string json_schema() {
  std::string out = any_of({schema_of_beamlines(), schema_of_models()});
  out.insert(1, R"("$schema": "http://json-schema.org/draft-07/schema#", "title": "rabiline file", )");
  return out + "\n";
}

}  // namespace rabiline
