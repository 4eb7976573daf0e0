#include "input/describe.hpp"

#include <algorithm>
#include <functional>

#include "input/beamline_reader.hpp"
#include "input/describe_species.hpp"
#include "input/reader.hpp"
#include "input/scan.hpp"

namespace rabiline {
namespace {

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
  else
    return "list";
}

template <class M, class D>
std::string need_of(const Row& row, const D& fallback) {
  if constexpr (std::is_same_v<D, Required> && !is_optional<M>)
    return "required";
  else if constexpr (std::is_same_v<D, UnitVector>)
    return fallback.x == 1 ? "default x" : "default z";
  else if constexpr (requires { D::kind; })
    return fmt::format("default {}", D::kind);
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
    return fallback.empty() ? "may be missing" : fmt::format("default \"{}\"", fallback);
  else
    return "may be missing";
}

/// The rows of a table; choices are explained under their key.
template <class T>
void add_rows(Page& page) {
  for_each_row<T>([&]<class S, class M, class D>(const Param<S, M, D>& p) {
    if constexpr (is_variant<M>)
      if (p.key.empty()) {
        for_each_alternative<M>([&]<class A>(std::type_identity<A>) {
          for_each_row<A>([&]<class S2, class M2, class D2>(const Param<S2, M2, D2>& q) {
            page.row(std::string(q.key), kind_of_value<M2>(row_of(q)), fmt::format("for a {}", A::kind),
                     q.meaning);
          });
        });
        return;
      }
    page.row(std::string(p.key), kind_of_value<M>(row_of(p)), need_of<M>(row_of(p), p.fallback), p.meaning);
    if constexpr (is_optional<M>) {
      if constexpr (std::is_enum_v<typename M::value_type>)
        for (const Word& w : words_of<typename M::value_type>())
          page.row("", std::string(w.word), "", w.meaning);
    } else if constexpr (std::is_enum_v<M>)
      for (const Word& w : words_of<M>()) page.row("", std::string(w.word), "", w.meaning);
  });
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

template <class A>
std::string describe_part() {
  Page page(fmt::format("{}: {}", A::kind, A::meaning));
  add_rows<Placement>(page);
  add_rows<A>(page);
  std::string snippet = fmt::format("{{name: my_{0}, kind: {0}, at: 0.25 m", A::kind);
  page.line(fmt::format("\nExample\n  - {}, {}}}", snippet, example_of_rows<A>()));
  return page.finish();
}

/// An alternative of the variant that the key `key` holds.
template <class V, class A>
std::string describe_alternative(std::string_view key) {
  Page page(fmt::format("{} ({}): {}", A::kind, key, A::meaning));
  add_rows<A>(page);
  const std::string rows = example_of_rows<A>();
  const std::string short_form =
      tag_key<V>.empty() ? rows
                         : fmt::format("{}: {}{}{}", tag_key<V>, A::kind, rows.empty() ? "" : ", ", rows);
  page.line(fmt::format("\nExample\n  {}: {{{}}}", key, short_form));
  return page.finish();
}

std::string describe_source() {
  Page page("source: where particles start");
  add_rows<Source>(page);
  return page.finish() + "\n" + describe_variant<SpeedLaw>("speed", "law of speeds") + "\n" +
         describe_variant<SourceOpening>("opening", "the hole that particles start from") + "\n" +
         describe_variant<DirectionLaw>("direction", "law of directions") + "\n" +
         describe_variant<EmissionLaw>("emission", "of which an aimed source is a part") + "\n" +
         describe_variant<StartSpin>("spin", "the spin that particles start with") + "\n" +
         describe_variant<Pulse>("pulse", "when particles start");
}

std::string describe_species() {
  Page page("species: what flies");
  page.line(
      fmt::format("\nLibrary, standard uncertainties of the last digits in brackets\n{}", species_table()));
  page.line("`rabiline describe Rb-87` tells more of one.");
  page.line("\nOr a definition of your own");
  add_rows<Species>(page);
  page.line(
      "\nExamples\n  species: neutron\n  species: [{name: Li-7, fraction: 0.92}, {name: H, fraction: 0.08}]");
  page.line(fmt::format("  species: {}", example_of_type<Species>({})));
  return page.finish();
}

std::string describe_scan() {
  Page page("scan: which parameter takes which values; a list of two makes a grid");
  add_rows<ScanEntry>(page);
  page.line(
      "\nExamples\n"
      "  scan: {parameter: H0.frequency, from: 280 kHz, to: 300 kHz, points: 21}\n"
      "  scan: {parameter: law, values: [quantum, {name: dorado, closure: larmor}]}\n"
      "  scan: {parameter: H0.amplitude, from: 1 nT, to: 1 uT, points: 31, spacing: logarithmic}\n"
      "  --scan 'H0.frequency=280 kHz:300 kHz:21'   --scan 'H0.amplitude=1 nT:1 uT:31:log'\n"
      "  --scan law=quantum,dorado   --set "
      "scan.particles=independent\n"
      "A range has both ends and at least two points. A logarithmic one has both ends on the same side of "
      "zero. --scan\n"
      "replaces the file's scan of the same parameter; else it is the outer axis of a grid.");
  return page.finish();
}

std::string describe_units() {
  Page page("Every quantity is written with its unit, as in `0.25 m` or `1e-3 m`.");
  for (int d = 1; d <= static_cast<int>(last_dimension); ++d) {
    std::string symbols;
    for (const UnitSymbol& unit : unit_table())
      if (unit.dimension == static_cast<Dimension>(d))
        symbols += fmt::format("{}{}", symbols.empty() ? "" : " ", unit.symbol);
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
      "Under the law quantum a spin is counted as its expectation: a particle's weight is split over the "
      "outcomes by their\n"
      "probabilities. `level` and `prepared_level` have one bin for each m and may stand alone; together "
      "they "
      "are the\n"
      "state-to-state matrix.");
  return page.finish();
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
    out.push_back({"profile", "how the size of an alternating field runs along it", [] {
                     return describe_variant<AmplitudeProfile>(
                         "profile", "how the size of an alternating field runs along it");
                   }});
    out.push_back({"chamber", "round wall along the whole beam", describe_chamber});
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
    out.push_back({"spin", "the spin that particles start with",
                   [] { return describe_variant<StartSpin>("spin", "the spin that particles start with"); }});
    add_alternatives<StartSpin>(out, "spin");
    out.push_back({"pulse", "when particles start",
                   [] { return describe_variant<Pulse>("pulse", "when particles start"); }});
    add_alternatives<Pulse>(out, "pulse");
    return out;
  }();
  return all;
}

}  // namespace

