#include "scan/variables.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

namespace rabiline {
namespace {

class Variables {
 public:
  Variables(const Node& mapping, Reading& reading) : reading_(reading) {
    for (const Entry& entry : mapping.entries) values_.push_back({&entry, entry.value, State::unread});
    for (Variable& variable : values_) resolve(variable);
  }

  void put_into(Node& node) {
    if (node.is_scalar()) put_into_scalar(node);
    for (Node& item : node.items) put_into(item);
    for (Entry& entry : node.entries) put_into(entry.value);
  }

 private:
  static constexpr std::size_t longest = 10000;  // text with its variables
  static constexpr std::size_t suggested = 100;  // of more that are not there no more is shown
  static constexpr std::size_t deepest = 100;
  enum class State { unread, open, done };
  struct Variable {
    const Entry* entry;
    Node value;
    State state;
  };

  /// A variable may be written with others; false where it leads back to itself.
  bool resolve(Variable& variable) {
    if (variable.state == State::open) return false;
    if (variable.state == State::done) return true;
    variable.state = State::open;
    ++depth_;
    put_into(variable.value);
    --depth_;
    variable.state = State::done;
    return true;
  }
  /// Whether there is room for one more value with all that it holds.
  bool has_room(const Node& value, const Place& place) {
    if (put_ <= max_nodes && (put_ += count_nodes(value)) > max_nodes)
      reading_.error(place, fmt::format("variables put more than {} values into the file", max_nodes),
                     "a variable stands for one value");
    return put_ <= max_nodes;
  }

  void put_into_scalar(Node& node) {
    for (std::size_t from = 0; (from = node.scalar.find("${", from)) != std::string::npos;) {
      const std::size_t end = node.scalar.find('}', from);
      if (end == std::string::npos)
        return reading_.error(place_within(node, from, node.scalar.size() - from),
                              "the name of a variable does not end", "write `${name}`");
      const std::string name = node.scalar.substr(from + 2, end - from - 2);
      const Place place = place_within(node, from, end + 1 - from);
      const Node* value = value_of(name, place);
      if (value == nullptr) return;
      if (from == 0 && end + 1 == node.scalar.size()) {
        if (!has_room(*value, place)) return;
        const Place used = node.place;
        node = *value;
        node.place = used;  // messages point at where the value is used
        return;
      }
      if (!value->is_scalar())
        return reading_.error(
            place, fmt::format("`{}` is {}, which cannot stand inside of a text", name, quote(*value)),
            "use it as a whole value");
      if (node.scalar.size() + value->scalar.size() > longest)
        return reading_.error(place, fmt::format("the text becomes longer than {} letters", longest),
                              "a variable stands for one value");
      node.scalar.replace(from, end + 1 - from, value->scalar);
      from += value->scalar.size();
    }
  }

  const Node* value_of(const std::string& name, const Place& place) {
    for (Variable& variable : values_) {
      if (variable.entry->key != name) continue;
      if (variable.state == State::unread && depth_ >= deepest) {
        reading_.error(place, fmt::format("variables lead to one another more than {} times", deepest),
                       "write values themselves");
        return nullptr;
      }
      if (resolve(variable)) return &variable.value;
      reading_.error(place, fmt::format("the variable `{}` is needed for its own value", name),
                     "write a value that does not lead back to it");
      return nullptr;
    }
    std::vector<std::string> known;
    if (++unknown_ <= suggested)
      for (const Variable& variable : values_) known.push_back(variable.entry->key);
    const std::string near = closest(name, known);
    reading_.error(place, fmt::format("there is no variable `{}`", name),
                   near.empty() ? fmt::format("state it at the top of the file: `variables: {{{}: 2 mT}}`",
                                              name.empty() ? "B1" : name)
                                : fmt::format("did you mean `{}`?", near));
    return nullptr;
  }

  Reading& reading_;
  std::vector<Variable> values_;
  std::size_t put_ = 0, depth_ = 0, unknown_ = 0;
};

bool has_text(const Node& node, const std::string& text) {
  return node.scalar.find(text) != std::string::npos ||
         std::ranges::any_of(node.items, [&](const Node& item) { return has_text(item, text); }) ||
         std::ranges::any_of(node.entries, [&](const Entry& entry) { return has_text(entry.value, text); });
}

}  // namespace

std::vector<Diagnostic> unused_variables(const Node& root) {
  std::vector<Diagnostic> out;
  const Entry* variables = root.find("variables");
  if (variables == nullptr) return out;
  for (const Entry& variable : variables->value.entries)
    if (!has_text(root, "${" + variable.key + "}"))
      out.push_back({variable.key_place, fmt::format("the variable `{}` stands nowhere", variable.key),
                     fmt::format("write `${{{}}}` where its value is needed, or omit it", variable.key),
                     Severity::warning});
  return out;
}

bool put_variables(Node& root, Reading& reading) {
  static const Node none;
  const std::size_t errors = reading.errors.size();
  const Entry* variables = root.find("variables");
  if (variables && !variables->value.is_mapping()) {
    reading.error(variables->value.place,
                  fmt::format("`variables` is a mapping of names to values, but {} stands here",
                              quote(variables->value)),
                  "write it like `variables: {B1: 2 mT}`, and `${B1}` where the value is needed");
    return false;
  }
  Variables values(variables ? variables->value : none, reading);
  for (Entry& entry : root.entries)
    if (entry.key != "variables") values.put_into(entry.value);
  return reading.errors.size() == errors;
}

}  // namespace rabiline
