// Fields as formulas, which are worked out while they are read.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "field/field_formula.hpp"
#include "input/formula_dimensions.hpp"
#include "input/reader.hpp"

namespace rabiline {

std::shared_ptr<const FormulaMaps> SampledFormulas::find(const FormulaBox& box) {
  const std::scoped_lock lock(mutex_);
  std::erase_if(known_, [](const auto& known) { return known.second.expired(); });
  for (const auto& [formula, maps] : known_)
    if (formula == box) return maps.lock();
  return nullptr;
}

void SampledFormulas::add(const FormulaBox& box, const std::shared_ptr<const FormulaMaps>& maps) {
  const std::scoped_lock lock(mutex_);
  known_.emplace_back(box, maps);
}

bool ValueType<NamedValues>::read(const Node& node, const Row& row, Reading& reading, NamedValues& out) {
  if (!node.is_mapping()) {
    reading.error(
        node.place,
        fmt::format("`{}` is a mapping of names to values, but {} stands here", row.key, quote(node)),
        fmt::format("write it like `{}: {}`", row.key, example));
    return false;
  }
  const std::size_t errors = reading.errors.size();
  for (const Entry& entry : node.entries) {
    if (!can_name_constant(entry.key)) {
      reading.error(
          entry.key_place, fmt::format("`{}` cannot name a constant of a formula", entry.key),
          "a name is a letter, then letters, digits or `_`; x, y, z, t, pi, mu_0 and functions are taken");
      continue;
    }
    const ParsedQuantity value =
        entry.value.is_scalar() ? parse_quantity(entry.value.scalar) : ParsedQuantity{};
    if (!entry.value.is_scalar())
      reading.error(
          entry.value.place,
          fmt::format("`{}` is a number with its unit, but {} stands here", entry.key, quote(entry.value)),
          fmt::format("write it like `{}: 1 mT`", entry.key));
    else if (!value.error.empty())
      reading.error(
          entry.value.place, fmt::format("{} {}", quote(entry.value), value.error),
          value.suggestion.empty() ? fmt::format("write it like `{}: 1 mT`", entry.key) : value.suggestion);
    else
      reading.saw_number(entry.value, value.dimension, value.value);
    out[entry.key] = value.value;
  }
  return reading.errors.size() == errors;
}

namespace {

bool has_word(std::string_view text, std::string_view word) {
  const auto is_letter = [&](std::size_t at) {
    return at < text.size() && (std::isalnum(static_cast<unsigned char>(text[at])) != 0 || text[at] == '_');
  };
  for (std::size_t at = text.find(word); at < text.size(); at = text.find(word, at + 1))
    if ((at == 0 || !is_letter(at - 1)) && !is_letter(at + word.size())) return true;
  return false;
}

/// A constant that no component has is a slip of the pen, or of a name that is set from outside.
void refuse_idle_constants(const Node& node, const auto& components, Reading& reading) {
  const Entry* constants = node.find("constants");
  if (!constants) return;
  for (const Entry& constant : constants->value.entries)
    if (std::ranges::none_of(components, [&](std::string_view key) {
          const Entry* component = node.find(key);
          return component && has_word(component->value.scalar, constant.key);
        }))
      reading.error(constant.key_place, fmt::format("no formula has the constant `{}`", constant.key),
                    "omit it, or write its name as the formulas do");
}

/// Units of constants that cannot be right.
void refuse_misfits(const Node& node, const auto& components, Dimension wanted, Reading& reading) {
  std::map<std::string, Dimension> constants;
  if (const Entry* given = node.find("constants"))
    for (const Entry& constant : given->value.entries)
      constants[constant.key] = parse_quantity(constant.value.scalar).dimension;
  const auto has_constant = [&](const std::string& formula) {
    return std::ranges::any_of(constants, [&](const auto& known) { return has_word(formula, known.first); });
  };
  for (const std::string_view key : components)
    if (const Entry* component = node.find(key); component && has_constant(component->value.scalar))
      if (const auto misfit = misfit_of(component->value.scalar, constants, wanted))
        reading.error(
            place_within(component->value, misfit->from, misfit->length), misfit->message,
            "look at the units of the constants: x, y and z are lengths, t is a time, and a constant without "
            "a unit may be anything in SI, such as 2 T/s");
}

}  // namespace

bool ValueType<SampledFormula>::read(const Node& node, const Row& row, Reading& reading,
                                     SampledFormula& out) {
  out = {};
  const std::size_t errors = reading.errors.size();
  if (!read_struct(node, node.place, row, reading, out.box)) return false;
  constexpr std::string_view magnetic[] = {"Bx", "By", "Bz"}, electric[] = {"Ex", "Ey", "Ez"};
  const auto has = [&](const auto& keys) {
    return std::ranges::any_of(keys, [&](std::string_view key) { return node.find(key) != nullptr; });
  };
  const auto& keys = has(electric) ? electric : magnetic;
  if (!has(keys)) {
    reading.error(node.place, fmt::format("`{}` has no component of the field", row.key),
                  "add `Bx`, `By` or `Bz` [T], such as `Bz: 1e-3*(1 + z/0.1)`");
    return false;
  }
  if (has(magnetic) && has(electric)) {
    reading.error(node.place, fmt::format("`{}` has components of B and of E", row.key),
                  "make two parts of them at the same place");
    return false;
  }
  for (const std::string_view key : {"frequency", "duration"})
    if (has(electric) && node.find(key) != nullptr) {
      reading.error(place_of(node, key), "electric fields stand still", fmt::format("omit `{}`", key));
      return false;
    }
  if (out.box.frequency && out.box.duration) {
    reading.error(place_of(node, "duration"), "a formula with a frequency repeats, and has no duration",
                  "omit `duration`, or `frequency` where it does not repeat");
    return false;
  }
  if (!out.box.frequency && out.box.phase != Phase{}) {
    reading.error(place_of(node, "phase"), "a formula without a frequency has no phase",
                  "state `frequency`, or omit `phase`");
    return false;
  }
  if (reading.errors.size() > errors) return false;
  if (const double places = places_of(out.box); places > most_formula_places) {
    reading.error(
        place_of(node, "step"), fmt::format("the formula would be worked out at {:.2g} places", places),
        fmt::format("make `step` longer, or the box smaller: {:.0g} are the most", most_formula_places));
    return false;
  }
  out.maps = reading.formulas->find(out.box);
  try {
    if (!out.maps) reading.formulas->add(out.box, out.maps = maps_of(out.box));
    refuse_idle_constants(node, keys, reading);
    refuse_misfits(node, keys, has(electric) ? Dimension::electric_field : Dimension::magnetic_field,
                   reading);
  } catch (const FormulaFault& fault) {
    const Place place = fault.component < std::size(keys)
                            ? place_within(node.find(keys[fault.component])->value, fault.from, fault.length)
                            : place_of(node, out.box.duration ? "duration" : "frequency");
    reading.error(place, fault.what(), fault.help);
  }
  return reading.errors.size() == errors;
}

}  // namespace rabiline
