#pragma once
// Pages of `describe`, made from the tables that the reader uses.
#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "input/tables.hpp"

namespace rabiline {

/// A table for people: one row per key, columns aligned.
class Page {
 public:
  explicit Page(std::string head) : text_(std::move(head)) { text_ += '\n'; }
  void row(std::string key, std::string what, std::string need, std::string_view meaning) {
    rows_.push_back({std::move(key), std::move(what), std::move(need), std::string(meaning)});
  }
  void line(std::string_view text) {
    flush();
    text_ += fmt::format("{}\n", text);
  }
  std::string finish() {
    flush();
    return std::move(text_);
  }

 private:
  void flush() {
    std::array<std::size_t, 3> width{};
    for (const auto& row : rows_)
      for (std::size_t i = 0; i < width.size(); ++i) width[i] = std::max(width[i], row[i].size());
    for (const auto& [key, what, need, meaning] : rows_) {
      std::string line =
          fmt::format("  {:{}}  {:{}}  {:{}}  {}", key, width[0], what, width[1], need, width[2], meaning);
      line.erase(line.find_last_not_of(' ') + 1);
      text_ += line + '\n';
    }
    rows_.clear();
  }

  std::string text_;
  std::vector<std::array<std::string, 4>> rows_;
};

/// "width and height | radius", "quantum | classical | dorado".
template <class T>
std::string ways_to_write() {
  std::string out;
  if constexpr (is_variant<T>) {
    for_each_alternative<T>([&]<class A>(std::type_identity<A>) {
      std::string way;
      if (tag_key<T>.empty())
        for_each_row<A>(
            [&](const auto& p) { way += fmt::format("{}{}", way.empty() ? "" : " and ", p.key); });
      else
        way = A::kind;
      out += (out.empty() ? "" : " | ") + way;
    });
  } else
    for (const Word& w : words_of<T>()) out += fmt::format("{}{}", out.empty() ? "" : " | ", w.word);
  return out;
}

/// What kind of value a row takes.
template <class M>
std::string kind_of_value(const Row& row) {
  if constexpr (is_optional<M>)
    return kind_of_value<typename M::value_type>(row);
  else if constexpr (std::is_same_v<M, double>) {
    const bool anything = row.range.words == range::any.words;
    return std::string(name_of(row.dimension)) + (anything ? "" : fmt::format(", {}", row.range.words));
  } else if constexpr (std::is_same_v<M, std::uint64_t>)
    return fmt::format("whole number, {}", row.range.words);
  else if constexpr (std::is_same_v<M, std::string>)
    return "text";
  else if constexpr (has_value_type<M>)
    return std::string(ValueType<M>::what);
  else if constexpr (std::is_same_v<M, Node>)
    return "value";
  else if constexpr (std::is_enum_v<M>)
    return choices<M>.size() > 6 ? "one of these words" : ways_to_write<M>();
  else if constexpr (is_variant<M>)
    return ways_to_write<M>();
  else if constexpr (has_table<M>) {
    std::string keys;
    for_each_row<M>([&]<class S, class T, class D>(const Param<S, T, D>& p) {
      keys += keys.empty() ? "" : ", ";
      if constexpr (is_variant<T>)
        keys += p.key.empty() ? ways_to_write<T>() : std::string(p.key);
      else
        keys += p.key;
    });
    return "{" + keys + "}";
  } else if constexpr (is_list<M>)
    return "list of " + kind_of_value<typename M::value_type>(row);
  else if constexpr (std::is_same_v<M, std::vector<Component>>)
    return "name of a species, or its keys";
  else
    return "list";
}

template <class M, class D>
std::string need_of(const Row& row, const D& fallback) {
  if constexpr (std::is_same_v<D, Required> && !is_optional<M>)
    return "required";
  else if constexpr (std::is_same_v<D, UnitVector>)
    return fmt::format("default {}{}", fallback.x + fallback.y + fallback.z < 0 ? "-" : "",
                       fallback.x != 0   ? "x"
                       : fallback.y != 0 ? "y"
                                         : "z");
  else if constexpr (requires { std::string_view(D::kind); })
    return fmt::format("default {}", D::kind);
  else if constexpr (std::is_same_v<D, bool>)
    return fallback ? "default true" : "default false";
  else if constexpr (std::is_arithmetic_v<D>)
    return row.dimension == Dimension::angle && fallback != 0
               ? fmt::format("default {:.4g} deg",
                             static_cast<double>(fallback) * 180 / 3.14159265358979323846)
               : "default " + pretty_quantity(static_cast<double>(fallback), row.dimension);
  else if constexpr (std::is_enum_v<D>) {
    for (const Choice<D>& choice : choices<D>)
      if (choice.value == fallback) return fmt::format("default {}", choice.word);
    return {};
  } else if constexpr (std::is_same_v<D, std::string_view>)
    return fallback.empty() ? "optional" : fmt::format("default \"{}\"", fallback);
  else
    return "optional";
}

/// The rows of a table; choices are explained under their key. `at`: what that key means here, if anything
/// else.
template <class T>
void add_rows(Page& page, std::string_view at = {}) {
  for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
    if constexpr (is_variant<M>)
      if (p.key.empty()) {
        for_each_alternative<M>([&]<class A>(std::type_identity<A>) {
          for_each_row<A>([&]<class S2, class M2, class D2>(const Param<S2, M2, D2>& q) {
            page.row(std::string(q.key), kind_of_value<M2>(row_of(q)),
                     fmt::format("one of: {}", ways_to_write<M>()), q.meaning);
          });
        });
        return;
      }
    page.row(std::string(p.key), kind_of_value<M>(row_of(p)), need_of<M>(row_of(p), p.fallback),
             p.key == "at" && !at.empty() ? at : p.meaning);
    if constexpr (is_optional<M>) {
      if constexpr (std::is_enum_v<typename M::value_type>)
        for (const Word& w : words_of<typename M::value_type>())
          page.row("", std::string(w.word), "", w.meaning);
    } else if constexpr (std::is_enum_v<M>)
      for (const Word& w : words_of<M>()) page.row("", std::string(w.word), "", w.meaning);
  });
}

/// One kind of part.
template <class A>
std::string describe_part() {
  Page page(fmt::format("{}: {}", A::kind, A::meaning));
  if constexpr (requires { A::place; })
    add_rows<Placement>(page, A::place);
  else
    add_rows<Placement>(page);
  add_rows<A>(page);
  std::string snippet = fmt::format("{{name: my_{0}, kind: {0}, at: 0.25 m", A::kind);
  page.line(fmt::format("\nExample\n  - {}, {}}}", snippet, example_of_rows<A>()));
  return page.finish();
}

template <class A>
void add_alternative(Page& page, std::string_view tag) {
  page.line(fmt::format("{}{}: {}", tag.empty() ? "" : fmt::format("{}: ", tag), A::kind, A::meaning));
  add_rows<A>(page);
}

/// All alternatives of a variant, each with its keys.
template <class V>
std::string describe_variant(std::string_view key, std::string_view meaning) {
  Page page(fmt::format("{}: {}", key, meaning));
  for_each_alternative<V>([&]<class A>(std::type_identity<A>) {
    page.line("");
    add_alternative<A>(page, tag_key<V>);
  });
  page.line(fmt::format("\nExample\n  {}: {}", key, example_of_type<V>({})));
  return page.finish();
}

}  // namespace rabiline
