#include "parts/part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace rabiline {
namespace {

/// Asks a part by its kind; `otherwise` of kinds that cannot answer.
template <class Answer, class Ask>
Answer ask(const Part& part, Answer otherwise, Ask question) {
  return std::visit(
      [&](const auto& any) -> Answer {
        if constexpr (requires { question(any); })
          return question(any);
        else
          return otherwise;
      },
      part);
}

}  // namespace

PartTraits traits_of(const Part& part) {
  return std::visit([](const auto& any) { return any.traits; }, part);
}
std::string_view kind_of(const Part& part) {
  return std::visit([](const auto& any) { return any.kind; }, part);
}
double extent_of(const Part& part) {
  return ask(part, 0.0, [](const auto& any) -> decltype(any.length) { return any.length; });
}
const std::vector<Tally>* tallies_of(const Part& part) {
  return ask(part, static_cast<const std::vector<Tally>*>(nullptr),
             [](const auto& any) -> decltype(&any.tallies) { return &any.tallies; });
}
std::uint64_t planes_of(const Part& part) {
  return ask(part, std::uint64_t{1}, [](const auto& any) -> decltype(any.planes) { return any.planes; });
}
const std::string* clock_of(const Part& part) {
  return ask(part, static_cast<const std::string*>(nullptr),
             [](const auto& any) -> decltype(&*any.oscillator) {
               return any.oscillator ? &*any.oscillator : nullptr;
             });
}
std::optional<StaticField> static_field_of(const Part& part) {
  return ask(part, std::optional<StaticField>{},
             [](const auto& any) -> decltype(std::optional(static_field(any))) { return static_field(any); });
}
bool is_electric(const Part& part) {
  return ask(part, false, [](const auto& any) -> decltype(any.is_electric()) { return any.is_electric(); });
}
bool holds_spins(const Part& part) {
  const PartTraits traits = traits_of(part);
  if (!traits.field || traits.drives || is_electric(part) || traits.sets_spins) return false;
  const std::optional<StaticField> own = static_field_of(part);
  return !own || traits.deflects || own->field != Vector3{};
}
std::optional<Across> across_of(const Part& part) {
  return std::visit(
      [](const auto& any) -> std::optional<Across> {
        if constexpr (requires { any.face; }) return Across{opening_of(any.face), any.offset, any.tilt};
        if constexpr (requires { Opening{any.opening}; }) return Across{any.opening, any.offset, any.tilt};
        return std::nullopt;
      },
      part);
}

bool is_well_formed(std::string_view name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
  return !name.empty() && name.size() <= 64 && letter(name.front()) &&
         std::all_of(name.begin(), name.end(),
                     [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '_'; });
}

bool is_reserved(std::string_view name) {
  static constexpr std::array words{// keys of the file
                                    "rabiline", "title", "geometry", "species", "law", "source", "chamber",
                                    "parts", "particles", "until", "seed", "scan", "variables",
                                    // names in the results
                                    "entry", "fates", "simulation", "instrument", "sample", "user", "data",
                                    "definition", "program_name", "start_time", "end_time", "duration",
                                    "detected", "axes", "signal", "default"};
  return std::find(words.begin(), words.end(), name) != words.end();
}

std::vector<Fault> faults_of(const Placement& place) {
  const std::string& name = place.name;
  if (!is_well_formed(name)) {
    std::string joined = name;
    std::ranges::replace_if(
        joined, [](char c) { return c == ' ' || c == '-' || c == '.'; }, '_');
    return {{name, "name",
             fmt::format(
                 "`{}` cannot be a part's name: a name is a letter, then letters, digits or `_`, at most 64",
                 name),
             fmt::format("{}`label` may hold any text for plots",
                         is_well_formed(joined) ? fmt::format("call it `{}`; ", joined) : "")}};
  }
  if (is_reserved(name))
    return {{name, "name",
             fmt::format("a part cannot be called `{}`: the word means something else in files and results",
                         name),
             fmt::format("call it `{}_1`", name)}};
  return {};
}

std::vector<Fault> faults_of(const PlacedPart& placed) {
  std::vector<Fault> out = faults_of(placed.placement);
  const std::vector<Fault> own = std::visit(
      [&](const auto& part) -> std::vector<Fault> {
        if constexpr (requires { faults_of(part, placed.placement); })
          return faults_of(part, placed.placement);
        else
          return {};
      },
      placed.part);
  out.insert(out.end(), own.begin(), own.end());
  return out;
}

}  // namespace rabiline
