#pragma once
// Follows the tables of parameters to every number of a beamline.
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>
#include <variant>
#include <vector>

#include "rules/room.hpp"

namespace rabiline {

template <class T>
concept a_struct_with_a_table = std::tuple_size_v<std::remove_const_t<decltype(parameters<T>)>> >
0;

/// Where a number stands below its subject; written out for what is wrong alone, as a scan has many points.
struct NumberKey {
  const NumberKey* above = nullptr;
  std::string_view word{};
  std::optional<std::size_t> index{};  // in the list of that name
  std::string text() const {
    if (index) return fmt::format("{}[{}]", above->text(), *index);
    return above ? dotted_name(above->text(), std::string(word)) : std::string();
  }
};
/// What the table says of it. A speed may be written as another quantity, and what is scanned is any: these
/// have none here.
struct NumberRow {
  std::optional<Dimension> dimension;
  Range range;
};

/// Calls f(value in SI, key, row) for each number below one subject.
template <class F>
class EachNumber {
 public:
  explicit EachNumber(F f) : f_(std::move(f)) {}

  template <a_struct_with_a_table T>
  void operator()(const T& of, const NumberKey& key = {}) {
    std::apply(
        [&](const auto&... row) {
          (look(of.*row.member, NumberKey{&key, row.key}, NumberRow{row.dimension, row.range}), ...);
        },
        parameters<T>);
  }

 private:
  template <class T>
  void look(const T& value, const NumberKey& key, const NumberRow& row) {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::uint64_t>)
      f_(static_cast<double>(value), key, row);
    else if constexpr (std::is_same_v<T, SpeedQuantity> || std::is_same_v<T, ScannedQuantity>)
      f_(value.value, key, NumberRow{std::nullopt, row.range});
    else if constexpr (a_struct_with_a_table<T>)
      (*this)(value, key);
    else
      nested(value, key, row);
  }
  template <class T>
  void nested(const std::optional<T>& value, const NumberKey& key, const NumberRow& row) {
    if (value) look(*value, key, row);
  }
  template <class T>
  void nested(const std::vector<T>& values, const NumberKey& key, const NumberRow& row) {
    for (std::size_t i = 0; i < values.size(); ++i) look(values[i], NumberKey{&key, {}, i}, row);
  }
  template <class... T>
  void nested(const std::variant<T...>& value, const NumberKey& key, const NumberRow& row) {
    std::visit([&](const auto& any) { look(any, key, row); }, value);
  }
  void nested(const Bins& bins, const NumberKey& key, const NumberRow&) {
    for (const std::int64_t n : {bins.x, bins.z})
      f_(static_cast<double>(n), key,
         NumberRow{Dimension::number, {1, 10000, true, true, "from 1 to 10000"}});
  }
  template <class T>
  void nested(const T&, const NumberKey&, const NumberRow&) {}  // a word, a name, a direction

  F f_;
};

/// Calls f(subject, value, key, row) for each number of a beamline but those of its species.
template <class F>
void each_number(const Beamline& beamline, F f) {
  const auto below = [&](std::string_view subject) {
    return EachNumber([&f, subject](double value, const NumberKey& key, const NumberRow& row) {
      f(subject, value, key, row);
    });
  };
  below("source")(beamline.source);
  std::visit(
      [&](const auto& law) {
        if constexpr (a_struct_with_a_table<std::decay_t<decltype(law)>>) below("law")(law);
      },
      beamline.law);
  if (beamline.chamber) below("chamber")(*beamline.chamber);
  if (beamline.gravity) below("gravity")(*beamline.gravity);
  if (beamline.until) below("until")(*beamline.until);
  for (const PlacedPart& part : beamline.parts) {
    auto of_part = below(part.placement.name);
    of_part(part.placement);
    std::visit([&](const auto& any) { of_part(any); }, part.part);
  }
}

}  // namespace rabiline
