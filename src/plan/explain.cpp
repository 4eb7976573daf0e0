#include "plan/explain.hpp"

#include <bit>
#include <map>
#include <set>

#include <fmt/format.h>

#include "core/constants.hpp"
#include "particle/channel.hpp"
#include "plan/driven_parts.hpp"
#include "plan/explain_atoms.hpp"
#include "plan/level_history.hpp"
#include "plan/plan.hpp"
#include "plan/stretches.hpp"
#include "transport/describe_outlook.hpp"
#include "transport/plan_report.hpp"

namespace rabiline {
namespace {

using constants::two_pi;

/// Prints one chain of the plan: the stages that scan point 0 passes.
class Explainer {
 public:
  Explainer(const Experiment& experiment, const Plan& plan)
      : experiment_(experiment),
        beamline_(experiment.points.front()),
        plan_(plan),
        flies_for_all_(experiment.points.size() > static_cast<std::size_t>(plan.points)),
        driven_(experiment, plan),
        report_(beamline_) {
    report_.tell_driven = [this](int part) { tell_driven(part); };
    report_.fastest = [this] { return speed_range(beamline_.source.speed, report_.species->mass).fastest; };
  }

  std::string text() {
    head();
    for (const PlanTree& tree : plan_.trees)
      if (serves_first_point(tree.points) && !seen_component_[static_cast<std::size_t>(tree.component)])
        component(tree);
    return std::move(report_.text);
  }
  /// What the stages warn of.
  std::vector<Fault> warnings() {
    text();
    return std::move(report_.warnings);
  }

 private:
  template <class... Args>
  void line(fmt::format_string<Args...> format, Args&&... args) {
    report_.line(format, std::forward<Args>(args)...);
  }
  static bool serves_first_point(const std::vector<int>& points) {
    return !points.empty() && points.front() == 0;
  }
  void head() {
    if (!beamline_.title.empty()) line("{}", beamline_.title);
    line("law        {}", describe(beamline_.law));
    for (const ScanAxis& axis : experiment_.axes) {
      const std::size_t last = axis.values.size() - 1;
      line("scan       {}: {}", axis.parameter,
           last == 0 ? fmt::format("{}, one point", value_at(axis, 0))
                     : fmt::format("{} to {}, {} points", value_at(axis, 0), value_at(axis, last), last + 1));
    }
    const std::string_view at_most = beamline_.until ? "at most " : "";
    if (experiment_.points.size() > 1)
      line("particles  {}{} at each of {} points, {}", at_most, beamline_.particles,
           experiment_.points.size(),
           experiment_.particles == ScanParticles::shared ? "the same ones" : "each its own");
    else
      line("particles  {}{}", at_most, beamline_.particles);
    if (beamline_.until) tell_precision(*beamline_.until);
    seen_component_.assign(beamline_.species.size(), false);
  }

  void tell_precision(const Until& until) {
    std::string wanted;
    if (until.detected_error)
      wanted = fmt::format("the error of `detected` is {:.3g} everywhere", *until.detected_error);
    if (until.centre_error)
      wanted += fmt::format("{} error of the line's centre is {}", wanted.empty() ? "the" : ", and the",
                            pretty_quantity(until.centre_error->value, until.centre_error->dimension));
    line("until      {}, asked whenever twice as many have flown", wanted);
  }

  void component(const PlanTree& tree) {
    seen_component_[static_cast<std::size_t>(tree.component)] = true;
    const Species& s = beamline_.species[static_cast<std::size_t>(tree.component)].species;
    report_.species = &s;
    component_ = tree.component;
    line("");
    const bool of_atom = s.structure && law_traits(beamline_.law).has_levels;
    report_.of_atom = of_atom;
    report_.on_axis = levels_on_axis(beamline_.source, s, beamline_.law);
    line("{}, {:.6g} u, charge {} e; {} particles",
         of_atom ? headline_of(s)
                 : fmt::format("{}: spin {}, gamma/2pi {:+.6g} MHz/T", s.name, write_half(s.spin.twice),
                               s.gyromagnetic_ratio / two_pi / 1e6),
         s.mass / 1.66053906892e-27, s.charge == 0 ? "0" : fmt::format("{:+g}", s.charge / 1.602176634e-19),
         tree.last - tree.first);
    if (s.structure && !of_atom)
      line("            its levels are left out under this law: the spin is that of J alone");
    const SpeedDraw& drawn = tree.source.speed;
    report_.flight = mean_flight(beamline_, s.mass);
    report_.tip = 0;
    line("{}  source, {}", PlanReport::metres(0),
         drawn.kind == SpeedKind::single ||
                 (drawn.kind == SpeedKind::gaussian && drawn.scale == SpeedScale::proportional)
             ? fmt::format("{:.9g} m/s{}", report_.flight.speed,
                           drawn.sigma > 0 ? fmt::format(" +- {}", drawn.sigma) : "")
             : fmt::format("{}, {:.6g} m/s on average",
                           std::visit([](const auto& l) { return l.kind; }, beamline_.source.speed),
                           report_.flight.speed));
    explain_channel();
    walk(tree.next);
    const std::string gaps = of_atom ? field_free_gaps(beamline_) : "";
    if (of_atom) coherent_stretches(s);
    if (!gaps.empty())
      line(
          "            no field from {}: levels keep their names there, as a weak guiding field would make "
          "them",
          gaps);
  }

