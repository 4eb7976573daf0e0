#include "plan/explain.hpp"

#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace rabiline {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

std::string metres(double y) { return fmt::format("{:8.4f} m", y); }
std::string hertz(double omega) { return pretty_quantity(std::abs(omega) / two_pi, Dimension::frequency); }

/// Prints one chain of the plan: the stages that scan point 0 passes.
class Explainer {
 public:
  Explainer(const Experiment& experiment, const Plan& plan)
      : experiment_(experiment), beamline_(experiment.points.front()), plan_(plan) {}

  std::string text() {
    head();
    for (const PlanTree& tree : plan_.trees)
      if (serves_first_point(tree.points) && !seen_component_[static_cast<std::size_t>(tree.component)])
        component(tree);
    cost();
    for (const std::string& warning : warnings_) out_ += "warning: " + warning + "\n";
    return std::move(out_);
  }

 private:
  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    out_ += fmt::format(format, std::forward<Args>(args)...) + "\n";
  }
  static bool serves_first_point(const std::vector<int>& points) {
    return !points.empty() && points.front() == 0;
  }
  std::string name_of(int part) const {
    return part < 0 ? "chamber" : beamline_.parts[static_cast<std::size_t>(part)].placement.name;
  }

  void head() {
    line("{}", beamline_.title);
    line("law        {}", describe(beamline_.law));
    for (const ScanAxis& axis : experiment_.axes) {
      const auto show = [&](std::size_t i) {
        return axis.dimension ? pretty_quantity(axis.values[i], *axis.dimension) : axis.labels[i];
      };
      const std::size_t last = axis.values.size() - 1;
      line("scan       {}: {} to {}, {} points", axis.parameter, show(0), show(last), last + 1);
    }
    if (!experiment_.axes.empty())
      line("particles  {} at each of {} points, {}", beamline_.particles, plan_.points,
           experiment_.particles == ScanParticles::shared ? "the same ones" : "each its own");
    else
      line("particles  {}", beamline_.particles);
    seen_component_.assign(beamline_.species.size(), false);
  }

  void component(const PlanTree& tree) {
    seen_component_[static_cast<std::size_t>(tree.component)] = true;
    species_ = &beamline_.species[static_cast<std::size_t>(tree.component)].species;
    const Species& s = *species_;
    line("");
    line("{}: spin {}/2, gamma/2pi {:+.6g} MHz/T, {:.6g} u, charge {:+g} e; {} particles", s.name,
         s.spin.twice, s.gyromagnetic_ratio / two_pi / 1e6, s.mass / 1.66053906892e-27,
         s.charge / 1.602176634e-19, tree.last - tree.first);
    speed_ = tree.source.speed;
    tip_ = 0;
    line("{}  source, {} m/s{}", metres(0), speed_,
         tree.source.speed_sigma > 0 ? fmt::format(" +- {}", tree.source.speed_sigma) : "");
    walk(tree.next);
  }

  void walk(const std::vector<PlanNode>& nodes) {
    for (const PlanNode& node : nodes)
      if (serves_first_point(node.points)) {
        shared_ = node.points.size();
        std::visit([&](const auto& stage) { show(stage); }, node.stage);
        walk(node.next);
      }
  }
  std::string reuse() const {
    if (plan_.points == 1) return "";
    if (shared_ == 1) return "  [this point only]";
    return shared_ == static_cast<std::size_t>(plan_.points) ? "  [once for all points]"
                                                             : fmt::format("  [once for {} points]", shared_);
  }

  void show(const Drift& drift) { line("{}  straight to here{}", metres(drift.y), reuse()); }
  void show(const Passage& p) {
    line("{}  {}: stops what misses its {}{}", metres(p.aperture.y), name_of(p.part),
         p.part < 0 ? "wall" : "opening", reuse());
  }
  void show(const Alignment& a) {
    tip_ = 0;
    const double y = beamline_.parts[static_cast<std::size_t>(a.part)].placement.at;
    line("{}  {}: moments along the field with probability {:g}{}", metres(y), name_of(a.part), a.probability,
         reuse());
  }
  void show(const Score& s) {
    line("{}  {}: catches and histograms, {} x {} bins{}{}{}", metres(s.screen.y), name_of(s.screen.part),
         s.screen.bins_x, s.screen.bins_z,
         s.screen.efficiency == 1 ? "" : fmt::format(", counts {:g} of each", s.screen.efficiency),
         s.screen.has_dead_area ? ", nothing in its dead area" : "", reuse());
  }
  void show(const Census& census) {
    line("{}  {}: counts what passes{}", metres(census.face.y), name_of(census.part), reuse());
  }
  void show(const Histogram& histogram) {
    const Part& part = beamline_.parts[static_cast<std::size_t>(histogram.part)].part;
    const auto number = static_cast<std::size_t>(histogram.tally);
    std::string name, axes;
    if (const auto* monitor = std::get_if<Monitor>(&part)) name = monitor->tallies[number].name;
    if (const auto* detector = std::get_if<Detector>(&part)) name = detector->tallies[number].name;
    for (const HistogramAxis& axis : histogram.axes)
      axes += fmt::format("{}{} ({} bins)", axes.empty() ? "" : ", ", word_of(axis.quantity), axis.bins);
    if (!histogram.zones.empty())
      axes += fmt::format(", spins turned from {:.4g} to {:.4g} m", histogram.zones.front().begin,
                          histogram.zones.back().end);
    line("            {} tallies {}: {}; {:.4g} KiB of sums{}", name_of(histogram.part), name, axes,
         static_cast<double>(sums_of(histogram).size() * sizeof(Sum)) / 1024, reuse());
  }
  static std::string_view word_of(Quantity quantity) {
    for (const auto& choice : choices<Quantity>)
      if (choice.value == quantity) return choice.word;
    return "";
  }
  void show(const Exit&) { line("            what still flies has passed{}", reuse()); }
  void show(const TurningRegion& region) {
    line("{}  region that turns the velocity, to {}{}", metres(region.zones.front().field.begin),
         metres(region.zones.back().field.end), reuse());
    for (const RegionZone& zone : region.zones) {
      show_zone(zone.field);
      const double rate = std::max(std::abs(zone.field.spin_rate), std::abs(zone.field.turn_rate));
      if (rate > 0)
        line("{:>16}steps of {}, {:.0f} per turn", "", pretty_quantity(zone.step, Dimension::time),
             two_pi / (rate * zone.step));
    }
    warn_of_claim_one(region);
  }
  void show(const SpinStretch& stretch) {
    line("            spins at {}: {} levels, {}{}", name_of(stretch.part), stretch.levels,
         stretch.zones.empty()                             ? "as they arrive"
         : stretch.from_level && stretch.zones.size() == 1 ? "closed form"
                                                           : "coherent through the zones below",
         reuse());
    for (const SpinZone& zone : stretch.zones) show_zone(zone);
  }

  /// The derived numbers of one zone.
  void show_zone(const SpinZone& zone) {
    const double stay = (zone.end - zone.begin) / speed_;
    line("{:>12}{:.4f} to {:.4f} m, {}: Larmor {}, {:.4g} turns", "", zone.begin, zone.end,
         pretty_quantity(stay, Dimension::time), hertz(zone.spin_rate),
         std::abs(zone.spin_rate) * stay / two_pi);
    for (int i = 0; i < zone.drives; ++i) {
      const DriveTerm& drive = zone.drive[i];
      const double detuning = drive.omega - zone.spin_rate, w1 = drive.spin_rate;
      const double rate = std::hypot(detuning, w1);
      if (drive.omega * zone.spin_rate < 0)
        warnings_.push_back(
            fmt::format("the field that rotates from {:.4g} m on turns against the precession there and "
                        "cannot be resonant",
                        zone.begin));
      line("{:>16}rotates at {} about {}z, off resonance by {:+.4g} Hz, tip angle {:.4g} deg on resonance",
           "", hertz(drive.omega), drive.omega < 0 ? '-' : '+',
           (drive.omega < 0 ? -1 : 1) * detuning / two_pi, std::abs(w1) * stay * 180 / std::numbers::pi);
      line("{:>16}resonance width 1/T = {}, flip probability of spin 1/2 here {:.4g}", "",
           pretty_quantity(1 / stay, Dimension::frequency),
           rate > 0 ? std::pow(w1 / rate * std::sin(rate * stay / 2), 2) : 0.0);
    }
  }

  /// Under `torque` tipped spins keep turning the path in every field until something aligns them again, and
  /// a large tip deflects nearly everything. `tip_` is what all drives since the last alignment can have
  /// done.
  void warn_of_claim_one(const TurningRegion& region) {
    if (!region.take_off_spin_component) return;
    for (std::size_t i = 0; i < region.zones.size(); ++i) {
      const SpinZone& zone = region.zones[i].field;
      if (tip_ > 0 && zone.drives == 0 && zone.turn_rate != 0)
        warnings_.push_back(
            fmt::format("behind the rotating field a uniform field goes on to {:.4g} m: under closure torque "
                        "it keeps turning "
                        "the path of tipped spins",
                        zone.end));
      const bool before = tip_ > large_tip;
      for (int k = 0; k < zone.drives; ++k)
        tip_ += std::abs(zone.drive[k].spin_rate) * (zone.end - zone.begin) / speed_;
      if (tip_ > large_tip && !before) tip_is_large_ = true;
      if (i < region.edges.size() && region.edges[i].kind == EdgeKind::align) tip_ = 0;
    }
    if (tip_is_large_)
      warnings_.push_back(
          fmt::format("the tip angle on resonance, {:.3g} deg, is large: under closure torque nearly all "
                      "frequencies then "
                      "deflect, and the resonance is far wider than 1/T",
                      tip_ * 180 / std::numbers::pi));
    tip_is_large_ = false;
  }

  void cost() {
    double seconds = 0;
    for (const PlanTree& tree : plan_.trees)
      seconds += tree.cost * static_cast<double>(tree.last - tree.first);
    line("");
    line("cost       about {:.2g} s on one core; {:.0f} MiB of sums for each thread", seconds,
         static_cast<double>(plan_.sums * sizeof(Sum)) / 1048576.0);
  }

  const Experiment& experiment_;
  const Beamline& beamline_;
  const Plan& plan_;
  const Species* species_ = nullptr;
  static constexpr double large_tip = 0.05;  // [rad]
  double speed_ = 0, tip_ = 0;
  bool tip_is_large_ = false;
  std::size_t shared_ = 0;
  std::vector<bool> seen_component_;
  std::vector<std::string> warnings_;
  std::string out_;
};

}  // namespace

std::string explain(const Experiment& experiment, const Plan& plan) {
  return Explainer(experiment, plan).text();
}

}  // namespace rabiline
