// Spins that particles cannot start with.
#include <cmath>
#include <numeric>

#include "rules/room.hpp"
#include "spin/level_names.hpp"

namespace rabiline {
namespace {

void check_sum(const std::vector<double>& shares, const char* key, std::string_view what, Faults& out) {
  const double sum = std::accumulate(shares.begin(), shares.end(), 0.0);
  if (std::abs(sum - 1) > 1e-9)
    out.push_back({"source", key, fmt::format("the {} add up to {:.10g}, not to 1", what, sum),
                   "they are shares of all particles"});
}

void check_populations(const Beamline& beamline, const PopulatedSpin& populated, Faults& out) {
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    const auto levels = static_cast<std::size_t>(species.spin.twice) + 1;
    if (species.structure || levels == populated.values.size()) continue;
    out.push_back({"source", "spin.values",
                   fmt::format("`values` has {} entries, but the species `{}` has {} levels",
                               populated.values.size(), species.name, levels),
                   "give one share for each m, from m = I down to m = -I"});
    return;
  }
  check_sum(populated.values, "spin.values", "populations", out);
}

/// Atoms start in levels of their Hamiltonian, which no axis tells apart; point moments have no such levels.
void check_kind(const Beamline& beamline, bool names_levels, bool names_axis, Faults& out) {
  const auto add = [&](std::string message, std::string help) {
    out.push_back({"source", "spin.kind", std::move(message), std::move(help)});
  };
  const bool quantum = is_quantum(beamline);
  if (names_levels && !quantum)
    return add(
        fmt::format("levels exist under the law `quantum` only, not under `{}`", describe(beamline.law)),
        "give the spin a direction: `spin: {kind: polarised, axis: z}`");
  for (const Component& component : beamline.species) {
    const Species& species = component.species;
    if (names_levels && !species.structure)
      return add(fmt::format("the species `{}` has one moment and no levels of two spins", species.name),
                 !atom_called(species).empty()
                     ? fmt::format("write `species: {}` for the atom with its electron", atom_called(species))
                     : "its levels m are given by `{kind: populations, values: [...]}`");
    if (names_axis && species.structure && quantum)
      return add(fmt::format("the levels of `{}` are no levels of one spin along an axis", species.name),
                 fmt::format("write `spin: unpolarised`, or name levels: `{{kind: levels, levels: [{}]}}`",
                             names_of_levels(coupled_spins(*species.structure)).front()));
  }
}

/// "F=4 with m from -4 to 4, F=3 with m from -3 to 3"; of names in a strong field those.
std::string levels_of(const CoupledSpins& spins, bool strong_field) {
  if (strong_field)
    return fmt::format("m_J from {} to {} and m_I from {} to {}", write_half(-spins.twice_j),
                       write_half(spins.twice_j), write_half(-spins.twice_i), write_half(spins.twice_i));
  std::string text;
  int last = -1;
  for (const LevelLabel& label : level_labels(spins)) {
    if (label.twice_f == last) continue;
    last = label.twice_f;
    text += fmt::format("{}F={} with m from {} to {}", text.empty() ? "" : ", ", write_half(last),
                        write_half(-last), write_half(last));
  }
  return text;
}

/// As it is written.
std::string quote(const LevelName& name) {
  const std::string first = write_half(name.twice_first), second = write_half(name.twice_second);
  return name.strong_field ? fmt::format("`m_J={} m_I={}`", first, second)
                           : fmt::format("`F={} m={}`", first, second);
}

}  // namespace

void check_named_levels(const Beamline& beamline, std::span<const LevelName> levels,
                        const std::string& subject, const std::string& list, Faults& out) {
  for (const Component& component : beamline.species) {
    if (!component.species.structure) continue;
    const CoupledSpins spins = coupled_spins(*component.species.structure);
    const std::vector<LevelLabel> labels = level_labels(spins);
    for (std::size_t i = 0; i < levels.size(); ++i) {
      const std::string key = fmt::format("{}[{}]", list, i);
      const std::optional<int> level = find_level(labels, levels[i]);
      if (!level)
        out.push_back({subject, key,
                       fmt::format("`{}` has no level {}", component.species.name, quote(levels[i])),
                       fmt::format("it has {}", levels_of(spins, levels[i].strong_field))});
      for (std::size_t k = 0; level && k < i; ++k)
        if (find_level(labels, levels[k]) == level) {
          out.push_back(
              {subject, key, fmt::format("{} is the level {} again", quote(levels[i]), quote(levels[k])),
               subject == "source" ? "name each level once; `shares` tells how many particles start in it"
                                   : "name each level once"});
          break;
        }
    }
  }
}

namespace {

void check_shares(const LevelsSpin& named, Faults& out) {
  if (!named.shares) return;
  if (named.shares->size() != named.levels.size())
    out.push_back({"source", "spin.shares",
                   fmt::format("`shares` has {} entries, but `levels` has {}", named.shares->size(),
                               named.levels.size()),
                   "give one share for each level"});
  else
    check_sum(*named.shares, "spin.shares", "shares", out);
}

}  // namespace

void check_start_spin(const Beamline& beamline, Faults& out) {
  const StartSpin& spin = beamline.source.spin;
  const auto* populated = std::get_if<PopulatedSpin>(&spin);
  const auto* named = std::get_if<LevelsSpin>(&spin);
  if (populated) check_populations(beamline, *populated, out);
  check_kind(beamline, named != nullptr || std::holds_alternative<ThermalSpin>(spin),
             populated != nullptr || std::holds_alternative<PolarisedSpin>(spin), out);
  if (!named) return;
  check_named_levels(beamline, named->levels, "source", "spin.levels", out);
  check_shares(*named, out);
}

}  // namespace rabiline