std::string describe_overview() {
  Page page("A beamline file has these keys");
  page.row("rabiline", "1", "required", "version of the format");
  page.row("geometry", "path", "may be missing", "a file with `parts` and `chamber` that experiments share");
  add_rows<Beamline>(page);
  page.row("scan", "mapping, or list of two", "may be missing", "which parameter takes which values");
  page.line("\nParts");
  for_each_alternative<Part>([&]<class A>(std::type_identity<A>) {
    page.row(std::string(A::kind), std::string(A::meaning), "", "");
  });
  page.line("\nLaws of motion");
  for_each_alternative<Law>([&]<class A>(std::type_identity<A>) {
    page.row(std::string(A::kind), std::string(A::meaning), "", "");
  });
  page.line("\n`rabiline describe TOPIC` tells more of a part, a law, a species such as Rb-87, or");
  std::string others;
  for (const std::string_view topic : {"source", "speed", "direction", "opening", "spin", "pulse", "profile",
                                       "species", "chamber", "scan", "tallies", "units"})
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
  if (out.empty()) {
    const std::string near = closest(topic, names);
    throw InputError(
        {{Place{}, fmt::format("there is nothing to describe called `{}`", topic),
          near.empty() ? "`rabiline describe` lists what there is, `rabiline describe species` what flies"
                       : fmt::format("did you mean `{}`?", near)}});
  }
  return out;
}

}  // namespace rabiline
