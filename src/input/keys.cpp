#include "input/keys.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "input/words.hpp"

namespace rabiline {

namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

bool same_place(const Place& one, const Place& other) {
  return one.line == other.line && one.column == other.column;
}

/// `width: 0,2 mm` in braces: a number, and behind the comma a key that begins with a digit.
bool ends_in_comma(const Entry& before, const Entry& entry) {
  const Node& value = before.value;
  return value.is_scalar() && !value.quoted && !value.scalar.empty() && is_digit(value.scalar.back()) &&
         !entry.key.empty() && is_digit(entry.key.front()) && entry.value.is_null();
}

/// `Bx: min(t, 1)` in braces: a bracket, and behind the comma a key without a value.
bool ends_in_bracket(const Entry& before, const Entry& entry) {
  const Node& value = before.value;
  return value.is_scalar() && !value.quoted && entry.value.is_null() &&
         std::ranges::count(value.scalar, '(') > std::ranges::count(value.scalar, ')');
}

/// Whether what stands behind a comma may be meant as thousands, `647 Hz`: three digits.
bool is_group_of_thousands(std::string_view text) {
  return text.size() >= 3 && std::all_of(text.begin(), text.begin() + 3, is_digit) &&
         (text.size() == 3 || !is_digit(text[3]));
}

/// " (a has)", " (a, b and c have)"; of more than six the first four.
std::string as_having(const std::vector<std::string>& owners) {
  if (owners.empty()) return "";
  if (owners.size() == 1) return fmt::format(" ({} has)", owners.front());
  const std::size_t named = owners.size() > 6 ? 4 : owners.size() - 1;
  return fmt::format(" ({} and {} have)",
                     fmt::join(owners.begin(), owners.begin() + std::ptrdiff_t(named), ", "),
                     owners.size() > 6 ? "others" : owners.back());
}

}  // namespace

Keys::Keys(const Node& mapping, std::string what, Place blame, Reading& reading)
    : node_(&mapping), what_(std::move(what)), blame_(std::move(blame)), reading_(&reading) {}

void Keys::rename(std::string what, Place blame) {
  what_ = std::move(what);
  blame_ = std::move(blame);
}

const Entry* Keys::take(std::string_view key) {
  if (std::find(known_.begin(), known_.end(), key) == known_.end()) known_.push_back(key);
  return node_->find(key);
}

const Entry* Keys::take_value(std::string_view key, bool& given) {
  const Entry* entry = take(key);
  given = entry != nullptr;
  if (!entry || !entry->value.is_null()) return entry;
  reading_->error(entry->key_place, fmt::format("`{}` has no value", key), "write a value after the colon");
  return nullptr;
}

void Keys::missing(std::string_view key, std::string_view meaning, std::string_view example) {
  missing_.push_back({std::string(key),
                      std::string(meaning),
                      std::string(example),
                      {blame_, fmt::format("{} needs `{}`: {}", what_, key, meaning),
                       example.empty() ? std::string{} : fmt::format("add `{}: {}`", key, example)}});
}

void Keys::missing_word(std::string_view key, std::span<const Word> words) {
  const auto elsewhere = std::ranges::find_if(node_->entries, [&](const Entry& entry) {
    return entry.key != "name" && entry.value.is_scalar() &&
           std::ranges::find(words, entry.value.scalar, &Word::word) != words.end();
  });
  if (elsewhere == node_->entries.end()) return missing(key, list_of(words), words[0].word);
  missing(key, list_of(words), elsewhere->value.scalar);
  missing_.back().diagnostic.place = elsewhere->key_place;
  missing_.back().diagnostic.suggestion =
      fmt::format("write `{0}: {1}` for `{2}: {1}`", key, elsewhere->value.scalar, elsewhere->key);
}

bool Keys::is_near_a_known(std::string_view key) const {
  return !closest(std::string(key), {known_.begin(), known_.end()}).empty();
}

