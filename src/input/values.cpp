#include "input/values.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include "core/spelling.hpp"
#include "core/text.hpp"
#include "input/spectrum_file.hpp"

namespace rabiline {
namespace {

std::string shortened(std::string_view text) {
  static constexpr std::size_t longest = 40;
  std::string out;
  for (const char c : text) {
    if (out.size() >= longest && (static_cast<unsigned char>(c) & 0xc0U) != 0x80U) return out + "...";
    out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return out;
}

bool is_all_digits(std::string_view s) {
  return !s.empty() && std::all_of(s.begin(), s.end(), [](char c) { return c >= '0' && c <= '9'; });
}

/// Of any size and sign.
bool is_whole(std::string_view text) {
  const ParsedQuantity parsed = parse_quantity(text);
  return parsed.error.empty() && parsed.dimension == Dimension::number &&
         parsed.value == std::floor(parsed.value);
}

/// Whole numbers up to 2^64 - 1 digit by digit; with a point or an exponent where the value is whole.
std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  if (is_all_digits(text)) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} ? std::optional(value) : std::nullopt;
  }
  const double number = is_whole(text) ? parse_quantity(text).value : -1;
  return number >= 0 && number <= 0x1p53 ? std::optional(static_cast<std::uint64_t>(number)) : std::nullopt;
}

/// A key of one letter does not say by its name what it is.
std::string with_meaning(std::string help, const Row& row) {
  return row.key.size() == 1 ? fmt::format("{}; `{}` is: {}", help, row.key, row.meaning) : help;
}

void wrong_dimension(const Node& node, const Row& row, const ParsedQuantity& got, Reading& reading) {
  const std::string wanted = with_article(name_of(row.dimension));
  if (got.dimension != Dimension::number) {
    const bool celsius = row.dimension == Dimension::temperature && got.dimension == Dimension::charge;
    std::string help =
        row.dimension == Dimension::number ? "write it without a unit"
        : celsius
            ? fmt::format("temperatures are absolute, and C is coulomb: write `{:.6g} K`", got.value + 273.15)
            : fmt::format("write {} such as `{}`", wanted, example_for(row));
    reading.error(node.place,
                  fmt::format("{} is {}, but `{}` is {}", quote(node), with_article(name_of(got.dimension)),
                              row.key, wanted),
                  with_meaning(std::move(help), row));
    return;
  }
  reading.error(node.place, fmt::format("`{}` is {}, but {} has no unit", row.key, wanted, quote(node)),
                with_meaning(node.scalar.ends_with('%') || !row.range.contains(got.value)
                                 ? fmt::format("write {} such as `{}`", wanted, example_for(row))
                                 : with_a_unit(node.scalar, row.dimension),
                             row));
}

}  // namespace

void Reading::error(const Place& place, std::string message, std::string suggestion) {
  errors.push_back({place, std::move(message), std::move(suggestion)});
}

void Reading::saw_number(const Node& node, Dimension dimension, double value) {
  for (Watched& w : watched)
    if (w.node == &node) {
      w.dimension = dimension;
      w.value = value;
    }
}

std::string quote(const Node& node) {
  switch (node.kind) {
    case Node::Kind::null:
      return "nothing";
    case Node::Kind::scalar:
      return fmt::format("`{}`", shortened(node.scalar));
    case Node::Kind::sequence:
      return "a list";
    case Node::Kind::mapping:
      return "a mapping of keys";
  }
  return {};
}

