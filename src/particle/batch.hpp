#pragma once
// A fixed number of particles as padded columns (structure of arrays).
#include <cstddef>
#include <cstdint>
#include <memory>

namespace rabiline {

/// One particle weighs 2^40 quanta; weights and their sums are integers, so that sums do not depend on their
/// order.
inline constexpr std::uint64_t quanta_per_particle = std::uint64_t{1} << 40;

/// The acceleration of free fall across the beam.
struct Fall {
  double x = 0, z = 0;  // [m/s^2]
  bool operator==(const Fall&) const = default;
};

/// An adiabaticity beyond any axis.
inline constexpr double no_turning = 1e30;

/// Columns of a batch, each `padded` long and aligned to 64 bytes. All particles are referred to the same
/// plane y: where they are, or where their free flight through that plane was or would be (those caught
/// earlier). Plain, because kernels of every instruction set read it.
struct BatchView {
  int count = 0;    // particles; the rest up to `padded` never flies
  int padded = 0;   // multiple of 8
  double y = 0;     // [m] the common plane
  Fall fall;        // of free flight
  bool up = false;  // sx, sy, sz are (0, 0, 1) throughout, behind `padded` too; who writes them says no
  double *x = nullptr, *z = nullptr;                   // [m]
  double *vx = nullptr, *vy = nullptr, *vz = nullptr;  // [m/s]
  double* t = nullptr;                                 // [s] since emission, or since the pulse began
  double *sx = nullptr, *sy = nullptr, *sz = nullptr;  // spin direction (vector laws); image of z (quantum)
  double* slowness = nullptr;                          // [s/m] 1/vy
  double* adiabaticity = nullptr;      // the smallest so far; no_turning where no field has turned
  double* adiabaticity_y = nullptr;    // [m] where it was
  std::uint64_t* level = nullptr;      // 0 for m = I, 1 for m = I-1, ...; its number (quantum)
  std::uint64_t* prepared = nullptr;   // the level that it started in
  std::uint64_t* weight = nullptr;     // [quanta]
  std::uint64_t* particle = nullptr;   // number in the run
  std::uint64_t* flying = nullptr;     // all bits set, or none
  std::uint64_t* caught_by = nullptr;  // part number + 1 of the detector that caught it, or 0
  std::uint64_t* scratch = nullptr;    // a kernel's answer for each particle: bin, end of a region
};

/// The columns, a new one here too: what makes room for particles or copies them goes through these lists.
inline constexpr double* BatchView::*real_columns[] = {
    &BatchView::x,  &BatchView::z,        &BatchView::vx,           &BatchView::vy,
    &BatchView::vz, &BatchView::t,        &BatchView::sx,           &BatchView::sy,
    &BatchView::sz, &BatchView::slowness, &BatchView::adiabaticity, &BatchView::adiabaticity_y};
inline constexpr std::uint64_t* BatchView::*word_columns[] = {
    &BatchView::level,  &BatchView::prepared,  &BatchView::weight, &BatchView::particle,
    &BatchView::flying, &BatchView::caught_by, &BatchView::scratch};

class Batch {
 public:
  static constexpr int capacity = 512;
  static constexpr int columns =
      sizeof(real_columns) / sizeof(*real_columns) + sizeof(word_columns) / sizeof(*word_columns);
  static constexpr std::size_t bytes = sizeof(double) * columns * capacity;

  Batch();
  BatchView& view() { return view_; }
  const BatchView& view() const { return view_; }
  /// Takes over everything but the memory: what a fork of the plan does.
  void copy_from(const Batch& other);
  /// One particle more, of a batch on the same plane.
  void add(const BatchView& from, int particle);

 private:
  struct Free {
    void operator()(void* p) const;
  };
  std::unique_ptr<double, Free> memory_;
  BatchView view_;
};

}  // namespace rabiline
