// Tallies that cannot be counted, and results that would have the same name.
#include <algorithm>

#include "plan/tally_plan.hpp"
#include "rules/room.hpp"

namespace rabiline {
namespace {

int levels_of(const Beamline& beamline) { return beamline.species.front().species.levels(); }

/// A tally of a part, for messages about it.
class TallyRules {
 public:
  TallyRules(const Beamline& beamline, const PlacedPart& part, std::size_t number, Faults& out)
      : beamline_(beamline),
        part_(part),
        tally_((*tallies_of(part.part))[number]),
        key_(fmt::format("tallies[{}]", number)),
        out_(out) {}

  void check() {
    check_name();
    if (tally_.axes.empty() || tally_.axes.size() > most_tally_axes) return check_number();
    for (std::size_t i = 0; i < tally_.axes.size(); ++i) check_ends(i);
    check_repeats();
    check_size();
    check_levels();
    check_turning();
    if (is_quantum(beamline_)) check_spins();
  }

 private:
  void add(const std::string& key, std::string message, std::string help) {
    out_.push_back({part_.placement.name, dotted_name(key_, key), std::move(message), std::move(help)});
  }
  void add_at_axis(std::size_t i, std::string message, std::string help) {
    add(fmt::format("axes[{}].quantity", i), std::move(message), std::move(help));
  }

  void check_name() {
    const std::string& name = tally_.name;
    if (!is_well_formed("a" + name))
      add("name",
          fmt::format("`{}` cannot be a tally's name: a name is letters, digits or `_`, at most 63", name),
          "results call it by the part's name, `_` and this name");
    else if (const std::string whole = part_.placement.name + "_" + name; is_reserved(whole))
      add("name",
          fmt::format("this tally would be called `{}`, which means something else in the results", whole),
          "choose another name");
  }

  void check_number() {
    if (tally_.axes.empty())
      add("axes", fmt::format("the tally `{}` has no axis", tally_.name), "give it one to three");
    else
      add_at_axis(
          most_tally_axes,
          fmt::format("the tally `{}` has {} axes, and three are the most", tally_.name, tally_.axes.size()),
          "make two tallies of it");
  }

  /// Levels have a bin each; everything else has ends and bins, and a spin the direction it is projected on.
  void check_ends(std::size_t i) {
    const TallyAxis& axis = tally_.axes[i];
    const std::string_view word = word_of(axis.quantity);
    const bool ends = axis.from && axis.to && axis.bins, none = !axis.from && !axis.to && !axis.bins;
    if (is_categorical(axis.quantity) ? !none : !ends)
      add_at_axis(
          i,
          is_categorical(axis.quantity)
              ? fmt::format("`{}` has one bin for each level, and takes no `from`, `to` and `bins`", word)
              : fmt::format("the axis `{}` needs `from`, `to` and `bins`", word),
          "");
    else if (ends && !(axis.from->value < axis.to->value))
      add(fmt::format("axes[{}].to", i),
          fmt::format("the axis `{}` ends at {}, and begins at {}", word,
                      pretty_quantity(axis.to->value, dimension_of(axis.quantity)),
                      pretty_quantity(axis.from->value, dimension_of(axis.quantity))),
          "`from` is the smaller end");
    if (axis.axis.has_value() != (axis.quantity == Quantity::spin))
      add_at_axis(i,
                  axis.axis ? fmt::format("`{}` takes no `axis`: only `spin` is projected on one", word)
                            : fmt::format("the axis `{}` needs `axis`: the direction that the spin is "
                                          "projected on",
                                          word),
                  "");
  }

