#pragma once
// Effusion through a round tube whose walls send back what hits them by the cosine law, thin enough that
// molecules meet only walls: P. Clausing, Ann. Phys. 404 (1932) 961; English: J. Vac. Sci. Technol. 8 (1971)
// 636.
#include <vector>

namespace rabiline {

/// Lengths in radii. The tube goes from x = 0, where molecules enter by the cosine law, to x = L, where they
/// leave into a vacuum.
class ChannelFlow {
 public:
  explicit ChannelFlow(double length_over_radius);

  double length() const { return length_; }
  /// Share of what enters that leaves at the far end. Right to 2e-6 (a finer mesh tells).
  double transmission() const { return transmission_; }
  /// Collisions with the wall at x, per area, relative to the entrance. eta(x) + eta(L - x) = 1.
  double wall_rate(double x) const;
  /// j: flux per solid angle at the exit, relative to that of a hole without length at the same angle. 1 on
  /// the axis. A function of the tangent of the angle to the axis.
  double angular(double tangent) const;
  /// Where j has its edge: beyond, no line passes the tube without touching it.
  double edge_tangent() const { return 2 / length_; }

 private:
  void solve();

  double length_, transmission_ = 0;
  std::vector<double> x_, rate_;
};

}  // namespace rabiline
