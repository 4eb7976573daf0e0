#pragma once
// Two angular momenta I and J that feel each other and a magnetic field: the Hamiltonian of atoms with
// hyperfine structure and of molecules like ortho-H2.
namespace rabiline {

/// H/h = coupling I.J + coupling_squared (I.J)^2 + offset + B (zeeman_i I_z + zeeman_j J_z)
///
/// +z is along the field, B >= 0 is its size in tesla, and I and J are in units of hbar. A moment
/// mu = gamma hbar I has the energy -mu.B, so zeeman_i = -gamma/2pi: negative for a proton.
/// The basis is |m_J, m_I>: m_J runs slowly, and both run from the top down.
struct CoupledSpins {
  int twice_i = 0;              // 2I
  int twice_j = 0;              // 2J
  double coupling = 0;          // [Hz]
  double coupling_squared = 0;  // [Hz]
  double offset = 0;            // [Hz]
  double zeeman_i = 0;          // [Hz/T]
  double zeeman_j = 0;          // [Hz/T]
  bool operator==(const CoupledSpins&) const = default;

  int levels() const { return (twice_i + 1) * (twice_j + 1); }
  int product_index(int twice_m_j, int twice_m_i) const {
    return (twice_j - twice_m_j) / 2 * (twice_i + 1) + (twice_i - twice_m_i) / 2;
  }
  int twice_m_j(int product_index) const { return twice_j - 2 * (product_index / (twice_i + 1)); }
  int twice_m_i(int product_index) const { return twice_i - 2 * (product_index % (twice_i + 1)); }
};

/// <I.J> in a state of total angular momentum F = I + J, (F(F+1) - I(I+1) - J(J+1)) / 2.
double scalar_product(const CoupledSpins& spins, int twice_f);
/// Energy of the level F at B = 0, E/h in hertz.
double zero_field_energy(const CoupledSpins& spins, int twice_f);

/// Adds the interaction of quadrupole type, with weight k in hertz:
///   k [3 (I.J)^2 + (3/2) I.J - I(I+1) J(J+1)]
/// For an atom's constant B_quadrupole, k = B / (2I(2I-1) J(2J-1)) (N. Ramsey, Molecular Beams, 1956, ch.
/// III).
void add_quadrupole(CoupledSpins& spins, double weight);

}  // namespace rabiline
