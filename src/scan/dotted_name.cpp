#include "scan/dotted_name.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "input/beamline_reader.hpp"
#include "input/tables.hpp"
#include "scan/model_file.hpp"

namespace rabiline {
namespace {

constexpr std::size_t most_words = max_depth;

/// The words between the dots, each with its own place.
struct Segment {
  std::string word;
  Place place;
};
std::vector<Segment> split(const std::string& name, const Place& name_place) {
  std::vector<Segment> out;
  for (std::size_t from = 0; from <= name.size();) {
    const std::size_t end = std::min(name.find('.', from), name.size());
    Place place = name_place;
    place.column += static_cast<int>(from);
    place.length = std::max(1, static_cast<int>(end - from));
    out.push_back({name.substr(from, end - from), place});
    from = end + 1;
  }
  return out;
}

Node* find_part(Node& root, std::string_view name) {
  Entry* parts = root.find("parts");
  if (!parts) return nullptr;
  for (Node& item : parts->value.items)
    if (const Entry* entry = item.find("name"); entry && entry->value.scalar == name) return &item;
  return nullptr;
}

/// Every dotted name that has a value in the tree, for suggestions.
void collect_names(const Node& node, const std::string& prefix, std::vector<std::string>& out) {
  for (const Entry& entry : node.entries) {
    const std::string name = prefix.empty() ? entry.key : prefix + "." + entry.key;
    const bool refers = entry.key == "name" || entry.key == "kind" || entry.key == "label";
    if (!refers || prefix.empty()) out.push_back(name);
    if (entry.value.is_mapping()) collect_names(entry.value, name, out);
  }
}
std::vector<std::string> names_in(const Node& root) {
  std::vector<std::string> out;
  for (const Entry& entry : root.entries) {
    if (entry.key == "parts") {
      for (const Node& item : entry.value.items)
        if (const Entry* name = item.find("name")) collect_names(item, name->value.scalar, out);
    } else if (entry.key != "rabiline" && entry.key != "geometry" && entry.key != "scan" &&
               entry.key != "title") {
      out.push_back(entry.key);
      collect_names(entry.value, entry.key, out);
    }
  }
  return out;
}

void unknown_name(const Node& root, const std::string& name, const Segment& first, Reading& reading) {
  const std::vector<std::string> known = names_in(root);
  std::string help;
  for (const std::string& candidate : known)
    if (candidate.ends_with("." + name))
      help += fmt::format("{}`{}`", help.empty() ? "did you mean " : " or ", candidate);
  if (!help.empty()) help += "?";
  if (help.empty()) {
    // Mend the first word alone, so that the rest of the name stays as it was meant.
    std::vector<std::string> heads;
    heads.reserve(known.size());
    for (const std::string& candidate : known) heads.push_back(candidate.substr(0, candidate.find('.')));
    const std::string near = closest(first.word, heads);
    if (!near.empty()) help = fmt::format("did you mean `{}{}`?", near, name.substr(first.word.size()));
  }
  if (help.empty() && root.find("model"))
    help = "a name begins with `model`";
  else if (help.empty())
    help =
        "a name begins with `law`, `species`, `source`, `chamber`, `particles`, `seed` or the name of a part";
  reading.error(first.place, fmt::format("nothing in the file is called `{}`", first.word), std::move(help));
}

bool refuse_what_is_no_parameter(const std::vector<Segment>& path, const std::string& name, bool is_part,
                                 Node* part, Reading& reading) {
  const std::string& first = path.front().word;
  if (is_part && path.size() == 1) {
    std::string example;
    for (const Entry& entry : part->entries)
      if (example.empty() && entry.key != "name" && entry.key != "kind" && entry.key != "label" &&
          entry.key != "at")
        example = fmt::format("such as `{}.{}`", name, entry.key);
    reading.error(path.front().place, fmt::format("`{}` is a whole part, not one value", name),
                  "name one of its keys, " + example);
    return true;
  }
  if (is_part && path.size() == 2 && path[1].word == "name") {
    reading.error(path[1].place, "the name of a part cannot be changed from here: other values refer to it",
                  "`label` names it in plots");
    return true;
  }
  if (is_part || (first != "rabiline" && first != "geometry" && first != "parts" && first != "scan"))
    return false;
  std::string rest;  // behind `parts`
  for (std::size_t i = 1; i < path.size(); ++i) rest += (i > 1 ? "." : "") + path[i].word;
  const std::string help =
      first == "parts"  ? fmt::format("name the part by itself: `{}`", rest.empty() ? "H0.frequency" : rest)
      : first == "scan" ? "use --scan"
                        : "name a key of the source, the law or a part, such as "
                          "`source.speed.mean`, `law` or `H0.frequency`";
  reading.error(path.front().place, fmt::format("`{}` is not a value that can be set or scanned", first),
                help);
  return true;
}

/// Only variables that the file states: another one would be set and used nowhere.
bool is_variable(const Node& root, const std::vector<Segment>& path, Reading& reading) {
  const Entry* variables = root.find("variables");
  std::vector<std::string> known;
  if (variables)
    for (const Entry& entry : variables->value.entries) known.push_back(entry.key);
  if (path.size() == 1) {
    reading.error(
        path.front().place, "`variables` holds all variables of the file, not one value",
        known.empty() ? "" : fmt::format("name one of them, such as `variables.{}`", known.front()));
    return false;
  }
  if (std::find(known.begin(), known.end(), path[1].word) != known.end()) return true;
  const std::string near = closest(path[1].word, known);
  reading.error(path[1].place, fmt::format("the file has no variable `{}`", path[1].word),
                near.empty() ? fmt::format("state it in the file: `variables: {{{}: 2 mT}}`", path[1].word)
                             : fmt::format("did you mean `variables.{}`?", near));
  return false;
}

/// A scalar on the way to a key is the short form of a mapping.
void write_out(Node& node, std::string_view key, const Place& place) {
  if (node.is_mapping() || node.is_sequence()) return;
  Node mapping;
  mapping.kind = Node::Kind::mapping;
  mapping.place = place;
  if (node.is_scalar()) {
    const bool named = key == "law" || key == "species";
    const std::string_view given = key == "gravity" ? short_key<Gravity>
                                   : named          ? tag_key<Law>
                                                    : tag_key<SpeedLaw>;
    mapping.entries.push_back({std::string(given), node.place, node});
  }
  node = std::move(mapping);
}

}  // namespace

Node* put_value(Node& root, const std::string& name, const Place& name_place, const Node& value,
                Reading& reading) {
  const std::vector<Segment> path = split(name, name_place);
  if (path.size() > most_words) {
    reading.error(path[most_words].place, fmt::format("a name has at most {} words", most_words),
                  "such as `H0.frequency`");
    return nullptr;
  }
  for (const Segment& segment : path)
    if (segment.word.empty()) {
      reading.error(segment.place, "a name is words with one dot between them", "such as `H0.frequency`");
      return nullptr;
    }
  const bool known =
      root.find("model") ? has_key<ModelFile>(path.front().word) : has_key<Beamline>(path.front().word);
  const bool top = known || path.front().word == "rabiline" || path.front().word == "geometry" ||
                   path.front().word == "scan" || path.front().word == "variables";
  Node* part = top ? nullptr : find_part(root, path.front().word);
  if (!top && !part) {
    unknown_name(root, name, path.front(), reading);
    return nullptr;
  }
  if (path.front().word == "variables" && !is_variable(root, path, reading)) return nullptr;
  if (refuse_what_is_no_parameter(path, name, part != nullptr, part, reading)) return nullptr;
  Node* node = part ? part : &root;
  for (std::size_t i = part ? 1 : 0; i < path.size(); ++i) {
    if (!node->is_mapping()) {
      reading.error(path[i].place,
                    fmt::format("`{}` is a list, and its values have no names", path[i - 1].word),
                    fmt::format("set all of `{}`, as a list in brackets", path[i - 1].word));
      return nullptr;
    }
    Entry* entry = node->find(path[i].word);
    if (!entry) entry = &node->entries.emplace_back(Entry{path[i].word, path[i].place, Node{}});
    node = &entry->value;
    if (i + 1 < path.size()) write_out(*node, path[i].word, path[i + 1].place);
  }
  *node = value;
  return node;
}

bool names_overlap(const std::string& a, const std::string& b) {
  return a == b || a.starts_with(b + ".") || b.starts_with(a + ".");
}

}  // namespace rabiline
