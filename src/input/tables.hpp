#pragma once
// What the tables (parameter/parameter.hpp) say of a type: its keys, its words, and one way to write it.
#include <fmt/format.h>

#include <array>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "input/values.hpp"

namespace rabiline {

template <class T>
inline constexpr bool is_optional = false;
template <class T>
inline constexpr bool is_optional<std::optional<T>> = true;
template <class T>
inline constexpr bool is_variant = false;
template <class... A>
inline constexpr bool is_variant<std::variant<A...>> = true;
template <class T>
inline constexpr bool is_list = false;
template <class T>
inline constexpr bool is_list<std::vector<T>> = true;
template <>
inline constexpr bool is_list<std::vector<Component>> = false;  // these two have readers of their own
template <>
inline constexpr bool is_list<std::vector<PlacedPart>> = false;
template <class T>
inline constexpr bool has_table = std::tuple_size_v<std::remove_const_t<decltype(parameters<T>)>> > 0;

template <class S, class M, class D>
Row row_of(const Param<S, M, D>& p) {
  Row row{p.key, p.dimension, p.range, p.meaning};
  if constexpr (requires { S::example; }) row.example = value_in(S::example, p.key);
  return row;
}

/// Calls f(type_identity<Alternative>) for each alternative, in order.
template <class Variant, class F>
constexpr void for_each_alternative(F f) {
  [&]<std::size_t... I>(std::index_sequence<I...>) {
    (f(std::type_identity<std::variant_alternative_t<I, Variant>>{}), ...);
  }
  (std::make_index_sequence<std::variant_size_v<Variant>>{});
}

/// Calls f(row) for each row of a table.
template <class T, class F>
constexpr void for_each_row(F f) {
  std::apply([&](const auto&... p) { (f(p), ...); }, parameters<T>);
}

/// The tags of a variant, or the words of an enum.
template <class T>
const auto& words_of() {
  if constexpr (is_variant<T>) {
    static const auto words = [] {
      std::array<Word, std::variant_size_v<T>> out;
      std::size_t i = 0;
      for_each_alternative<T>([&]<class A>(std::type_identity<A>) { out[i++] = {A::kind, A::meaning}; });
      return out;
    }();
    return words;
  } else {
    static const auto words = [] {
      std::array<Word, choices<T>.size()> out;
      for (std::size_t i = 0; i < out.size(); ++i) out[i] = {choices<T>[i].word, choices<T>[i].meaning};
      return out;
    }();
    return words;
  }
}

/// Whether a table has that key, also through rows whose keys stand in the same mapping.
template <class T>
bool has_key(std::string_view key) {
  bool found = false;
  if constexpr (is_variant<T>)
    for_each_alternative<T>([&]<class A>(std::type_identity<A>) { found = found || has_key<A>(key); });
  else
    for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
      if constexpr (is_variant<M>)
        if (p.key.empty()) found = found || has_key<M>(key);
      found = found || (!p.key.empty() && p.key == key);
    });
  return found;
}

template <class T>
std::string example_of_type(const Row& row);

/// Optional numbers and words are left out only where another key stands for them.
template <class M, class D>
inline constexpr bool in_example = std::is_same_v<D, Required> && !is_optional<M>;
template <class D>
inline constexpr bool in_example<std::optional<double>, D> = true;
template <class E, class D>
requires std::is_enum_v<E>
inline constexpr bool in_example<std::optional<E>, D> = true;

/// "width: 0.2 mm, height: 0.2 mm": every key that must be given; of some structs an example of their own,
/// whose values go together.
template <class T>
std::string example_of_rows() {
  if constexpr (requires { T::example; }) return std::string(T::example);
  std::string out;
  for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
    if constexpr (in_example<M, D>) {
      std::string item = example_of_type<M>(row_of(p));
      if (p.key.empty())
        item = item.substr(1, item.size() - 2);
      else
        item = fmt::format("{}: {}", p.key, item);
      out += (out.empty() ? "" : ", ") + item;
    }
  });
  return out;
}

/// The same, and the first key of a table where none must be given.
template <class T>
std::string example_of_table() {
  std::string rows = example_of_rows<T>();
  if (!rows.empty()) return rows;
  const auto& first = std::get<0>(parameters<T>);
  return fmt::format("{}: {}", first.key, example_for(row_of(first)));
}

/// One way to write a value of that type, as it would stand in the file.
template <class T>
std::string example_of_type(const Row& row) {
  if (!row.example.empty()) return std::string(row.example);
  if constexpr (is_optional<T>)
    return example_of_type<typename T::value_type>(row);
  else if constexpr (std::is_enum_v<T>)
    return std::string(choices<T>[0].word);
  else if constexpr (has_value_type<T> && !std::is_same_v<T, SpeedQuantity>)
    return std::string(ValueType<T>::example);
  else if constexpr (is_list<T>)
    return fmt::format("[{}]", example_of_type<typename T::value_type>(row));
  else if constexpr (is_variant<T>) {
    using First = std::variant_alternative_t<0, T>;
    if constexpr (tag_key<T>.empty()) return fmt::format("{{{}}}", example_of_rows<First>());
    const std::string rows = example_of_rows<First>();
    return rows.empty() ? std::string(First::kind)
                        : fmt::format("{{{}: {}, {}}}", tag_key<T>, First::kind, rows);
  } else if constexpr (has_table<T>)
    return fmt::format("{{{}}}", example_of_table<T>());
  else
    return example_for(row);
}

}  // namespace rabiline
