#pragma once
// Labels of the levels of two coupled spins, and their one order.
#include <optional>
#include <span>
#include <vector>

#include "spin/coupled_spins.hpp"

namespace rabiline {

/// One level by its two names: (F, m_F) is what it is in a weak field, (m_J, m_I) what it becomes in a strong
/// one when the field changes slowly. m_F = m_J + m_I at every field.
///
/// The rule: within one m_F the energies never cross for B > 0, since I.J couples neighbouring m_J there (a
/// tridiagonal matrix without zeros beside the diagonal has simple eigenvalues; with (I.J)^2 a crossing would
/// take a coincidence of the constants). So the n-th energy of an m_F, counted from below, is the same level
/// at every field: it has the n-th lowest F at zero field and the m_J of the n-th lowest Zeeman energy.
/// Inverted structure (a negative coupling, as in silver) is nothing special: there the largest F is the
/// lowest. Where F are degenerate at zero field, as without coupling, they are named as for a vanishing
/// positive coupling.
struct LevelLabel {
  int twice_f = 0, twice_m = 0;      // 2F, 2m_F
  int twice_m_j = 0, twice_m_i = 0;  // 2m_J, 2m_I
  bool operator==(const LevelLabel&) const = default;
};

/// All levels in the one order used everywhere: F from I+J down, within each F m_F from +F down. It does not
/// depend on the field or on the constants. For H: (1,1) (1,0) (1,-1) (0,0).
std::vector<LevelLabel> level_labels(const CoupledSpins& spins);
/// The level (F, m_F), its number in that order.
std::optional<int> find_weak_field_level(std::span<const LevelLabel> labels, int twice_f, int twice_m);
/// The level (m_J, m_I), its number in that order.
std::optional<int> find_strong_field_level(std::span<const LevelLabel> labels, int twice_m_j, int twice_m_i);

}  // namespace rabiline
