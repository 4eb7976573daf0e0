// Numbers outside of the range that their table states: a file's are refused where they are read.
#include <optional>
#include <tuple>
#include <type_traits>
#include <variant>

#include "rules/room.hpp"

namespace rabiline {
namespace {

template <class T>
concept a_struct_with_a_table = std::tuple_size_v<std::remove_const_t<decltype(parameters<T>)>> >
0;

/// Where a number stands below its subject; written out for what is wrong alone, as a scan has many points.
struct Key {
  const Key* above = nullptr;
  std::string_view word{};
  std::optional<std::size_t> index{};  // in the list of that name
  std::string text() const {
    if (index) return fmt::format("{}[{}]", above->text(), *index);
    return above ? dotted_name(above->text(), std::string(word)) : std::string();
  }
};

/// Follows the tables below one subject.
class Ranges {
 public:
  Ranges(std::string_view subject, Faults& out) : subject_(subject), out_(out) {}

  template <a_struct_with_a_table T>
  void check(const T& of, const Key& key = {}) {
    std::apply(
        [&](const auto&... row) {
          (check(of.*row.member, Key{&key, row.key}, row.range), ...);
        },
        parameters<T>);
  }

 private:
  template <class T>
  void check(const T& value, const Key& key, const Range& range) {
    if constexpr (std::is_same_v<T, double> || std::is_same_v<T, std::uint64_t>)
      number(static_cast<double>(value), key, range);
    else if constexpr (std::is_same_v<T, SpeedQuantity> || std::is_same_v<T, ScannedQuantity>)
      number(value.value, key, range);
    else if constexpr (a_struct_with_a_table<T>)
      check(value, key);
    else
      nested(value, key, range);
  }
  template <class T>
  void nested(const std::optional<T>& value, const Key& key, const Range& range) {
    if (value) check(*value, key, range);
  }
  template <class T>
  void nested(const std::vector<T>& values, const Key& key, const Range& range) {
    for (std::size_t i = 0; i < values.size(); ++i) check(values[i], Key{&key, {}, i}, range);
  }
  template <class... T>
  void nested(const std::variant<T...>& value, const Key& key, const Range& range) {
    std::visit([&](const auto& any) { check(any, key, range); }, value);
  }
  void nested(const Bins& bins, const Key& key, const Range&) {
    for (const std::int64_t n : {bins.x, bins.z})
      number(static_cast<double>(n), key, {1, 10000, true, true, "from 1 to 10000"});
  }
  template <class T>
  void nested(const T&, const Key&, const Range&) {}  // a word, a name, a direction

  void number(double value, const Key& key, const Range& range) {
    if (range.contains(value)) return;
    const std::string name = key.text();
    out_.push_back({std::string(subject_),
                    name,
                    fmt::format("`{}` must be {}, but is {:.6g}", name, range.wanted_of(value), value),
                    {}});
  }

  std::string_view subject_;
  Faults& out_;
};

}  // namespace

void check_ranges(const Beamline& beamline, Faults& out) {
  Ranges("source", out).check(beamline.source);
  std::visit(
      [&](const auto& law) {
        if constexpr (a_struct_with_a_table<std::decay_t<decltype(law)>>) Ranges("law", out).check(law);
      },
      beamline.law);
  if (beamline.chamber) Ranges("chamber", out).check(*beamline.chamber);
  if (beamline.gravity) Ranges("gravity", out).check(*beamline.gravity);
  if (beamline.until) {
    Ranges("until", out).check(*beamline.until);
    if (std::none_of(beamline.parts.begin(), beamline.parts.end(),
                     [](const PlacedPart& part) { return detector_in(part.part) != nullptr; }))
      out.push_back({"until", "", "`until` asks for the error of what is detected, and there is no detector",
                     "add a detector, or omit `until`"});
  }
  for (const PlacedPart& part : beamline.parts) {
    Ranges of_part(part.placement.name, out);
    of_part.check(part.placement);
    std::visit([&](const auto& any) { of_part.check(any); }, part.part);
  }
  if (const auto* tabulated = std::get_if<TabulatedSpeed>(&beamline.source.speed);
      tabulated && !tabulated->file.spectrum)
    out.push_back({"source", "speed.file", "there is no spectrum to draw speeds from", ""});
  for (std::size_t i = 0; i < beamline.species.size(); ++i)
    if (const Species& species = beamline.species[i].species; !(species.mass > 0) || species.spin.twice < 1)
      out.push_back({"species", key_of_species(i, species.mass > 0 ? "spin" : "mass"),
                     fmt::format("the {} of `{}` must be greater than zero",
                                 species.mass > 0 ? "spin" : "mass", species.name),
                     ""});
  if (beamline.particles < 1)
    out.push_back({"", "particles", "`particles` must be from 1 to 1e14, but is 0", ""});
}

}  // namespace rabiline
