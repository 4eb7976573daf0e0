#pragma once
// Reads any struct by its table (parameter/parameter.hpp): the same rows that `describe` prints.
// Every function returns whether `out` is good; what is wrong is in the Reading.
#include <fmt/format.h>

#include <optional>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "input/keys.hpp"
#include "input/tables.hpp"

namespace rabiline {

template <class T>
bool read_value(const Node& node, const Place& named_at, const Row& row, Reading& reading, T& out);

/// These have readers of their own, in beamline_reader.cpp.
bool read_value(const Node& node, const Place& named_at, const Row& row, Reading& reading,
                std::vector<Component>& out);
bool read_value(const Node& node, const Place& named_at, const Row& row, Reading& reading,
                std::vector<PlacedPart>& out);

/// Fills a member from its key, its default, or reports that it is missing.
template <class S, class M, class D>
bool read_row(Keys& keys, const Param<S, M, D>& p, S& out);

/// Fills a struct from the keys of a mapping that may hold further keys.
template <class T>
bool read_rows(Keys& keys, T& out) {
  bool good = true;
  for_each_row<T>([&](const auto& p) { good = read_row(keys, p, out) && good; });
  return good;
}

/// Fills the alternative with that index.
template <class V>
bool read_alternative(Keys& keys, std::size_t index, V& out) {
  bool good = true;
  std::size_t i = 0;
  for_each_alternative<V>([&]<class A>(std::type_identity<A>) {
    if (i++ == index) good = read_rows(keys, out.template emplace<A>());
  });
  return good;
}

/// Which alternatives have that key, for "(rotating_field has)".
template <class V>
std::vector<std::string> owners_of_key(std::string_view key) {
  std::vector<std::string> owners;
  for_each_alternative<V>([&]<class A>(std::type_identity<A>) {
    if (has_key<A>(key)) owners.emplace_back(A::kind);
  });
  return owners;
}

/// Below which keys of T that key stands, for "(`speed` has)".
template <class T>
std::vector<std::string> owners_among_rows(std::string_view key) {
  std::vector<std::string> owners;
  for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
    if constexpr (is_variant<M>)
      if constexpr (!tag_key<M>.empty())
        if (!p.key.empty() && !owners_of_key<M>(key).empty()) owners.push_back(fmt::format("`{}`", p.key));
  });
  return owners;
}

/// A variant told apart by which keys are there. Its keys may stand among others.
template <class V>
bool read_by_keys(Keys& keys, V& out) {
  struct Given {
    std::size_t alternative;
    const Entry* entry;
  };
  std::vector<Given> given;
  std::string ways;
  std::size_t index = 0;
  for_each_alternative<V>([&]<class A>(std::type_identity<A>) {
    std::string way;
    for_each_row<A>([&](const auto& p) {
      if (const Entry* entry = keys.take(p.key)) given.push_back({index, entry});
      way += fmt::format("{}`{}`", way.empty() ? "" : " and ", p.key);
    });
    ways += (index++ == 0 ? "" : ", or ") + way;
  });
  if (given.empty()) {
    keys.reading().error(keys.blame(), fmt::format("{} needs {}: {}", keys.what(), said_by_keys<V>, ways),
                         fmt::format("add `{}`", example_of_rows<std::variant_alternative_t<0, V>>()));
    return false;
  }
  for (const Given& g : given)
    if (g.alternative != given.front().alternative) {
      keys.reading().error(g.entry->key_place, fmt::format("`{}` and `{}` do not go together: give {}",
                                                           given.front().entry->key, g.entry->key, ways));
      return false;
    }
  return read_alternative(keys, given.front().alternative, out);
}

/// A variant told apart by its tag, which stands among the keys of its alternative. `tagged` says whether the
/// tag is good, so that one knows which keys belong here.
template <class V>
bool read_tagged(Keys& keys, const Row& row, V& out, bool& tagged) {
  static constexpr std::string_view tag = tag_key<V>;
  const auto& words = words_of<V>();
  bool given = false;
  const Entry* entry = keys.take_value(tag, given);
  if (!entry) {
    if (!given) keys.missing_word(tag, words);
    return false;
  }
  const std::optional<std::size_t> index =
      read_word(entry->value, {tag, Dimension::number, range::any, row.meaning}, words, keys.reading());
  tagged = index.has_value();
  if (!index) return false;
  keys.rename(row.key.empty() ? fmt::format("this {}", words[*index].word)
                              : fmt::format("the {} `{}`", words[*index].word, row.key),
              entry->value.place);
  return read_alternative(keys, *index, out);
}

/// A word alone is the tag, with every other key left to its default.
template <class V>
bool read_short_form(const Node& node, const Row& row, Reading& reading, V& out) {
  static const Node no_keys{Node::Kind::mapping, {}, {}, false, {}, {}};
  const std::string example = example_of_type<V>(row);
  const std::optional<std::size_t> index =
      read_word(node, row, words_of<V>(), reading, example.starts_with("{") ? example : "");
  if (!index) return false;
  const std::string_view word = words_of<V>()[*index].word;
  Keys keys(no_keys, fmt::format("the {} `{}`", word, row.key), node.place, reading);
  keys.write_out(fmt::format("{}: {{{}: {}", row.key, tag_key<V>, word));
  const bool good = read_alternative(keys, *index, out);
  keys.finish();
  return good;
}

