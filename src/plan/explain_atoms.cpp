#include "plan/explain_atoms.hpp"

#include <algorithm>
#include <numeric>
#include <set>
#include <utility>

#include <fmt/format.h>

#include "plan/level_lines.hpp"
#include "spin/level_names.hpp"
#include "spin/levels.hpp"

namespace rabiline {

std::string headline_of(const Species& atom) {
  const Structure& s = *atom.structure;
  const CoupledSpins spins = coupled_spins(s);
  std::vector<std::pair<double, int>> terms;  // energy and 2F
  for (int twice_f = std::abs(s.i.twice - s.j.twice); twice_f <= s.i.twice + s.j.twice; twice_f += 2)
    terms.emplace_back(zero_field_energy(spins, twice_f), twice_f);
  std::sort(terms.begin(), terms.end());
  std::string apart;
  for (std::size_t i = 1; i < terms.size() && i < 4; ++i)
    apart += fmt::format(", F={} above F={} by {}", write_half(terms[i].second),
                         write_half(terms[i - 1].second), megahertz(terms[i].first - terms[i - 1].first));
  return fmt::format("{}: I = {}, J = {}, {} levels{}", atom.name, write_half(s.i.twice),
                     write_half(s.j.twice), s.levels(), apart);
}

std::string field_free_gaps(const Beamline& beamline) {
  std::vector<std::pair<double, double>> fields;
  for (const PlacedPart& part : beamline.parts)
    if (holds_spins(part.part)) fields.emplace_back(part.placement.at, end_of(part));
  for (const Section& section : sections_of(beamline).sections)
    if (section.has_shaped_fields()) fields.emplace_back(section.begin, section.end);
  std::sort(fields.begin(), fields.end());
  std::string gaps;
  double reach = fields.empty() ? 0 : fields.front().second;
  for (const auto& [begin, end] : fields) {
    if (begin > reach + 1e-9)
      gaps += fmt::format("{}{:.4g} to {:.4g} m", gaps.empty() ? "" : ", ", reach, begin);
    reach = std::max(reach, end);
  }
  return gaps;
}

std::vector<int> all_levels(const Species& species) {
  std::vector<int> levels(static_cast<std::size_t>(species.levels()));
  std::iota(levels.begin(), levels.end(), 0);
  return levels;
}

std::vector<int> levels_on_axis(const Source& source, const Species& species, const Law& law) {
  if (!law_traits(law).has_levels || source.offset != Offset{} || !(source.tilt == SourceTilt{})) return {};
  const auto* named = std::get_if<LevelsSpin>(&source.spin);
  if (!named || !species.structure) return all_levels(species);
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(*species.structure));
  std::set<int> levels;
  for (const LevelName& name : named->levels)
    if (const auto level = find_level(labels, name)) levels.insert(*level);
  return {levels.begin(), levels.end()};
}

}  // namespace rabiline
