#include "manual/describe.hpp"

#include <algorithm>
#include <functional>
#include <set>
#include <typeindex>

#include "input/beamline_reader.hpp"
#include "input/species_names.hpp"
#include "input/words.hpp"
#include "manual/describe_page.hpp"
#include "manual/describe_species.hpp"
#include "scan/model_file.hpp"
#include "scan/scan.hpp"

namespace rabiline {
namespace {

/// Calls f(type_identity<Variant>, row) for each row of a table that holds a variant with a tag.
template <class T, class F>
void for_each_nested(F f) {
  for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
    if constexpr (is_variant<M>)
      if constexpr (!tag_key<M>.empty()) f(std::type_identity<M>{}, row_of(p));
  });
}

/// An alternative of the variant that the key `key` holds.
template <class V, class A>
std::string describe_alternative(std::string_view key) {
  Page page(fmt::format("{} ({}): {}", A::kind, key, A::meaning));
  add_rows<A>(page);
  for_each_nested<A>([&]<class N>(std::type_identity<N>, const Row& row) {
    for_each_alternative<N>([&]<class B>(std::type_identity<B>) {
      page.line(fmt::format("\n{}, {}: {}", row.key, B::kind, B::meaning));
      add_rows<B>(page);
    });
  });
  const std::string rows = example_of_rows<A>();
  const std::string short_form =
      tag_key<V>.empty() ? rows
                         : fmt::format("{}: {}{}{}", tag_key<V>, A::kind, rows.empty() ? "" : ", ", rows);
  page.line(fmt::format("\nExample\n  {}: {{{}}}", key, short_form));
  return page.finish();
}

std::string describe_spin() {
  return describe_variant<StartSpin>("spin", "the spin that particles start with") +
         "  spin: {kind: polarised, axis: z, degree: 0.9}\n"
         "  spin: {kind: populations, values: [0.75, 0.25]}\n"
         "Of species with levels, such as `Cs-133 atom`, under the law quantum\n"
         "  spin: {kind: thermal, temperature: 400 K}\n"
         "  spin: {kind: levels, levels: [F=4 m=0, F=3 m=0], shares: [0.9, 0.1]}\n"
         "  spin: {kind: levels, levels: [m_J=1/2 m_I=-7/2]}\n";
}

std::string describe_source() {
  Page page("source: where particles start");
  add_rows<Source>(page);
  return page.finish() + "\n" + describe_variant<SpeedLaw>("speed", "law of speeds") + "\n" +
         describe_variant<SourceOpening>("opening", "the hole that particles start from") + "\n" +
         describe_variant<DirectionLaw>("direction", "law of directions") + "\n" +
         describe_variant<EmissionLaw>("emission", "of which an aimed source is a part") + "\n" +
         describe_spin() + "\n" + describe_variant<Pulse>("pulse", "when particles start");
}

std::string describe_scan() {
  Page page("scan: which parameter takes which values; a list makes a grid");
  add_rows<ScanEntry>(page);
  page.line(
      "\nExamples\n"
      "  scan: {parameter: H0.frequency, from: 280 kHz, to: 300 kHz, points: 21}\n"
      "  scan: {parameter: law, values: [quantum, {name: dorado, closure: larmor}]}\n"
      "  scan: {parameter: H0.amplitude, from: 1 nT, to: 1 uT, points: 31, spacing: logarithmic}\n"
      "  --scan 'H0.frequency=280 kHz:300 kHz:21'   --scan 'H0.amplitude=1 nT:1 uT:31:log'\n"
      "  --scan law=quantum,dorado   --set "
      "scan.particles=independent\n"
      "  scan: {parameter: [C1.amplitude, C2.amplitude], from: 1 uT, to: 2 uT, points: 11}\n"
      "  --scan 'C1.amplitude,C2.amplitude=1 uT:2 uT:11'   --scan C2.enabled=true,false\n"
      "A range has both ends and at least two points. A logarithmic one has both ends on the same side of "
      "zero. --scan\n"
      "may be given several times, the outermost axis first. It replaces the file's scan of the same "
      "parameter; "
      "else\n"
      "it stands outside of the file's. --no-scan omits the file's.");
  return page.finish();
}

