#pragma once
// YAML text as a plain tree that remembers where everything stood. Only document.cpp knows the YAML library.
#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "core/diagnostics.hpp"

namespace rabiline {

struct Entry;

struct Node {
  enum class Kind { null, scalar, sequence, mapping } kind = Kind::null;
  Place place;                 // a scalar's own text; where a sequence or mapping begins
  std::string scalar;          // of a scalar, without quotes
  bool quoted = false;         // a scalar in quotes is never null
  std::vector<Node> items;     // of a sequence
  std::vector<Entry> entries;  // of a mapping, in the order of the text, no key twice

  bool is_null() const { return kind == Kind::null; }
  bool is_scalar() const { return kind == Kind::scalar; }
  bool is_sequence() const { return kind == Kind::sequence; }
  bool is_mapping() const { return kind == Kind::mapping; }
  /// The entry of that key, or nullptr; a node that is no mapping has none.
  const Entry* find(std::string_view key) const;
  Entry* find(std::string_view key);
};

struct Entry {
  std::string key;
  Place key_place;
  Node value;
};

/// Bounds that keep a hostile file from taking the machine with it.
inline constexpr std::size_t max_text_bytes = std::size_t{1} << 20;
inline constexpr std::size_t max_nodes = 100000;
inline constexpr int max_depth = 32;

/// A text to point into, split into lines.
std::shared_ptr<const SourceText> make_source_text(std::string name, std::string_view text);
/// The tree of one YAML document. Throws InputError.
Node parse_document(const std::shared_ptr<const SourceText>& source, std::string_view text);
/// The tree of a value inside an argument: `argument.substr(from, length)`, with places in the whole
/// argument.
Node parse_value(const std::shared_ptr<const SourceText>& argument, std::size_t from, std::size_t length);
/// The values that it holds, itself included.
std::size_t count_nodes(const Node&);
/// Where a key's value stands, or the node itself where the key is not given.
const Place& place_of(const Node&, std::string_view key);
/// That piece of a scalar's text, or all of it where the text runs over several lines or was escaped.
Place place_within(const Node& scalar, std::size_t from, std::size_t length);
/// The value as one line of YAML, for labels and comparisons.
std::string to_text(const Node&);

}  // namespace rabiline
