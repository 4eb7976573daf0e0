#pragma once
// One mapping of the file while it is read: which keys were asked for, and so which ones nobody knows.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "input/values.hpp"

namespace rabiline {

class Keys {
 public:
  /// `what` names the mapping in messages ("the slit `S1`"); `blame` is pointed at where a key is missing.
  Keys(const Node& mapping, std::string what, Place blame, Reading&);

  /// The entry of a key, which is known from now on; nullptr where it is not given.
  const Entry* take(std::string_view key);
  /// As take, but a key without a value is an error and counts as not given.
  const Entry* take_value(std::string_view key, bool& given);
  /// Notes a key that must be given and is not.
  void missing(std::string_view key, std::string_view meaning, std::string_view example);
  /// Of a word that stands for a mapping: how that begins, for who has to write it out with what is missing.
  void write_out(std::string beginning) { beginning_ = std::move(beginning); }
  /// Notes a key whose word must be given and is not; it may stand under another key: `type: coil` for
  /// `kind: coil`.
  void missing_word(std::string_view key, std::span<const Word> words);
  /// Reports every key that nobody asked for, and those that are missing: a misspelt one once only.
  /// `owners_of` names what has such a key instead.
  void finish(const std::function<std::vector<std::string>(std::string_view key)>& owners_of = {});
  /// As finish, where nobody knows which keys belong here.
  void finish_unknown();

  const std::string& what() const { return what_; }
  const Place& blame() const { return blame_; }
  void rename(std::string what, Place blame);
  Reading& reading() { return *reading_; }

 private:
  bool is_near_a_known(std::string_view key) const;
  /// Says so of a key without a value, below which another's keys stand.
  void indent_below(const Entry& open, std::string_view key);

  const Node* node_;
  std::string what_, beginning_;
  Place blame_;
  Reading* reading_;
  std::vector<std::string_view> known_;
  struct Missing {
    std::string key, meaning, example;
    Diagnostic diagnostic;
  };
  std::vector<Missing> missing_;
};

}  // namespace rabiline