bool read_quantity(const Node& node, const Row& row, Reading& reading, double& out) {
  const std::string wanted = with_article(name_of(row.dimension));
  const std::string help = fmt::format("write {} such as `{}`", wanted, example_for(row));
  if (!node.is_scalar()) {
    reading.error(node.place, fmt::format("`{}` is {}, but {} stands here", row.key, wanted, quote(node)),
                  row.key == "field"
                      ? help + ", its size: where it points is another key, `direction` or `tilt`"
                      : help);
    return false;
  }
  const ParsedQuantity parsed = parse_quantity(node.scalar, row.dimension);
  if (!parsed.error.empty()) {
    const bool sized = parsed.misread != Misread::not_a_number && parsed.misread != Misread::unknown_unit;
    const bool no_unit_is_near =
        parsed.misread == Misread::unknown_unit && row.dimension != Dimension::number;
    reading.error(node.place,
                  sized ? fmt::format("{} {}", quote(node), parsed.error)
                        : fmt::format("{} {}, but `{}` is {}", quote(node), parsed.error, row.key, wanted),
                  !parsed.suggestion.empty() || sized ? parsed.suggestion
                  : no_unit_is_near ? fmt::format("write it like `{}`", example_of(row.dimension))
                                    : help);
    return false;
  }
  if (parsed.dimension != row.dimension) {
    wrong_dimension(node, row, parsed, reading);
    return false;
  }
  if (!row.range.contains(parsed.value)) {
    const bool percent = row.range.words == range::fraction.words && parsed.value > 1 &&
                         parsed.value <= 100 && !node.scalar.ends_with('%');
    reading.error(
        node.place,
        fmt::format("`{}` must be {}, but is {}", row.key, row.range.wanted_of(parsed.value), quote(node)),
        percent           ? fmt::format("write `{:g}` if {:g} % is meant", parsed.value / 100, parsed.value)
        : row.key == "at" ? "places along the beam are counted from the source, which is at `0 m`"
        : node.scalar.starts_with('-') && row.range.contains(-parsed.value)
            ? fmt::format("write `{}`", node.scalar.substr(1))
            : std::string{});
    return false;
  }
  // -0 and 0 are the same place, so they get the same bits.
  out = parsed.value + 0.0;
  reading.saw_number(node, row.dimension, out);
  return true;
}

bool read_count(const Node& node, const Row& row, Reading& reading, std::uint64_t& out) {
  const bool ambiguous = node.is_scalar() && has_point_before_thousands(node.scalar);
  const std::optional<std::uint64_t> value =
      node.is_scalar() && !ambiguous ? whole_number(node.scalar) : std::nullopt;
  if (!value && !ambiguous && node.is_scalar() && is_whole(node.scalar)) {
    const bool in_range =
        !is_all_digits(node.scalar) && row.range.contains(parse_quantity(node.scalar).value);
    reading.error(
        node.place,
        in_range ? fmt::format("`{}` is {}: beyond 2^53 a whole number is written with all of its digits",
                               row.key, quote(node))
                 : fmt::format("`{}` must be {}, but is {}", row.key, row.range.words, quote(node)),
        in_range ? "write it without a point and an exponent" : "");
    return false;
  }
  if (!value) {
    reading.error(
        node.place,
        fmt::format("`{}` is a whole number without a unit, but {} stands here", row.key, quote(node)),
        ambiguous ? fmt::format("write `{0}` or `{0}000`", node.scalar.substr(0, node.scalar.find('.')))
        : row.key == "seed" ? "write any, such as `1`: the same seed makes the same result again"
        : node.is_scalar() && node.scalar.find(',') != std::string::npos
            ? "numbers have no commas between thousands: write it like `10000` or `1e4`"
            : "write it like `10000` or `1e4`");
    return false;
  }
  if (node.scalar.size() > 1 && node.scalar.front() == '0' && is_all_digits(node.scalar)) {
    reading.error(node.place,
                  fmt::format("{} begins with a zero, which some programs read as octal", quote(node)),
                  fmt::format("write `{}`", *value));
    return false;
  }
  if (!row.range.contains(static_cast<double>(*value))) {
    reading.error(node.place,
                  fmt::format("`{}` must be {}, but is {}", row.key, row.range.words, quote(node)));
    return false;
  }
  out = *value;
  reading.saw_number(node, Dimension::number, static_cast<double>(out));
  return true;
}

bool ValueType<bool>::read(const Node& node, const Row& row, Reading& reading, bool& out) {
  static constexpr Word words[] = {{"true", ""}, {"false", ""}};
  const std::optional<std::size_t> index = read_word(node, row, words, reading);
  if (index) out = *index == 0;
  return index.has_value();
}

bool read_text(const Node& node, const Row& row, Reading& reading, std::string& out) {
  if (!node.is_scalar() || node.scalar.empty()) {
    reading.error(node.place,
                  fmt::format("`{}` is a text, but {} stands here", row.key,
                              node.is_scalar() ? "an empty one" : quote(node)),
                  fmt::format("it means: {}", row.meaning));
    return false;
  }
  out = node.scalar;
  return true;
}