void Keys::indent_below(const Entry& open, std::string_view key) {
  for (Diagnostic& d : reading_->errors)
    if (same_place(d.place, open.key_place))
      d.suggestion = fmt::format("keys that belong to `{0}` stand further right than `{0}`: indent `{1}`",
                                 open.key, key);
}

void Keys::finish(const std::function<std::vector<std::string>(std::string_view)>& owners_of) {
  const Entry *before = nullptr, *open = nullptr;  // the latter: a key without a value
  bool in_bracket = false;                         // that a comma has cut
  for (const Entry& entry : node_->entries) {
    const Entry* const last = std::exchange(before, &entry);
    if (std::find(known_.begin(), known_.end(), entry.key) != known_.end()) {
      open = entry.value.is_null() ? &entry : nullptr;
      continue;
    }
    if (open && !is_near_a_known(entry.key)) {  // most likely a key of what has no value
      if (last == open) indent_below(*open, entry.key);
      continue;
    }
    const bool goes_on = std::exchange(in_bracket, false) && entry.value.is_null();
    if (goes_on || (last && ends_in_bracket(*last, entry))) {
      in_bracket = true;
      if (goes_on) continue;
      reading_->error(last->value.place,
                      fmt::format("the comma ends `{}` before its bracket is closed", last->value.scalar),
                      fmt::format("write a formula with commas in quotes: `{}: '{}, ...'`", last->key,
                                  last->value.scalar));
      continue;
    }
    if (last && ends_in_comma(*last, entry)) {
      const Place& place = last->value.place;
      std::erase_if(reading_->errors, [&](const Diagnostic& d) { return same_place(d.place, place); });
      reading_->error(
          place, fmt::format("`{},{}` is not a number: the comma ends it", last->value.scalar, entry.key),
          is_group_of_thousands(entry.key)
              ? fmt::format("numbers have a decimal point, and no commas between thousands: write `{0}.{1}` "
                            "or `{0}{1}`",
                            last->value.scalar, entry.key)
              : fmt::format("numbers have a decimal point: write `{}.{}`", last->value.scalar, entry.key));
      continue;
    }
    const std::vector<std::string> owners = owners_of ? owners_of(entry.key) : std::vector<std::string>{};
    std::string message = fmt::format("{} has no key `{}`{}", what_, entry.key, as_having(owners));
    std::string near = key_meant_by(entry.key, known_);
    const bool is_misspelt = near.empty() || node_->find(near);
    if (is_misspelt)
      near = owners.empty() ? closest(entry.key, {known_.begin(), known_.end()}) : std::string{};
    const auto instead_of = std::ranges::find(missing_, near, &Missing::key);
    const std::string_view conversion = is_misspelt ? "" : conversion_of(entry.key);
    std::string help;
    if (!near.empty() && !conversion.empty())
      help = fmt::format("did you mean `{}`? {}", near, conversion);
    else if (!near.empty() && !is_misspelt && instead_of != missing_.end())
      help = fmt::format("did you mean `{}` ({})?", near, instead_of->meaning);
    else if (!near.empty())
      help = fmt::format("did you mean `{}`?", near);
    else if (const std::string_view origin = origin_of(entry.key); !origin.empty())
      help = origin;
    else
      for (const std::string_view key : known_)
        help += fmt::format("{}`{}`", help.empty() ? "it has " : ", ", key);
    std::erase_if(missing_, [&](const Missing& one) { return one.key == near; });
    reading_->error(entry.key_place, std::move(message), std::move(help));
  }
  finish_unknown();
}

void Keys::finish_unknown() {
  std::string whole = beginning_;
  for (const Missing& one : missing_) whole += fmt::format(", {}: {}", one.key, one.example);
  for (Missing& one : missing_) {
    if (!beginning_.empty()) one.diagnostic.suggestion = fmt::format("write `{}}}`", whole);
    reading_->errors.push_back(std::move(one.diagnostic));
  }
  missing_.clear();
}

}  // namespace rabiline
