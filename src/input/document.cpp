#include "input/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <map>
#include <optional>
#include <sstream>
#include <utility>

#include "input/yaml_faults.hpp"

namespace rabiline {
namespace {

[[noreturn]] void refuse(Place place, std::string message, std::string suggestion = {}) {
  throw InputError({Diagnostic{std::move(place), std::move(message), std::move(suggestion)}});
}

/// Characters from byte `from` up to `to`: carets are counted in characters, columns in bytes.
int characters(std::string_view line, std::size_t from, std::size_t to) {
  int count = 0;
  for (std::size_t i = from; i < to && i < line.size(); ++i)
    if ((static_cast<unsigned char>(line[i]) & 0xc0U) != 0x80U) ++count;
  return count;
}

/// The byte after a quoted scalar that begins at `from`, or npos where it does not end in its line.
std::size_t end_of_quoted(std::string_view line, std::size_t from) {
  const char quote = line[from];
  for (std::size_t i = from + 1; i < line.size(); ++i) {
    const bool escapes = quote == '"' && line[i] == '\\';
    const bool doubled = quote == '\'' && line.substr(i, 2) == "''";
    if (escapes || doubled)
      ++i;
    else if (line[i] == quote)
      return i + 1;
  }
  return std::string_view::npos;
}

// `{` and `}` would end a plain value inside of braces, so the parser sees those of `${name}` as bytes that
// no text holds.
constexpr char hidden_open = '\x01', hidden_close = '\x02';

std::string hide_variables(std::string text) {
  const auto of_name = [](char c) {
    return c == '_' || (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
  };
  for (std::size_t from = 0; (from = text.find("${", from)) != std::string::npos; from += 2) {
    std::size_t end = from + 2;
    while (end < text.size() && of_name(text[end])) ++end;
    if (end == text.size() || text[end] != '}') continue;
    text[from + 1] = hidden_open;
    text[end] = hidden_close;
  }
  return text;
}

std::string with_variables(std::string text) {
  std::replace(text.begin(), text.end(), hidden_open, '{');
  std::replace(text.begin(), text.end(), hidden_close, '}');
  return text;
}

/// Builds the tree from the parser's events. The library's own tree forgets duplicate keys, follows aliases
/// for ever and needs a hundred times the memory of its text.
class TreeBuilder final : public YAML::EventHandler {
 public:
  /// `shift`: what is read begins so many columns into the source's only line.
  explicit TreeBuilder(std::shared_ptr<const SourceText> source, std::size_t shift = 0)
      : source_(std::move(source)), shift_(shift) {}
  Node take_root() { return std::move(root_); }

  Place place_of(const YAML::Mark& mark, std::string_view plain = {}) const {
    if (mark.line < 0) return {source_, 0, 0, 1};
    const std::size_t from = static_cast<std::size_t>(mark.column) + shift_;
    Place place{source_, mark.line + 1, static_cast<int>(from) + 1, 1};
    if (static_cast<std::size_t>(place.line) > source_->lines.size()) return place;
    const std::string_view line = source_->lines[static_cast<std::size_t>(mark.line)];
    if (from >= line.size()) return place;
    std::size_t end = from + 1;
    if (line[from] == '"' || line[from] == '\'')
      end = std::min(end_of_quoted(line, from), line.size());
    else if (!plain.empty() && line.substr(from).starts_with(plain))
      end = from + plain.size();
    place.length = std::max(1, characters(line, from, end));
    return place;
  }

  void OnDocumentStart(const YAML::Mark& mark) override {
    if (!std::exchange(begun_, true)) return;
    const Place place = place_of(mark);
    const bool separated = source_->lines[static_cast<std::size_t>(mark.line)].starts_with("---");
    refuse(place,
           separated ? "a second document begins here, but a file holds one experiment"
                     : "this belongs to nothing above it",
           separated ? "put the second experiment into a file of its own"
                     : "keys that belong together must begin in the same column");
  }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    Node node;
    node.place = place_of(mark);
    complete(std::move(node), anchor);
  }
  void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                const std::string& value) override {
    refuse_tag(mark, tag);
    Node node;
    node.kind = Node::Kind::scalar;
    node.scalar = with_variables(value);
    node.quoted = tag == "!";
    node.place = place_of(mark, node.scalar);
    if (node.quoted) refuse_open_quote(mark, node.place);
    complete(std::move(node), anchor);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                       YAML::EmitterStyle::value) override {
    refuse_tag(mark, tag);
    open(Node::Kind::sequence, mark, anchor);
  }
  void OnSequenceEnd() override { close(); }
  void OnMapStart(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  YAML::EmitterStyle::value) override {
    refuse_tag(mark, tag);
    open(Node::Kind::mapping, mark, anchor);
  }
  void OnMapEnd() override { close(); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
    const auto found = anchors_.find(anchor);
    if (found == anchors_.end())
      refuse(place_of(mark), "this alias stands inside what it stands for, so the value would never end",
             "write the value out");
    Node copy = found->second;
    count(count_nodes(copy), mark);
    complete(std::move(copy), 0);
  }