std::optional<std::size_t> read_word(const Node& node, const Row& row, std::span<const Word> words,
                                     Reading& reading, std::string_view example) {
  std::string help;
  if (node.is_scalar()) {
    for (std::size_t i = 0; i < words.size(); ++i)
      if (words[i].word == node.scalar) return i;
    help = suggest(node.scalar, words);
    if (help.empty())
      help = example.empty() ? "write " + list_of(words)
                             : fmt::format("write it like `{}: {}`", row.key, example);
  }
  constexpr std::size_t many = 10;
  reading.error(node.place,
                words.size() > many
                    ? fmt::format("`{}` cannot be {}", row.key, quote(node))
                    : fmt::format("`{}` is {}, but {} stands here", row.key, list_of(words), quote(node)),
                std::move(help));
  return std::nullopt;
}

bool ValueType<HalfInteger>::read(const Node& node, const Row& row, Reading& reading, HalfInteger& out) {
  static constexpr std::array<std::string_view, 10> written{"0",   "1/2", "1",   "3/2", "2",
                                                            "5/2", "3",   "7/2", "4",   "9/2"};
  const bool may_vanish = row.key == "I";  // of an atom whose nucleus has no spin
  for (std::size_t twice = may_vanish ? 0 : 1; node.is_scalar() && twice < written.size(); ++twice)
    if (node.scalar == written[twice]) {
      out.twice = static_cast<int>(twice);
      return true;
    }
  std::string help = "write it like `1/2`, `1` or `3/2`";
  const ParsedQuantity parsed = parse_quantity(node.scalar);
  const double twice = 2 * parsed.value;
  if (parsed.error.empty() && twice >= 1 && twice <= 9 && twice == std::floor(twice))
    help = fmt::format("write it as `{}`", written[static_cast<std::size_t>(twice)]);
  if (row.key == "J" && parsed.error.empty() && twice == 0)
    help = "a species without it is a point: give `spin` and `gyromagnetic_ratio` instead of `structure`";
  reading.error(node.place,
                fmt::format("`{}` is a whole or half number from {} to 9/2, but {} stands here", row.key,
                            may_vanish ? "0" : "1/2", quote(node)),
                std::move(help));
  return false;
}

bool ValueType<LevelName>::read(const Node& node, const Row& row, Reading& reading, LevelName& out) {
  const std::optional<LevelName> name = node.is_scalar() ? parse_level_name(node.scalar) : std::nullopt;
  if (name)
    out = *name;
  else
    reading.error(node.place, fmt::format("`{}` names levels, but {} stands here", row.key, quote(node)),
                  "write a level as `F=4 m=0`, or by its name in a strong field, `m_J=1/2 m_I=-7/2`; a spin "
                  "alone has none and is `polarised`, or given by `populations`");
  return name.has_value();
}

bool ValueType<Phase>::read(const Node& node, const Row& row, Reading& reading, Phase& out) {
  static constexpr std::array words{Word{"random", ""}, Word{"locked", ""}};
  if (node.is_scalar() && node.scalar == "random") {
    out = {Phase::Kind::random, 0};
    return true;
  }
  if (node.is_scalar() && node.scalar == "locked") {
    out = {Phase::Kind::locked, 0};
    return true;
  }
  const bool word =
      node.is_scalar() && !node.scalar.empty() && std::isalpha(static_cast<unsigned char>(node.scalar[0]));
  if (!node.is_scalar() || word) {
    const std::string degrees = node.is_scalar() ? degrees_of_pi(node.scalar) : std::string{};
    reading.error(node.place,
                  fmt::format("`{}` is `random`, `locked` or an angle such as `30 deg`, but {} stands here",
                              row.key, quote(node)),
                  !degrees.empty()   ? fmt::format("write `{}`", degrees)
                  : node.is_scalar() ? suggest(node.scalar, words)
                                     : std::string{});
    return false;
  }
  out.kind = Phase::Kind::angle;
  return read_quantity(node, {row.key, Dimension::angle, range::any, row.meaning}, reading, out.angle);
}

bool ValueType<Bins>::read(const Node& node, const Row& row, Reading& reading, Bins& out) {
  static constexpr Range allowed{1, 10000, true, true, "from 1 to 10000"};
  if (!node.is_sequence() || node.items.size() != 2) {
    reading.error(
        node.place,
        fmt::format("`{}` is a pair of whole numbers, along x and along z, but {} stands here", row.key,
                    node.is_sequence() ? fmt::format("a list of {}", node.items.size()) : quote(node)),
        "write it like `[80, 80]`");
    return false;
  }
  std::uint64_t x = 0, z = 0;
  const Row item{row.key, Dimension::number, allowed, row.meaning};
  const bool x_read = read_count(node.items[0], item, reading, x);
  const bool z_read = read_count(node.items[1], item, reading, z);
  out = {static_cast<std::int64_t>(x), static_cast<std::int64_t>(z)};
  return x_read && z_read;
}

