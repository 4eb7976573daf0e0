#pragma once
// Words that a key may have, and which of them was meant.
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace rabiline {

/// A word of an enum or the tag of a variant, for messages and help.
struct Word {
  std::string_view word, meaning;
};

/// "`a`, `b` or `c`".
std::string list_of(std::span<const Word>);
std::string list_of(const std::vector<std::string>&);
/// "did you mean `b`?", by its letters or by what it means; empty where none is near.
std::string suggest(std::string_view word, std::span<const Word>);
/// Which of the keys people mean by a word; empty where none is.
std::string key_meant_by(std::string_view said, std::span<const std::string_view> keys);
/// What a key is against the word that was said for it, such as half of a diameter; empty where it is the
/// same.
std::string_view conversion_of(std::string_view said);
/// Where what was said comes from, if it is no key anywhere: a result, an option. Empty otherwise.
std::string_view origin_of(std::string_view said);

}  // namespace rabiline