std::string describe_units() {
  Page page("Every quantity is written with its unit, as in `0.25 m` or `1e-3 m`.");
  for (int d = 1; d <= static_cast<int>(last_dimension); ++d) {
    std::string symbols;
    for (const UnitSymbol& unit : unit_table())
      if (unit.dimension == static_cast<Dimension>(d))
        symbols += fmt::format("{}{}", symbols.empty() ? "" : ", ", unit.symbol);
    page.row(std::string(name_of(static_cast<Dimension>(d))), symbols, "", "");
  }
  page.line(
      "A frequency counts turns, never radians. `rad/s/T` gives gamma itself, `MHz/T` and the like "
      "gamma/2pi.");
  return page.finish();
}

std::string describe_chamber() {
  Page page("chamber: round wall along the whole beam");
  add_rows<Chamber>(page);
  page.line("\nExample\n  chamber: {radius: 50 mm}");
  return page.finish();
}
std::string describe_gravity() {
  Page page("gravity: free fall");
  add_rows<Gravity>(page);
  page.line(
      "\nWhat nothing else pushes falls along a parabola. Off if omitted.\n"
      "\nExamples\n  gravity: 9.81 m/s^2\n  gravity: {acceleration: 9.81 m/s^2, direction: -y}");
  return page.finish();
}
std::string describe_until() {
  Page page("until: the precision at which fewer particles than `particles` are enough");
  add_rows<Until>(page);
  page.line(
      "\nThe line is the whole curve over the one number that is scanned; its place is that with which the "
      "same "
      "curve,\n"
      "shifted, scaled and raised, would fit it.\n"
      "\nExamples\n  until: {detected_error: 0.1 %}\n  until: {centre_error: 5 Hz}");
  return page.finish();
}

std::string describe_tallies() {
  Page page("tallies: histograms of what a monitor lets pass or a detector counts, one to three axes each");
  add_rows<Tally>(page);
  page.line("\nAn axis");
  add_rows<TallyAxis>(page);
  page.line(
      "\nExamples\n"
      "  tallies:\n"
      "    - {name: spectrum, axes: [{quantity: speed, from: 900 m/s, to: 1100 m/s, bins: 100}]}\n"
      "    - {name: states, axes: [prepared_level, level]}\n"
      "    - {name: spin_over_time, axes: [{quantity: time_of_flight, from: 1 ms, to: 2 ms, bins: 50},\n"
      "                                    {quantity: spin, axis: z, from: -1, to: 1, bins: 2}]}\n"
      "Places, angles and times are those at the plane, in the laboratory. What lies beyond the ends is "
      "counted as `outside`.\n"
      "A monitor with several `planes` counts in each of them; `y`, one bin for each, is then the first axis "
      "of each tally,\n"
      "and means and standard deviations are those in each plane.\n"
      "Under the law quantum a spin is counted as its expectation: a particle's weight is split over the "
      "outcomes by their\n"
      "probabilities. `level` and `prepared_level` have one bin for each m and may stand alone; together "
      "they "
      "are the\n"
      "state-to-state matrix.");
  return page.finish();
}

std::string describe_models() {
  return "A file with the key `model` is not a beamline: it describes a small system that is solved, not "
         "flown.\n"
         "Beside `model` it has `rabiline`, `title` and at most one `scan`.\n\n" +
         describe_variant<Model>("model", "the system");
}

struct Topic {
  std::string name, meaning;
  std::function<std::string()> text;
};

template <class V>
void add_alternatives(std::vector<Topic>& out, std::string_view key) {
  for_each_alternative<V>([&]<class A>(std::type_identity<A>) {
    out.push_back(
        {std::string(A::kind), std::string(A::meaning), [key] { return describe_alternative<V, A>(key); }});
  });
}

