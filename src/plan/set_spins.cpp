#include "plan/set_spins.hpp"

#include <algorithm>
#include <cassert>

#include "spin/level_names.hpp"

namespace rabiline {

Alignment alignment_of(const AlignTerm& term, const Plane& plane, const Species& species, bool quantum) {
  const double spin_along_field = species.gyromagnetic_ratio < 0 ? -1 : 1;  // mu = gamma S
  Alignment alignment{.probability = term.probability,
                      .spin_sign = spin_along_field * term.field_sign,
                      .axis = {term.axis.x, term.axis.y, term.axis.z},
                      .levels = quantum ? species.levels() : 0,
                      .against = quantum ? species.levels() - 1 : 0,
                      .part = plane.part,
                      .at = plane.y};
  if (!quantum || !species.structure) return alignment;
  // Levels are those along the field itself; where the energy of m = F grows with it the moment is against
  // it.
  const CoupledSpins spins = coupled_spins(*species.structure);
  const std::vector<LevelLabel> labels = level_labels(spins);
  const int twice_f = spins.twice_i + spins.twice_j;
  alignment.spin_sign = spins.twice_j * spins.zeeman_j + spins.twice_i * spins.zeeman_i > 0 ? -1 : 1;
  alignment.along = find_weak_field_level(labels, twice_f, twice_f).value();
  alignment.against = find_weak_field_level(labels, twice_f, -twice_f).value();
  return alignment;
}

Filter filter_of(const FilterTerm& term, const Plane& plane, [[maybe_unused]] const Species& species,
                 bool quantum) {
  assert(!quantum || (!species.structure && species.spin.twice == 1));
  return {{term.axis.x, term.axis.y, term.axis.z}, term.up, term.down, quantum, plane.part, plane.y};
}

LevelFilter level_filter_of(const FilterTerm& term, const Plane& plane, const Species& atom) {
  LevelFilter filter{.named = static_cast<int>(term.levels.size()), .part = plane.part, .at = plane.y};
  std::fill_n(filter.passes, atom.levels(), term.down);
  const std::vector<LevelLabel> labels = level_labels(coupled_spins(*atom.structure));
  for (const LevelName& name : term.levels) filter.passes[find_level(labels, name).value()] = term.up;
  return filter;
}

}  // namespace rabiline
