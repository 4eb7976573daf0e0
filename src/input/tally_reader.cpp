// An axis of a tally: its quantity says which keys it has and in what they are written.
#include "input/reader.hpp"

namespace rabiline {
namespace {

Range range_of(Quantity q) {
  const Limits& limits = row_of(q).limits;
  return {limits.low, limits.high, true, true, limits.words};
}

/// One way to write an end, with a size that a bench has.
std::string example_of_end(Quantity q, bool from) { return from ? row_of(q).from : row_of(q).to; }

bool read_end(Keys& keys, std::string_view key, Quantity quantity, std::optional<AxisEnd>& out) {
  const bool from = key == "from";
  bool given = false;
  const Entry* entry = keys.take_value(key, given);
  if (!entry) {
    if (!given)
      keys.missing(key, from ? "where the axis begins" : "where it ends", example_of_end(quantity, from));
    return false;
  }
  const std::string example = example_of_end(quantity, from);
  const Row row{key, dimension_of(quantity), range_of(quantity), "", example};
  return read_quantity(entry->value, row, keys.reading(), out.emplace().value);
}

template <class M>
bool read_if_given(Keys& keys, std::string_view key, M& out) {
  bool good = true;
  for_each_row<TallyAxis>([&]<class S, class T, class D>(const Param<S, T, D>& p) {
    if constexpr (std::is_same_v<T, M>)
      if (p.key == key) {
        TallyAxis axis;
        good = read_row(keys, p, axis);
        out = axis.*p.member;
      }
  });
  return good;
}

/// What belongs to other quantities only.
bool refuse(Keys& keys, std::string_view key, const std::string& why) {
  const Entry* entry = keys.take(key);
  if (!entry) return true;
  keys.reading().error(entry->key_place, why, fmt::format("omit `{}`", key));
  return false;
}

bool read_levels(Keys& keys, std::string_view word) {
  bool good = true;
  for (const std::string_view key : {"from", "to", "bins"})
    good = refuse(keys, key,
                  fmt::format("`{}` has one bin for each level from I down to -I, and takes no `{}`", word,
                              key)) &&
           good;
  return refuse(keys, "axis", fmt::format("`{}` is counted along +z, and takes no `axis`", word)) && good;
}

bool read_range(Keys& keys, std::string_view word, TallyAxis& out) {
  bool good = read_end(keys, "from", out.quantity, out.from);
  good = read_end(keys, "to", out.quantity, out.to) && good;
  good = read_if_given(keys, "bins", out.bins) && good;
  if (!keys.take("bins")) {
    keys.missing("bins", "how many the axis has", "100");
    good = false;
  }
  if (out.quantity == Quantity::spin) {
    good = read_if_given(keys, "axis", out.axis) && good;
    if (!keys.take("axis")) {
      keys.missing("axis", "the direction that the spin is projected on", "z");
      good = false;
    }
  } else {
    good = refuse(keys, "axis", fmt::format("`{}` takes no `axis`: only `spin` is projected on one", word)) &&
           good;
  }
  return good;
}

}  // namespace

bool ValueType<AxisEnd>::read(const Node& node, const Row& row, Reading& reading, AxisEnd& out) {
  return read_quantity(node, row, reading, out.value);
}

bool ValueType<TallyAxis>::read(const Node& node, const Row&, Reading& reading, TallyAxis& out) {
  static const Node no_keys{Node::Kind::mapping, {}, {}, false, {}, {}};
  if (!node.is_mapping() && !node.is_scalar()) {
    reading.error(node.place, fmt::format("an axis is a mapping of keys, but {} stands here", quote(node)),
                  fmt::format("write it like `{}`", example));
    return false;
  }
  Keys keys(node.is_mapping() ? node : no_keys, "this axis", node.place, reading);
  const Row quantity{"quantity", Dimension::number, range::any, ""};
  bool given = false;
  const Entry* entry = node.is_mapping() ? keys.take_value("quantity", given) : nullptr;
  if (node.is_mapping() && !entry) {
    if (!given) keys.missing("quantity", "what the axis is over", "time_of_flight");
    keys.finish_unknown();
    return false;
  }
  const Node& word = entry ? entry->value : node;
  const std::optional<std::size_t> index = read_word(word, quantity, words_of<Quantity>(), reading);
  if (!index) return false;
  out.quantity = choices<Quantity>[*index].value;
  if (node.is_scalar() && !is_categorical(out.quantity)) {
    reading.error(node.place, fmt::format("the axis `{}` needs `from`, `to` and `bins`", node.scalar),
                  fmt::format("write `{{quantity: {}, {}from: {}, to: {}, bins: 100}}`", node.scalar,
                              out.quantity == Quantity::spin ? "axis: z, " : "",
                              example_of_end(out.quantity, true), example_of_end(out.quantity, false)));
    return false;
  }
  keys.rename(fmt::format("the axis `{}`", word.scalar), word.place);
  const bool good =
      is_categorical(out.quantity) ? read_levels(keys, word.scalar) : read_range(keys, word.scalar, out);
  const std::size_t errors = reading.errors.size();
  keys.finish();
  return good && reading.errors.size() == errors;
}

}  // namespace rabiline