 private:
  struct Unfinished {
    Node node;
    std::optional<Entry> waiting;  // a key that still lacks its value
    YAML::anchor_t anchor;
  };

  void refuse_tag(const YAML::Mark& mark, const std::string& tag) const {
    if (!tag.empty() && tag != "?" && tag != "!")
      refuse(place_of(mark), fmt::format("the YAML tag `{}` has no meaning here", tag), "leave the tag away");
  }

  /// The library takes a text whose closing quote is missing for one that goes on to the end of the file.
  void refuse_open_quote(const YAML::Mark& mark, const Place& place) const {
    const std::string_view line = source_->lines[static_cast<std::size_t>(mark.line)];
    const auto from = static_cast<std::size_t>(mark.column) + shift_;
    const bool quote = from < line.size() && (line[from] == '"' || line[from] == '\'');
    if (quote && end_of_quoted(line, from) == line.npos)
      refuse(place, "the text in quotes does not end in its line", "add the closing quote");
  }

  void count(std::size_t more, const YAML::Mark& mark) {
    nodes_ += more;
    if (nodes_ > max_nodes)
      refuse(place_of(mark),
             fmt::format("the file holds more than {} values (aliases count as often as they are used)",
                         max_nodes));
  }

  void open(Node::Kind kind, const YAML::Mark& mark, YAML::anchor_t anchor) {
    if (static_cast<int>(open_.size()) >= max_depth)
      refuse(place_of(mark), fmt::format("values are nested more than {} deep", max_depth));
    Unfinished unfinished{{}, {}, anchor};
    unfinished.node.kind = kind;
    unfinished.node.place = place_of(mark);
    open_.push_back(std::move(unfinished));
    count(1, mark);
  }

  void close() {
    Unfinished done = std::move(open_.back());
    open_.pop_back();
    complete(std::move(done.node), done.anchor);
  }

  void complete(Node node, YAML::anchor_t anchor) {
    const YAML::Mark mark = mark_of(node.place);
    if (anchor) {
      count(count_nodes(node), mark);
      anchors_[anchor] = node;
    }
    count(1, mark);
    if (open_.empty()) {
      root_ = std::move(node);
      return;
    }
    Unfinished& parent = open_.back();
    if (parent.node.is_sequence())
      parent.node.items.push_back(std::move(node));
    else if (parent.waiting) {
      parent.waiting->value = std::move(node);
      parent.node.entries.push_back(std::move(*parent.waiting));
      parent.waiting.reset();
    } else
      begin_entry(parent, std::move(node));
  }

  void begin_entry(Unfinished& parent, Node key) {
    if (!key.is_scalar() || key.scalar.empty())
      refuse(key.place, "a key is a word, followed by a colon and its value", "write `key: value`");
    const std::size_t colon = key.scalar.find(':');
    if (!key.quoted && colon != 0 && colon < key.scalar.size() - 1) refuse_narrow_colon(key, colon);
    if (const Entry* first = parent.node.find(key.scalar))
      refuse(key.place,
             fmt::format("`{}` is given twice; it was first given in line {}", key.scalar,
                         first->key_place.line),
             "keep one of them");
    parent.waiting = Entry{std::move(key.scalar), std::move(key.place), {}};
  }

  static void refuse_narrow_colon(const Node& key, std::size_t colon) {
    refuse(key.place, "a space is missing behind the colon",
           fmt::format("write `{}: {}`", key.scalar.substr(0, colon), key.scalar.substr(colon + 1)));
  }

  YAML::Mark mark_of(const Place& place) const {
    YAML::Mark mark;
    mark.line = place.line - 1;
    mark.column = place.column - 1 - static_cast<int>(shift_);
    return mark;
  }

