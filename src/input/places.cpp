#include "input/places.hpp"

#include <fmt/format.h>

namespace rabiline {

Places::Places(const Node& root) { add(root, root.place, ""); }

void Places::add(const Node& node, const Place& place, const std::string& name) {
  places_.emplace(name, place);
  for (const Entry& entry : node.entries) {
    const std::string key = dotted_name(name, entry.key);
    const Place& at = entry.value.is_scalar() ? entry.value.place : entry.key_place;
    add(entry.value, at, key);
    if (key == "species" && !entry.value.is_sequence()) add(entry.value, at, "species[0]");
  }
  for (std::size_t i = 0; i < node.items.size(); ++i) {
    const Node& item = node.items[i];
    add(item, item.place, fmt::format("{}[{}]", name, i));
    const Entry* own = name == "parts" ? item.find("name") : nullptr;
    if (own && own->value.is_scalar())
      add(item, item.place, (places_.contains(own->value.scalar) ? "parts." : "") + own->value.scalar);
  }
}

const Place& Places::of(std::string name) const {
  static const Place nowhere;
  for (;;) {
    if (const auto found = places_.find(name); found != places_.end()) return found->second;
    if (name.empty()) return nowhere;
    const std::size_t cut = name.find_last_of(".[");
    name.resize(cut == name.npos ? 0 : cut);
  }
}

Diagnostic Places::locate(const Fault& fault) const {
  std::string name = dotted_name(fault.subject, fault.key);
  if (fault.key == "name" && places_.contains("parts." + name)) name = "parts." + name;  // it is not its own
  return {of(std::move(name)), fault.message, fault.help, fault.severity};
}

}  // namespace rabiline