/// What a key of a part holds: a mapping of keys, or one of several kinds of them.
template <class M>
std::string describe_member(std::string_view key, std::string_view meaning) {
  if constexpr (is_variant<M>) return describe_variant<M>(key, meaning);
  Page page(fmt::format("{}: {}", key, meaning));
  add_rows<M>(page);
  std::string example = example_of_type<M>({});
  if constexpr (requires { M::example; }) example = fmt::format("{{{}}}", M::example);
  page.line(fmt::format("\nExample\n  {}: {}", key, example));
  return page.finish();
}
/// Those of all parts that are no topics yet; of one key only once, where it holds the same.
void add_members(std::vector<Topic>& out) {
  std::set<std::string> known;
  for (const Topic& topic : out) known.insert(topic.name);
  std::set<std::pair<std::string, std::type_index>> added;
  const auto add = [&]<class M>(std::type_identity<M>, const Row& row) {
    if constexpr (has_table<M> || (is_variant<M> && !tag_key<M>.empty()))
      if (!known.contains(std::string(row.key)) && added.emplace(row.key, typeid(M)).second) {
        out.push_back({std::string(row.key), std::string(row.meaning),
                       [key = row.key, meaning = row.meaning] { return describe_member<M>(key, meaning); }});
        if constexpr (is_variant<M>) add_alternatives<M>(out, row.key);
      }
  };
  for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
    for_each_row<A>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
      if constexpr (is_optional<M>)
        add(std::type_identity<typename M::value_type>{}, row_of(p));
      else if constexpr (requires(M member) { member.box; })
        add(std::type_identity<decltype(M::box)>{}, row_of(p));
      else
        add(std::type_identity<M>{}, row_of(p));
    });
  });
}

/// The first part that has such a key.
std::string_view part_with(std::string_view key) {
  std::string_view out;
  for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
    for_each_row<A>([&](const auto& p) {
      if (out.empty() && p.key == key) out = A::kind;
    });
  });
  return out;
}

const std::vector<Topic>& topics() {
  static const std::vector<Topic> all = [] {
    std::vector<Topic> out;
    for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
      out.push_back({std::string(A::kind), std::string(A::meaning), describe_part<A>});
    });
    out.push_back({"law", "law of motion",
                   [] { return describe_variant<Law>("law", "law of motion, always a choice of yours"); }});
    out.push_back({"source", "where particles start", describe_source});
    out.push_back({"species", "what flies", describe_species});
    out.push_back({"structure", "the levels of a species", describe_structure});
    out.push_back({"profile", "how the size of an alternating field runs along it", [] {
                     return describe_variant<DriveProfile>(
                         "profile", "how the size of an alternating field runs along it");
                   }});
    add_alternatives<DriveProfile>(out, "profile");
    out.push_back({"chamber", "round wall along the whole beam", describe_chamber});
    out.push_back({"gravity", "free fall", describe_gravity});
    out.push_back({"until", "when fewer particles are enough", describe_until});
    out.push_back({"scan", "which parameter takes which values", describe_scan});
    out.push_back({"tallies", "histograms at a monitor or a detector", describe_tallies});
    out.push_back({"units", "how quantities are written", describe_units});
    add_alternatives<Law>(out, "law");
    out.push_back(
        {"speed", "law of speeds", [] { return describe_variant<SpeedLaw>("speed", "law of speeds"); }});
    add_alternatives<SpeedLaw>(out, "speed");
    out.push_back({"direction", "law of directions",
                   [] { return describe_variant<DirectionLaw>("direction", "law of directions"); }});
    add_alternatives<DirectionLaw>(out, "direction");
    out.push_back({"opening", "a hole", [] {
                     return describe_variant<Opening>("opening", "a hole that particles start from or pass");
                   }});
    add_alternatives<SourceOpening>(out, "opening");
    out.push_back({"emission", "law of directions of an aimed source", [] {
                     return describe_variant<EmissionLaw>("emission", "of which an aimed source is a part");
                   }});
    out.push_back({"spin", "the spin that particles start with", describe_spin});
    add_alternatives<StartSpin>(out, "spin");
    out.push_back({"pulse", "when particles start",
                   [] { return describe_variant<Pulse>("pulse", "when particles start"); }});
    add_alternatives<Pulse>(out, "pulse");
    out.push_back({"model", "a small model, which is solved and not flown", describe_models});
    add_alternatives<Model>(out, "model");
    for_each_alternative<Model>([&]<class A>(std::type_identity<A>) {
      for_each_nested<A>([&]<class N>(std::type_identity<N>, const Row& row) {
        const std::string meaning = fmt::format("{}, in the model `{}`", row.meaning, A::kind);
        out.push_back({std::string(row.key), meaning,
                       [key = row.key, meaning] { return describe_variant<N>(key, meaning); }});
        add_alternatives<N>(out, row.key);
      });
    });
    add_members(out);
    return out;
  }();
  return all;
}

}  // namespace