template <class V>
bool read_variant(const Node& node, const Place& named_at, const Row& row, Reading& reading, V& out) {
  if constexpr (!tag_key<V>.empty())
    if (node.is_scalar()) return read_short_form(node, row, reading, out);
  if (!node.is_mapping()) {
    reading.error(node.place,
                  fmt::format("`{}` is a mapping of keys, but {} stands here", row.key, quote(node)),
                  fmt::format("write it like `{}: {}`", row.key, example_of_type<V>(row)));
    return false;
  }
  Keys keys(node, fmt::format("`{}`", row.key), named_at, reading);
  if constexpr (tag_key<V>.empty()) {
    const bool good = read_by_keys(keys, out);
    keys.finish();
    return good;
  } else {
    bool tagged = false;
    const bool good = read_tagged(keys, row, out, tagged);
    if (tagged)
      keys.finish(&owners_of_key<V>);
    else
      keys.finish_unknown();
    return good;
  }
}

template <class T>
bool read_struct(const Node& node, const Place& named_at, const Row& row, Reading& reading, T& out) {
  if constexpr (!short_key<T>.empty())
    if (node.is_scalar()) {
      Node mapping;
      mapping.kind = Node::Kind::mapping;
      mapping.place = node.place;
      mapping.entries.push_back({std::string(short_key<T>), node.place, node});
      return read_struct(mapping, named_at, row, reading, out);
    }
  if (!node.is_mapping()) {
    reading.error(node.place,
                  fmt::format("`{}` is a mapping of keys, but {} stands here", row.key, quote(node)),
                  fmt::format("write it like `{}: {}`", row.key, example_of_type<T>(row)));
    return false;
  }
  Keys keys(node, fmt::format("`{}`", row.key), named_at, reading);
  const bool good = read_rows(keys, out);
  keys.finish(&owners_among_rows<T>);
  return good;
}

/// A mapping in a list.
template <class T>
bool read_entry(const Node& node, const Row& row, Reading& reading, T& out) {
  if (!node.is_mapping()) {
    reading.error(
        node.place,
        fmt::format("each entry of `{}` is a mapping of keys, but {} stands here", row.key, quote(node)),
        fmt::format("write it like `{}: [{}]`", row.key, example_of_type<T>(row)));
    return false;
  }
  Keys keys(node, fmt::format("this entry of `{}`", row.key), node.place, reading);
  const bool good = read_rows(keys, out);
  keys.finish();
  return good;
}

/// A list of one or more values of the same type.
template <class T>
bool read_list(const Node& node, const Row& row, Reading& reading, std::vector<T>& out) {
  out.clear();
  if (!node.is_sequence() || node.items.empty()) {
    reading.error(node.place,
                  fmt::format("`{}` is a list, but {} stands here", row.key,
                              node.is_sequence() ? "an empty one" : quote(node)),
                  fmt::format("write it like `{}: {}`", row.key, example_of_type<std::vector<T>>(row)));
    return false;
  }
  bool good = true;
  for (const Node& item : node.items) {
    T value{};
    if constexpr (has_table<T> && !has_value_type<T>)
      good = read_entry(item, row, reading, value) && good;
    else
      good = read_value(item, item.place, row, reading, value) && good;
    out.push_back(std::move(value));
  }
  return good;
}

template <class T>
bool read_value(const Node& node, const Place& named_at, const Row& row, Reading& reading, T& out) {
  if constexpr (is_optional<T>)
    return read_value(node, named_at, row, reading, out.emplace());
  else if constexpr (std::is_same_v<T, Node>) {
    out = node;
    return true;
  } else if constexpr (std::is_same_v<T, double>)
    return read_quantity(node, row, reading, out);
  else if constexpr (std::is_same_v<T, std::uint64_t>)
    return read_count(node, row, reading, out);
  else if constexpr (std::is_same_v<T, std::string>)
    return read_text(node, row, reading, out);
  else if constexpr (has_value_type<T>)
    return ValueType<T>::read(node, row, reading, out);
  else if constexpr (is_list<T>)
    return read_list(node, row, reading, out);
  else if constexpr (std::is_enum_v<T>) {
    const std::optional<std::size_t> index = read_word(node, row, words_of<T>(), reading);
    if (index) out = choices<T>[*index].value;
    return index.has_value();
  } else if constexpr (is_variant<T>)
    return read_variant(node, named_at, row, reading, out);
  else
    return read_struct(node, named_at, row, reading, out);
}

template <class S, class M, class D>
bool read_row(Keys& keys, const Param<S, M, D>& p, S& out) {
  M& member = out.*p.member;
  if constexpr (is_variant<M>)
    if (p.key.empty()) return read_by_keys(keys, member);
  bool given = false;
  if (const Entry* entry = keys.take_value(p.key, given))
    return read_value(entry->value, entry->key_place, row_of(p), keys.reading(), member);
  if (given) return false;
  if constexpr (!std::is_same_v<D, Required>)
    member = M(p.fallback);
  else if constexpr (!is_optional<M>) {
    std::string example = example_of_type<M>(row_of(p));
    if constexpr (std::is_same_v<M, Phase>)
      if (keys.take("oscillator")) example = "locked";  // a follower has no time of emission of its own
    keys.missing(p.key, p.meaning, example);
    return false;
  }
  return true;
}

}  // namespace rabiline