bool ValueType<SpeedQuantity>::read(const Node& node, const Row& row, Reading& reading, SpeedQuantity& out) {
  Row as_written = row;
  if (node.is_scalar()) {
    const ParsedQuantity parsed = parse_quantity(node.scalar, Dimension::speed);
    if (parsed.misread == Misread::unknown_unit) {
      std::string help = parsed.suggestion;
      for (const Dimension d : {Dimension::length, Dimension::energy})
        if (help.empty()) help = parse_quantity(node.scalar, d).suggestion;
      if (help.empty()) help = "write it like `1000 m/s`, `4 angstrom` or `25 meV`";
      reading.error(node.place,
                    fmt::format("{} {}, but `{}` is a speed, a wavelength or an energy", quote(node),
                                parsed.error, row.key),
                    help);
      return false;
    }
    if (parsed.dimension == Dimension::length || parsed.dimension == Dimension::energy)
      as_written.dimension = parsed.dimension;
    else if (parsed.error.empty() && parsed.dimension != Dimension::speed) {
      const bool number = parsed.dimension == Dimension::number;
      reading.error(
          node.place,
          fmt::format("`{}` is a speed, a wavelength or an energy, but {} {}", row.key, quote(node),
                      number ? "has no unit" : fmt::format("is {}", with_article(name_of(parsed.dimension)))),
          node.scalar.ends_with('%') ? "write how much that is, in m/s"
          : number                   ? fmt::format("write `{0} m/s` if m/s is meant", node.scalar)
                                     : "write it like `1000 m/s`, `4 angstrom` or `25 meV`");
      return false;
    }
  }
  out.dimension = as_written.dimension;
  return read_quantity(node, as_written, reading, out.value);
}

bool ValueType<ScannedQuantity>::read(const Node& node, const Row& row, Reading& reading,
                                      ScannedQuantity& out) {
  Row as_written = row;
  if (node.is_scalar())
    if (const ParsedQuantity parsed = parse_quantity(node.scalar); parsed.error.empty())
      as_written.dimension = parsed.dimension;
  out.dimension = as_written.dimension;
  return read_quantity(node, as_written, reading, out.value);
}

bool ValueType<SpectrumFile>::read(const Node& node, const Row& row, Reading& reading, SpectrumFile& out) {
  out.spectrum = read_spectrum(node, row, reading);
  return out.spectrum != nullptr;
}

bool ValueType<UnitVector>::read(const Node& node, const Row& row, Reading& reading, UnitVector& out) {
  using Named = std::pair<std::string_view, UnitVector>;
  static constexpr std::array<Named, 6> named{{{"x", {1, 0, 0}},
                                               {"y", {0, 1, 0}},
                                               {"z", {0, 0, 1}},
                                               {"-x", {-1, 0, 0}},
                                               {"-y", {0, -1, 0}},
                                               {"-z", {0, 0, -1}}}};
  const std::string written = node.is_scalar() ? with_plain_minus(node.scalar) : std::string{};
  for (const auto& [word, vector] : named)
    if (written == word) {
      out = vector;
      return true;
    }
  if (!node.is_sequence() || node.items.size() != 3) {
    std::string near = lower(written);
    if (near.starts_with('+')) near.erase(0, 1);
    const bool is_near = std::ranges::find(named, near, &Named::first) != named.end();
    reading.error(
        node.place,
        fmt::format("`{}` is a direction, but {} stands here", row.key,
                    node.is_sequence() ? fmt::format("a list of {}", node.items.size()) : quote(node)),
        is_near ? fmt::format("did you mean `{}`?", near)
                : "write `x`, `y` (along the beam), `z`, `-x`, `-y`, `-z`, or three components: `[0, 1, 1]`");
    return false;
  }
  double c[3] = {};
  bool good = true;
  for (std::size_t i = 0; i < 3; ++i)
    good =
        read_quantity(node.items[i], {row.key, Dimension::number, range::any, row.meaning}, reading, c[i]) &&
        good;
  const double length = std::hypot(c[0], c[1], c[2]);
  if (good && !(length > 0 && std::isfinite(length))) {
    reading.error(node.place, fmt::format("`{}` has no direction", row.key),
                  "one component must not be zero");
    return false;
  }
  out = {c[0] / length, c[1] / length, c[2] / length};
  return good;
}

}  // namespace rabiline