std::string describe_overview() {
  Page page("A beamline file has these keys");
  page.row("rabiline", "1", "required", "version of the format");
  page.row("geometry", "path", "optional", "a file with `parts` and `chamber` that experiments share");
  add_rows<Beamline>(page);
  page.row("variables", "names and values", "optional",
           "`{B1: 2 mT}`: values put where `${B1}` stands; set and scanned as variables.B1");
  page.row("scan", "mapping, or list of them", "optional", "which parameter takes which values");
  page.line("\nParts");
  for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
    page.row(std::string(A::kind), std::string(A::meaning), "", "");
  });
  page.line("\nLaws of motion");
  for_each_alternative<Law>([&]<class A>(std::type_identity<A>) {
    page.row(std::string(A::kind), std::string(A::meaning), "", "");
  });
  page.line("\nModels, in files of their own");
  for_each_alternative<Model>([&]<class A>(std::type_identity<A>) {
    page.row(std::string(A::kind), std::string(A::meaning), "", "");
  });
  page.line(
      "\n`rabiline describe TOPIC` tells more of a part, a law, a species such as Rb-87 or `Rb-87 atom`, or");
  std::string others;
  for (const std::string_view topic :
       {"source", "speed", "direction", "opening", "spin", "pulse", "profile", "species", "structure",
        "chamber", "gravity", "until", "scan", "tallies", "model", "units"})
    others += fmt::format(" {}", topic);
  page.line(" " + others);
  return page.finish();
}

std::string describe(std::string_view topic) {
  std::string out;
  std::vector<std::string> names;
  for (const Topic& known : topics()) {
    names.push_back(known.name);
    if (known.name == topic) out += (out.empty() ? "" : "\n") + known.text();
  }
  for (const Species& species : species_library()) {
    names.push_back(species.name);
    if (species.name == topic) out = describe_species_of_library(species);
  }
  for (const Species& species : species_with_levels()) {
    names.push_back(species.name);
    if (species.name == topic) out = describe_species_with_levels(species);
  }
  for (const Mixture& mixture : natural_mixtures()) {
    names.push_back(mixture.name);
    if (mixture.name == topic) out = describe_mixture(mixture);
  }
  const std::size_t blank = topic.find(' ');
  const std::string_view group = topic.substr(0, blank);  // of `law quantum`
  if (out.empty() && blank != topic.npos && std::ranges::find(names, group) != names.end())
    return describe(topic.substr(blank + 1));
  if (out.empty()) {
    std::vector<Word> words;
    words.reserve(names.size());
    for (const std::string& name : names) words.push_back({name, ""});
    const std::string isotopes = species_of_element(topic), near = suggest(topic, words);
    const std::string_view part = part_with(topic);
    throw InputError(
        {{Place{}, fmt::format("there is nothing to describe called `{}`", topic),
          !isotopes.empty() ? isotopes
          : !part.empty()   ? fmt::format("it is a key of a part: `rabiline describe {}` explains it", part)
          : has_key<Source>(topic) ? "it is a key of `source`: `rabiline describe source` explains it"
          : near.empty() ? "`rabiline describe` lists what there is, `rabiline describe species` what flies"
                         : near}});
  }
  return out;
}

}  // namespace rabiline
