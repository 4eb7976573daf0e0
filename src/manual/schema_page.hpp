#pragma once
// The JSON Schema of what a table holds.
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "input/tables.hpp"

namespace rabiline {

/// A mapping with these keys and no others.
struct Mapping {
  std::vector<std::string> properties, required;

  void add(std::string_view key, const std::string& schema, bool needed);
  std::string schema() const;
};
std::string in_quotes(std::string_view text);
std::string any_of(const std::vector<std::string>& schemas);
std::string schema_of_quantity(Dimension);
std::string schema_of_words(std::span<const Word>);
/// A ValueType's schema with the dimensions it names written out.
std::string with_dimensions(std::string_view);
std::string schema_of_species();

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

/// One kind of part.
template <class A>
std::vector<std::string> schemas_of_part() {
  std::vector<Mapping> mappings(1);
  mappings.front().add(
      tag_key<Part>,
      fmt::format(R"({{"const": {}, "description": {}}})", in_quotes(A::kind), in_quotes(A::meaning)), true);
  add_rows<Placement>(mappings);
  add_rows<A>(mappings);
  std::vector<std::string> out;
  out.reserve(mappings.size());
  for (const Mapping& m : mappings) out.push_back(m.schema());
  return out;
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
    return R"({"$ref": "#/definitions/parts"})";
  else if constexpr (is_list<T>)
    return fmt::format(R"({{"type": "array", "minItems": 1, "items": {}}})",
                       schema_of<typename T::value_type>(row));
  else {
    std::vector<std::string> ways = schemas_of_rows<T>();
    for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
      if (!short_key<T>.empty() && p.key == short_key<T>) ways.push_back(schema_of<M>(row_of(p)));
    });
    return any_of(ways);
  }
}

}  // namespace rabiline