  std::shared_ptr<const SourceText> source_;
  std::size_t shift_;
  Node root_;
  std::vector<Unfinished> open_;
  std::map<YAML::anchor_t, Node> anchors_;
  std::size_t nodes_ = 0;
  bool begun_ = false;
};

/// Where the text stops being UTF-8 or holds a control character that no text has, or npos.
std::size_t find_bad_byte(std::string_view text) {
  for (std::size_t i = 0; i < text.size();) {
    const auto lead = static_cast<unsigned char>(text[i]);
    const std::size_t size = lead < 0x80   ? 1
                             : lead < 0xc2 ? 0
                             : lead < 0xe0 ? 2
                             : lead < 0xf0 ? 3
                             : lead < 0xf5 ? 4
                                           : 0;
    if (size == 0 || i + size > text.size()) return i;
    if (lead < 0x20 && lead != '\t' && lead != '\n' && lead != '\r') return i;
    char32_t c = size == 1 ? lead : lead & (0x7fU >> size);
    for (std::size_t k = 1; k < size; ++k) {
      const auto next = static_cast<unsigned char>(text[i + k]);
      if ((next & 0xc0U) != 0x80U) return i;
      c = (c << 6) | (next & 0x3fU);
    }
    const bool overlong = (size == 3 && c < 0x800) || (size == 4 && c < 0x10000);
    if (overlong || (c >= 0xd800 && c < 0xe000) || c > 0x10ffff || c == 0x7f) return i;
    i += size;
  }
  return std::string_view::npos;
}

Place place_at(const std::shared_ptr<const SourceText>& source, std::string_view text, std::size_t byte) {
  int line = 1;
  std::size_t line_begin = 0;
  for (std::size_t i = 0; i < byte; ++i)
    if (text[i] == '\n') {
      ++line;
      line_begin = i + 1;
    }
  return {source, line, static_cast<int>(byte - line_begin) + 1, 1};
}

void refuse_what_yaml_mistakes(const std::shared_ptr<const SourceText>& source, std::string_view text) {
  if (text.size() > max_text_bytes)
    refuse({source, 0, 0, 1},
           fmt::format("the file is larger than {} bytes: no experiment is that long", max_text_bytes));
  if (const std::size_t bad = find_bad_byte(text); bad != std::string_view::npos)
    refuse(
        place_at(source, text, bad),
        fmt::format("the byte 0x{:02x} is not text (files are UTF-8)", static_cast<unsigned char>(text[bad])),
        "save the file as UTF-8");
  for (std::size_t i = 0; i < source->lines.size(); ++i) {
    const std::string& line = source->lines[i];
    const std::size_t word = line.find_first_not_of(" \t");
    const std::size_t tab = line.find('\t');
    if (word != std::string::npos && line[word] != '#' && tab < word)
      refuse({source, static_cast<int>(i) + 1, static_cast<int>(tab) + 1, 1},
             "the line is indented with a tab, which YAML forbids", "indent with spaces");
  }
}

}  // namespace

const Entry* Node::find(std::string_view key) const {
  for (const Entry& entry : entries)
    if (entry.key == key) return &entry;
  return nullptr;
}
Entry* Node::find(std::string_view key) { return const_cast<Entry*>(std::as_const(*this).find(key)); }

std::shared_ptr<const SourceText> make_source_text(std::string name, std::string_view text) {
  auto source = std::make_shared<SourceText>();
  source->name = std::move(name);
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t end = std::min(text.find('\n', from), text.size());
    std::string_view line = text.substr(from, end - from);
    if (line.ends_with('\r')) line.remove_suffix(1);
    source->lines.emplace_back(line);
    from = end + 1;
  }
  if (source->lines.size() > 1 && source->lines.back().empty()) source->lines.pop_back();
  return source;
}

namespace {

Node parse(TreeBuilder builder, std::string_view text) {
  try {
    std::istringstream stream{hide_variables(std::string(text))};
    YAML::Parser parser(stream);
    if (!parser.HandleNextDocument(builder)) return {};
    parser.HandleNextDocument(builder);  // refuses what it finds
  } catch (const YAML::Exception& e) {
    throw InputError({explain_yaml(builder.place_of(e.mark), e.msg)});
  }
  return builder.take_root();
}

}  // namespace

Node parse_document(const std::shared_ptr<const SourceText>& source, std::string_view text) {
  refuse_what_yaml_mistakes(source, text);
  return parse(TreeBuilder(source), text);
}

Node parse_value(const std::shared_ptr<const SourceText>& argument, std::size_t from, std::size_t length) {
  const std::string_view value = std::string_view(argument->lines.front()).substr(from, length);
  if (find_bad_byte(value) != value.npos) refuse_what_yaml_mistakes(argument, argument->lines.front());
  return parse(TreeBuilder(argument, from), value);
}

const Place& place_of(const Node& node, std::string_view key) {
  const Entry* entry = node.find(key);
  return entry ? entry->value.place : node.place;
}

Place place_within(const Node& node, std::size_t from, std::size_t length) {
  Place place = node.place;
  const auto written = static_cast<int>(node.scalar.size()) + (node.quoted ? 2 : 0);
  if (place.length != written) return place;
  place.column += static_cast<int>(from) + (node.quoted ? 1 : 0);
  place.length = static_cast<int>(length);
  return place;
}

std::string to_text(const Node& node) {
  std::string out;
  switch (node.kind) {
    case Node::Kind::null:
      return "~";
    case Node::Kind::scalar:
      return node.scalar;
    case Node::Kind::sequence:
      for (const Node& item : node.items) out += (out.empty() ? "" : ", ") + to_text(item);
      return "[" + out + "]";
    case Node::Kind::mapping:
      for (const Entry& entry : node.entries)
        out += (out.empty() ? "" : ", ") + entry.key + ": " + to_text(entry.value);
      return "{" + out + "}";
  }
  return out;
}

std::size_t count_nodes(const Node& node) {
  std::size_t count = 1;
  for (const Node& item : node.items) count += count_nodes(item);
  for (const Entry& entry : node.entries) count += count_nodes(entry.value);
  return count;
}

}  // namespace rabiline