  /// An atom has no stage there.
  void coherent_stretches(const Species& atom) {
    for (const Stretch& stretch : stretches_of(beamline_, atom, sections_of(beamline_)))
      if (!stretch.outlook.sorts && stretch.outlook.splitting > 0)
        line("            {:.4f} to {:.4f} m: {}", stretch.begin, stretch.end,
             describe_levels(stretch.outlook, true));
  }

  /// The peaking factor is the intensity on the axis over that of a thin hole with the same flow (H. Pauly,
  /// Atom, Molecule, and Cluster Beams I, 2000): 1/W, since on the axis a tube gives what its opening alone
  /// would.
  void explain_channel() {
    const DirectionLaw& direction = beamline_.source.direction;
    const auto* channel = std::get_if<ChannelDirection>(&direction);
    if (const auto* aimed = std::get_if<AimedDirection>(&direction))
      channel = std::get_if<ChannelDirection>(&aimed->emission);
    if (channel == nullptr) return;
    const double transmission = ChannelFlow(channel->length / channel->radius).transmission();
    line("            its channel transmits W = {:.5g} of what enters it; peaking factor 1/W = {:.5g}",
         transmission, 1 / transmission);
  }

  void walk(const std::vector<PlanNode>& nodes) {
    for (const PlanNode& node : nodes)
      if (serves_first_point(node.points)) {
        report_.reuse = reuse(node.points.size());
        report_.reweightings = flies_for_all_ ? experiment_.points.size() : node.reweightings.size();
        report_.levels_found = levels_found(node);
        report_.slowness_cells = node.transit ? node.transit->cells().count : 0;
        report_.fewest_nodes = node.classes.empty() ? 0 : nodes_in(node.classes.front());
        report_.most_nodes = node.classes.empty() ? 0 : nodes_in(node.classes.back());
        report_.why_one_by_one = node.why_one_by_one;
        rabiline::explain(node.stage, report_);
        walk(node.next);
      }
  }
  static int levels_found(const PlanNode& node) {
    std::uint64_t levels = 0;
    for (const std::uint64_t mask : node.reachable_levels) levels |= mask;
    return std::popcount(levels);
  }
  /// What drives an atom's levels before a part asks for them, once for each.
  void tell_driven(int part) {
    if (!told_.insert({component_, part}).second) return;
    const std::vector<std::string> lines = driven_.lines(component_, part, report_.flight);
    if (lines.empty()) return;
    const auto [first, is_new] = told_by_.emplace(lines, part);
    if (!is_new) {
      line("{:>16}what drives levels is as told of {}", "",
           beamline_.parts[static_cast<std::size_t>(first->second)].placement.name);
      return;
    }
    for (const std::string& text : lines) line("{:>16}{}", "", text);
  }
  std::string reuse(std::size_t shared) const {
    if (experiment_.points.size() == 1) return "";
    if (flies_for_all_) return "  [once for all points]";
    if (shared == 1) return "  [this point only]";
    return shared == static_cast<std::size_t>(plan_.points) ? "  [once for all points]"
                                                            : fmt::format("  [once for {} points]", shared);
  }

  const Experiment& experiment_;
  const Beamline& beamline_;
  const Plan& plan_;
  const bool flies_for_all_;  // the first point, from which the others follow
  const DrivenParts driven_;
  int component_ = 0;                                // of the beam, that is told of
  std::set<std::pair<int, int>> told_;               // component and part
  std::map<std::vector<std::string>, int> told_by_;  // of which part
  std::vector<bool> seen_component_;
  PlanReport report_;
};

}  // namespace

std::string explain(const Experiment& experiment, const Plan& plan) {
  return Explainer(experiment, plan).text();
}

std::vector<Fault> warnings_of_stages(const Experiment& experiment, const Plan& plan) {
  return Explainer(experiment, plan).warnings();
}

}  // namespace rabiline
