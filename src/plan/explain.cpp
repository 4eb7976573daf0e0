#include "plan/explain.hpp"

#include <bit>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "plan/explain_atoms.hpp"
#include "plan/explain_magnets.hpp"
#include "plan/level_history.hpp"
#include "plan/magnets.hpp"

namespace rabiline {
namespace {

constexpr double two_pi = 2 * std::numbers::pi;

std::string metres(double y) { return fmt::format("{:8.4f} m", y); }
std::string hertz(double omega) { return pretty_quantity(std::abs(omega) / two_pi, Dimension::frequency); }

/// Prints one chain of the plan: the stages that scan point 0 passes.
class Explainer {
 public:
  Explainer(const Experiment& experiment, const Plan& plan)
      : experiment_(experiment),
        beamline_(experiment.points.front()),
        plan_(plan),
        driven_(experiment, plan) {}

  std::string text() {
    head();
    for (const PlanTree& tree : plan_.trees)
      if (serves_first_point(tree.points) && !seen_component_[static_cast<std::size_t>(tree.component)])
        component(tree);
    cost();
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
        if (!axis.dimension) return axis.labels[i];
        const double value = axis.values[i];
        return pretty_quantity(axis.values.front(), *axis.dimension) !=
                       pretty_quantity(axis.values.back(), *axis.dimension)
                   ? pretty_quantity(value, *axis.dimension)
                   : fmt::format("{:.12g} {}", value, si_unit_of(*axis.dimension));
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
    atom_ = s.structure && std::holds_alternative<QuantumLaw>(beamline_.law);
    on_axis_ = levels_on_axis(beamline_.source, s, beamline_.law);
    line("{}, {:.6g} u, charge {:+g} e; {} particles",
         atom_ ? headline_of(s)
               : fmt::format("{}: spin {}/2, gamma/2pi {:+.6g} MHz/T", s.name, s.spin.twice,
                             s.gyromagnetic_ratio / two_pi / 1e6),
         s.mass / 1.66053906892e-27, s.charge / 1.602176634e-19, tree.last - tree.first);
    if (s.structure && !atom_)
      line("            its levels are left out under this law: the spin is that of J alone");
    speed_ = tree.source.speed;
    const std::size_t law = beamline_.source.speed.index();
    line("{}  source, {}", metres(0),
         law < 2 && tree.source.speed_kind != SpeedKind::converted_gaussian
             ? fmt::format("{} m/s{}", speed_,
                           tree.source.speed_sigma > 0 ? fmt::format(" +- {}", tree.source.speed_sigma) : "")
             : fmt::format("{}, {:.6g} m/s on average",
                           std::visit([](const auto& l) { return l.kind; }, beamline_.source.speed), speed_));
    walk(tree.next);
    const std::string gaps = atom_ ? field_free_gaps(beamline_) : "";
    if (!gaps.empty())
      line(
          "            no field from {}: levels keep their names there, as a weak guiding field would make "
          "them",
          gaps);
  }