  void check_repeats() {
    for (std::size_t i = 0; i < tally_.axes.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        if (tally_.axes[i].quantity == tally_.axes[k].quantity &&
            tally_.axes[i].axis == tally_.axes[k].axis) {
          add_at_axis(i,
                      fmt::format("the tally `{}` has two axes over `{}`", tally_.name,
                                  word_of(tally_.axes[i].quantity)),
                      "keep one of them");
          break;
        }
  }

  void check_size() {
    const std::uint64_t bins = bins_of(tally_, levels_of(beamline_)), planes = planes_of(part_.part);
    if (tally_.axes.size() > 1 && bins > most_tally_bins)
      add("axes",
          fmt::format("the tally `{}` has {} bins in all, and {} are the most", tally_.name, bins,
                      most_tally_bins),
          "give its axes fewer bins, or make several tallies of it");
    else if (bins * planes > most_tally_bins)
      add("axes",
          fmt::format("the tally `{}` has {} bins in each of {} planes, and {} in all are the most",
                      tally_.name, bins, planes, most_tally_bins),
          "give its axes fewer bins, or the monitor fewer planes");
  }

  /// Levels are those of the law `quantum`, and of one spin.
  void check_levels();
  /// How fast a field turns is told against one Larmor frequency, on flights through it in steps.
  void check_turning();
  /// Under `quantum` a measurement is along one direction, and a spin has outcomes and no angles.
  void check_spins();

  const Beamline& beamline_;
  const PlacedPart& part_;
  const Tally& tally_;
  const std::string key_;
  Faults& out_;
};

/// Whether the levels have the same names.
bool has_same_levels(const Species& a, const Species& b) {
  if (a.spin != b.spin || a.structure.has_value() != b.structure.has_value()) return false;
  return !a.structure || a.structure->i == b.structure->i;
}

void TallyRules::check_levels() {
  const Species& first = beamline_.species.front().species;
  for (std::size_t i = 0; i < tally_.axes.size(); ++i) {
    const std::string_view word = word_of(tally_.axes[i].quantity);
    if (!is_categorical(tally_.axes[i].quantity)) continue;
    if (!is_quantum(beamline_)) {
      add_at_axis(i,
                  fmt::format("`{}` counts the levels of the law quantum, but the law is {}", word,
                              describe(beamline_.law)),
                  "a spin that is a vector has a projection: "
                  "`{quantity: spin, axis: z, from: -1, to: 1, bins: 20}`");
      continue;
    }
    const auto other =
        std::find_if(beamline_.species.begin(), beamline_.species.end(),
                     [&](const Component& component) { return !has_same_levels(component.species, first); });
    if (other != beamline_.species.end())
      add_at_axis(
          i,
          fmt::format("`{}` cannot have bins for the levels of both `{}` and `{}`, whose spins differ", word,
                      first.name, other->species.name),
          other->species.structure || first.structure
              ? "fly one of them at a time"
              : "tally `spin` along `axis: z`, in units of I, or fly one of them at a time");
  }
}

void TallyRules::check_turning() {
  const auto atom = std::ranges::find_if(
      beamline_.species, [](const Component& component) { return component.species.structure.has_value(); });
  if (atom == beamline_.species.end()) return;
  for (std::size_t i = 0; i < tally_.axes.size(); ++i)
    if (const Quantity asked = tally_.axes[i].quantity;
        asked == Quantity::adiabaticity || asked == Quantity::adiabaticity_y)
      add_at_axis(i,
                  fmt::format("`{}` is told against one Larmor frequency, but `{}` has a structure of levels",
                              word_of(asked), atom->species.name),
                  "fly a spin 1/2 with the electron's moment through the same fields");
}

void TallyRules::check_spins() {
  const TallyAxis* first = nullptr;
  for (std::size_t i = 0; i < tally_.axes.size(); ++i) {
    const TallyAxis& axis = tally_.axes[i];
    if (is_of_vector_spin(axis.quantity))
      add_at_axis(i,
                  fmt::format("`{}` is an angle of a spin that is a vector, but under the law quantum "
                              "measuring a spin has outcomes",
                              word_of(axis.quantity)),
                  "tally the outcomes along an axis, `{quantity: spin, axis: z, from: -1, to: 1, bins: 2}`, "
                  "or use the law classical");
    if (!asks_for_spin(axis.quantity)) continue;
    if (first && axis.axis.value_or(UnitVector{}) != first->axis.value_or(UnitVector{}))
      add_at_axis(i,
                  fmt::format("the tally `{}` measures the spin along two directions at once, which no "
                              "measurement can under the law quantum",
                              tally_.name),
                  "make two tallies of it");
    if (!first) first = &axis;
  }
}

// ---- names in the results ----

/// Groups of the results, each with who has them and what to blame.
struct Claim {
  std::string name, owner, subject, key;
  enum { own_name, histogram, tally } kind;
};

std::vector<Claim> claims_of(const Beamline& beamline) {
  std::vector<Claim> claims;
  for (const PlacedPart& part : beamline.parts) {
    const std::string& name = part.placement.name;
    const std::vector<Tally>* tallies = tallies_of(part.part);
    if (!tallies) continue;
    const std::string owner = fmt::format("the {} `{}`", kind_of(part.part), name);
    claims.push_back({name, owner, name, "name", Claim::own_name});
    if (detector_in(part.part))
      for (const std::string_view ending : {"_x", "_z", "_levels"})
        claims.push_back({name + std::string(ending), owner, name, "name", Claim::histogram});
    for (std::size_t i = 0; i < tallies->size(); ++i)
      claims.push_back({name + "_" + (*tallies)[i].name,
                        fmt::format("the tally `{}` of `{}`", (*tallies)[i].name, name), name,
                        fmt::format("tallies[{}].name", i), Claim::tally});
  }
  return claims;
}

void check_result_names(const Beamline& beamline, Faults& out) {
  const std::vector<Claim> claims = claims_of(beamline);
  for (std::size_t i = 0; i < claims.size(); ++i)
    for (std::size_t k = 0; k < i; ++k) {
      const Claim *blamed = &claims[i], *other = &claims[k];
      if (blamed->name != other->name) continue;
      if (blamed->kind == Claim::own_name && other->kind == Claim::own_name) continue;  // names differ anyway
      if (other->kind == Claim::tally && blamed->kind == Claim::histogram) std::swap(blamed, other);
      if (blamed->kind == Claim::histogram) std::swap(blamed, other);
      out.push_back({blamed->subject, blamed->key,
                     fmt::format("{} keeps results under the name `{}`{}", other->owner, other->name,
                                 blamed->kind == Claim::tally ? ", as this tally would" : ""),
                     "choose another name"});
    }
}

/// All points count in the same planes, which are an axis of the results.
std::optional<Fault> fault_of_scanned_planes(std::string_view parameter, const ScanPoints& points) {
  for (const Beamline& point : points)
    for (const PlacedPart& now : point.parts) {
      const Monitor* monitor = monitor_in(now.part);
      if (!monitor) continue;
      // Parts stand in the order of their places, which a scan may change.
      const PlacedPart& first = *find_part(points.front(), now.placement.name);
      const Monitor& then = *monitor_in(first.part);
      if (monitor->planes == 1 && then.planes == 1) continue;
      if (monitor->planes == then.planes && monitor->length == then.length &&
          now.placement.at == first.placement.at)
        continue;
      return Fault{"", "",
                   fmt::format("`{}` cannot be scanned: all points count in the same planes of `{}`",
                               parameter, now.placement.name),
                   "make one run for each"};
    }
  return std::nullopt;
}

}  // namespace

void check_tallies(const Beamline& beamline, Faults& out) {
  check_result_names(beamline, out);
  for (const PlacedPart& part : beamline.parts) {
    const std::vector<Tally>* tallies = tallies_of(part.part);
    for (std::size_t i = 0; tallies && i < tallies->size(); ++i) TallyRules(beamline, part, i, out).check();
  }
}

std::optional<Fault> fault_of_scanned_tallies(std::string_view parameter, const ScanPoints& points) {
  if (auto fault = fault_of_scanned_planes(parameter, points)) return fault;
  static constexpr std::uint64_t most_bins = 100'000'000;
  const Beamline& front = points.front();
  for (const PlacedPart& part : front.parts) {
    const std::vector<Tally>* first = tallies_of(part.part);
    if (!first || first->empty()) continue;
    const std::string& name = part.placement.name;
    std::uint64_t bins = 0;
    bool levels = false;
    for (const Tally& tally : *first) {
      bins += bins_of(tally, levels_of(front)) * planes_of(part.part);
      for (const TallyAxis& a : tally.axes) levels = levels || is_categorical(a.quantity);
    }
    if (bins * points.size() > most_bins)
      return Fault{
          "", "",
          fmt::format("the tallies of `{}` have {} bins at each of {} scan points: {} in all, and {} "
                      "are the most",
                      name, bins, points.size(), bins * points.size(), most_bins),
          "scan fewer points, or give the axes fewer bins"};
    for (const Beamline& point : points) {
      if (levels && !has_same_levels(point.species.front().species, front.species.front().species))
        return Fault{
            "", "",
            fmt::format("`{}` cannot be scanned: a tally of `{}` counts levels, and the spins at the "
                        "scan points differ",
                        parameter, name),
            "make one run for each spin, or tally `spin` instead, in units of I"};
      const PlacedPart* now = find_part(point, name);
      if (now && *tallies_of(now->part) != *first)
        return Fault{
            "", "",
            fmt::format("`{}` cannot be scanned: all points fill the same tallies of `{}`", parameter, name),
            "make one run for each"};
    }
  }
  return std::nullopt;
}

}  // namespace rabiline