  void walk(const std::vector<PlanNode>& nodes) {
    for (const PlanNode& node : nodes)
      if (serves_first_point(node.points)) {
        shared_ = node.points.size();
        node_ = &node;
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
    line("{}  {}: stops what {}{}", metres(p.aperture.y), name_of(p.part),
         p.part < 0                ? "meets its wall"
         : p.aperture.stops_inside ? "hits it"
                                   : "misses its opening",
         reuse());
  }
  void show(const Alignment& a) {
    const double y = beamline_.parts[static_cast<std::size_t>(a.part)].placement.at;
    line("{}  {}: moments along the field with probability {:g}{}", metres(y), name_of(a.part), a.probability,
         reuse());
  }
  void show(const Precession& precession) {
    line("            spins are carried to the next plane{}", reuse());
    for (const SpinZone& zone : precession.zones) show_zone(zone);
  }
  void show(const Filter& f) {
    const double y = beamline_.parts[static_cast<std::size_t>(f.part)].placement.at;
    line("{}  {}: passes spins along ({:.4g}, {:.4g}, {:.4g}) with {:g}, against it with {:g}{}", metres(y),
         name_of(f.part), f.axis[0], f.axis[1], f.axis[2], f.up, f.down, reuse());
  }
  static int levels_found(const PlanNode& node) {
    std::uint64_t levels = 0;
    for (const std::uint64_t mask : node.reach) levels |= mask;
    return std::popcount(levels);
  }
  void show(const LevelProjection& asked) {
    line("            {}: each particle is in one level from here on, {}{}", name_of(asked.part),
         asked.split ? "all are followed with their shares of its weight" : "drawn by its probability",
         reuse());
    if (node_->ways.size() > 1)
      line("{:>16}its paths in {} levels are flown once, and {} ways to share the weights are booked on them",
           "", levels_found(*node_), node_->ways.size());
    if (atom_ && !on_axis_.empty()) on_axis_ = all_levels(*species_);
    show_driven(asked.part);
  }
  /// What drives an atom's levels before a part asks for them, once for each.
  void show_driven(int part) {
    if (!told_.insert(part).second) return;
    for (const std::string& text : driven_.lines(part, speed_)) line("{:>16}{}", "", text);
  }
  void show(const Deflection& d) {
    line("{}  {}: deflects up to {}{}", metres(d.begin), name_of(d.part), metres(d.end), reuse());
    tell(text_of(d, name_of(d.part), speed_));
  }
  void show(const Steering& s) {
    line("{}  {}: steers up to {}, about {:.0f} steps{}", metres(s.begin), name_of(s.part), metres(s.end),
         outlook_of(s, speed_).steps, reuse());
    tell(text_of(s, name_of(s.part), speed_,
                 {on_axis_, 1 / slownesses_of(beamline_.source, species_->mass, 0).from}));
  }
  void tell(const MagnetText& text) {
    for (const std::string& told : text.lines) line("{:>16}{}", "", told);
    on_axis_.clear();
  }
  void show(const Score& s) {
    line("{}  {}: catches and histograms, {} x {} bins{}{}{}", metres(s.screen.y), name_of(s.screen.part),
         s.screen.bins_x, s.screen.bins_z,
         s.screen.efficiency == 1 ? "" : fmt::format(", counts {:g} of each", s.screen.efficiency),
         s.screen.has_dead_area ? ", nothing in its dead area" : "", reuse());
  }
  /// Of a monitor with several planes the first one stands for all.
  void show(const Census& census) {
    if (census.plane > 0) return;
    const PlacedPart& part = beamline_.parts[static_cast<std::size_t>(census.part)];
    const auto& monitor = std::get<Monitor>(part.part);
    line("{}  {}: counts what passes{}{}", metres(census.face.y), name_of(census.part),
         monitor.planes > 1 ? fmt::format(" it and each of {} more planes, to {}", monitor.planes - 1,
                                          metres(place_of_plane(monitor, part.placement, monitor.planes - 1)))
                            : "",
         reuse());
  }
  void show(const Histogram& histogram) {
    if (histogram.plane > 0) return;
    const Part& part = beamline_.parts[static_cast<std::size_t>(histogram.part)].part;
    const auto number = static_cast<std::size_t>(histogram.tally);
    std::string name, axes;
    name = (*tallies_of(part))[number].name;
    const std::uint64_t planes = planes_of(part);
    for (const HistogramAxis& axis : histogram.axes)
      axes += fmt::format("{}{} ({} bins)", axes.empty() ? "" : ", ", word_of(axis.quantity), axis.bins);
    if (!histogram.zones.empty())
      axes += fmt::format(", spins turned from {:.4g} to {:.4g} m", histogram.zones.front().begin,
                          histogram.zones.back().end);
    line("            {} tallies {}: {}; {:.4g} KiB of sums{}", name_of(histogram.part), name, axes,
         static_cast<double>(planes * sums_of(histogram).size() * sizeof(Sum)) / 1024, reuse());
    if (histogram.transitions != nullptr && !histogram.caught) show_driven(histogram.part);
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
    for (const Sight& sight : region.sights) {
      show(sight.census);
      for (const Histogram& tally : sight.tallies) show(tally);
    }
  }
  void show(const SpinStretch& stretch) {
    line("            spins at {}: {} levels, {}{}", name_of(stretch.part), stretch.levels,
         stretch.transitions != nullptr ? "coherent through the fields below, which drive them"
         : stretch.zones.empty()        ? "as they arrive"
         : stretch.from_level && stretch.zones.size() == 1 && stretch.zones.front().kind == ZoneKind::rotating
             ? "closed form"
             : "coherent through the zones below",
         reuse());
    for (const SpinZone& zone : stretch.zones) show_zone(zone);
    show_driven(stretch.part);
  }

  /// The derived numbers of one zone.
  void show_zone(const SpinZone& zone) {
    const double stay = (zone.end - zone.begin) / speed_;
    const double* axis = zone.frame + 6;
    line("{:>12}{:.4f} to {:.4f} m, {}: Larmor {}, {:.4g} turns{}", "", zone.begin, zone.end,
         pretty_quantity(stay, Dimension::time), hertz(zone.spin_rate),
         std::abs(zone.spin_rate) * stay / two_pi,
         zone.turned && zone.spin_rate != 0
             ? fmt::format(" about ({:.3f}, {:.3f}, {:.3f})", axis[0], axis[1], axis[2])
             : "");
    for (int i = 0; i < zone.drives; ++i) show_drive(zone, zone.drive[i], stay);
    if (zone.step > 0)
      line("{:>16}{}: about {:.0f} steps", "",
           zone.kind == ZoneKind::profiled ? "its size runs along the beam" : "no closed form",
           stay / zone.step);
    show_neglected(zone);
  }
  void show_drive(const SpinZone& zone, const DriveTerm& drive, double stay) {
    const double omega = drive.omega + drive.twist * speed_, detuning = omega - zone.spin_rate;
    const double w1 = drive.spin_rate, rate = std::hypot(detuning, w1);
    const bool closed = zone.kind == ZoneKind::rotating || zone.kind == ZoneKind::profiled;
    if (drive.twist != 0)
      line("{:>16}turns by {:.4g} deg/m along the beam: {} at this speed, {:.3g} of its precession", "",
           drive.twist * 180 / std::numbers::pi, hertz(drive.twist * speed_),
           std::abs(drive.twist * speed_ / (zone.spin_rate != 0 ? zone.spin_rate : w1)));
    if (drive.omega == 0) return;
    if (!closed) {
      line("{:>16}{} at {}, {:.4g} deg of precession in its full size", "",
           length_of_second(drive) > 0 ? "turns" : "oscillates", hertz(drive.omega),
           std::abs(w1) * stay * 180 / std::numbers::pi);
      return;
    }
    line("{:>16}rotates at {} about {}z, off resonance by {:+.4g} Hz, tip angle {:.4g} deg on resonance", "",
         hertz(drive.omega), drive.omega < 0 ? '-' : '+', (omega < 0 ? -1 : 1) * detuning / two_pi,
         std::abs(w1) * mean_size(drive) * stay * 180 / std::numbers::pi);
    if (zone.kind == ZoneKind::rotating)
      line("{:>16}resonance width 1/T = {}, flip probability of spin 1/2 here {:.4g}", "",
           pretty_quantity(1 / stay, Dimension::frequency),
           rate > 0 ? std::pow(w1 / rate * std::sin(rate * stay / 2), 2) : 0.0);
  }
  static double length_of_second(const DriveTerm& drive) {
    return std::hypot(drive.second[0], drive.second[1], drive.second[2]);
  }
  /// Mean of a drive's size over its length.
  static double mean_size(const DriveTerm& drive) {
    if (drive.shape == Shape::half_sine) return 2 / std::numbers::pi;
    if (drive.shape == Shape::gaussian) {
      const double ends = drive.length / (2 * drive.sigma);
      return std::sqrt(two_pi) * std::erf(ends / std::numbers::sqrt2) / (2 * ends);
    }
    return 1;
  }
  /// What the rotating-wave approximation leaves out: the other half of the field shifts the resonance by
  /// f0 (w1/w0)^2/4 (Bloch and Siegert 1940).
  void show_neglected(const SpinZone& zone) {
    for (const PlacedPart& part : beamline_.parts) {
      const auto* field = std::get_if<OscillatingField>(&part.part);
      const double begin = part.placement.at;
      if (!field || field->approximation != Approximation::rotating_wave || field->amplitude == 0 ||
          begin > zone.begin || begin + field->length < zone.end)
        continue;
      if (zone.spin_rate == 0) continue;
      const double w0 = std::abs(zone.spin_rate),
                   w1 = std::abs(species_->gyromagnetic_ratio) * field->amplitude / 2;
      const double shift = w0 / two_pi * (w1 / w0) * (w1 / w0) / 4, width = speed_ / (zone.end - zone.begin);
      line(
          "{:>16}{}: rotating-wave approximation; the half left out would shift the resonance by {} ({:.2g} "
          "of "
          "1/T)",
          "", part.placement.name, pretty_quantity(shift, Dimension::frequency), shift / width);
    }
  }

  void cost() {
    double seconds = 0;
    for (const PlanTree& tree : plan_.trees)
      seconds += tree.cost * static_cast<double>(tree.last - tree.first);
    line("");
    line("cost       about {:.2g} s on one core; {:.0f} MiB of memory for each thread", seconds,
         static_cast<double>(plan_.sums * sizeof(Sum) + bytes_at_planes(plan_)) / 1048576.0);
  }

  const Experiment& experiment_;
  const Beamline& beamline_;
  const Plan& plan_;
  const Species* species_ = nullptr;
  double speed_ = 0;
  const DrivenParts driven_;
  const PlanNode* node_ = nullptr;  // that is shown
  bool atom_ = false;
  std::vector<int> on_axis_;  // levels of a beam that nothing has bent yet
  std::set<int> told_;
  std::size_t shared_ = 0;
  std::vector<bool> seen_component_;
  std::string out_;
};

}  // namespace

std::string explain(const Experiment& experiment, const Plan& plan) {
  return Explainer(experiment, plan).text();
}

}  // namespace rabiline
