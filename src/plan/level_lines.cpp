#include "plan/level_lines.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include <fmt/format.h>

#include "core/units.hpp"
#include "spin/level_names.hpp"
#include "spin/levels.hpp"
#include "spin/rotating_frame.hpp"

namespace rabiline {

DrivenZone driven_zone(const LevelZone& zone) {
  const RotatingTerm& drive = *zone.drive;
  return {zone.begin,      zone.end,
          zone.field,      drive.oscillator.frequency,
          parts_of(drive), drive.envelope.shape == Shape::rectangular,
          drive.gate,      zone.part};
}

std::vector<Transition> transitions_near(const Structure& structure, const DrivenZone& zone) {
  const CoupledSpins spins = coupled_spins(structure);
  const Levels levels = levels_at(spins, zone.field);
  const DrivenStates states = driven_states(spins, levels, zone.parts);
  const DrivenStates* const alone[] = {&states};
  const RotatingFrame frame = rotating_frame(levels.labels, zone.parts.sense(), zone.frequency, alone);
  const Eigen::VectorXd shifts =  // by what does not stand still in it
      standing_coupling(frame, states).second.diagonal();
  const double negligible = 1e-14 * states.energy.cwiseAbs().maxCoeff();
  std::vector<Transition> out;
  for (int i = 0; i < spins.levels(); ++i)
    for (int k = 0; k < spins.levels(); ++k) {
      double apart = states.energy(i) - states.energy(k);
      if (std::abs(apart) < negligible) apart = 0;
      const bool is_there_already = apart == 0 && i > k && states.up(k, i) != 0;
      if (i == k || apart < 0 || is_there_already || states.up(i, k) == 0) continue;
      out.push_back(
          {i, k, apart, zone.frequency - apart, 2 * std::abs(states.up(i, k)), shifts(i) - shifts(k)});
    }
  std::stable_sort(out.begin(), out.end(), [](const Transition& a, const Transition& b) {
    return std::abs(a.detuning) < std::abs(b.detuning);
  });
  return out;
}

std::vector<Transition> transitions_of_two_photons(const Structure& structure, const DrivenZone& zone,
                                                   double width) {
  const CoupledSpins spins = coupled_spins(structure);
  const Levels levels = levels_at(spins, zone.field);
  const DrivenStates states = driven_states(spins, levels, zone.parts);
  const double frequency = zone.frequency;
  const Eigen::MatrixXd& up = states.up;
  std::vector<Eigen::MatrixXd> in_phase{up};
  if (!zone.parts.in_phase) {
    DriveParts across = zone.parts, along{0, 0, zone.parts.along};
    across.along = 0;
    in_phase = {driven_states(spins, levels, across).up, driven_states(spins, levels, along).up};
  }
  const auto shifted = [&](int i) {
    double sum = 0;
    for (int k = 0; k < spins.levels(); ++k) {
      const double apart = states.energy(i) - states.energy(k);
      if (k != i)
        sum += up(k, i) * up(k, i) / (apart + frequency) + up(i, k) * up(i, k) / (apart - frequency);
    }
    return sum;
  };
  // One that a photon takes to another level has no line of its own, nor a shift by that.
  const auto is_mixed = [&](int i) {
    const auto mixes = [&](double coupling, double off) {
      return coupling != 0 && std::abs(off) < 2 * (width + 2 * std::abs(coupling));
    };
    for (int k = 0; k < spins.levels(); ++k) {
      const double apart = states.energy(i) - states.energy(k);
      if (k != i && (mixes(up(k, i), apart + frequency) || mixes(up(i, k), apart - frequency))) return true;
    }
    return false;
  };
  std::vector<Transition> out;
  for (const CoupledPair& pair : pairs_of_two_photons(states.energy, in_phase, frequency)) {
    const double apart = states.energy(pair.upper) - states.energy(pair.lower), rabi = 2 * pair.coupling,
                 detuning = 2 * frequency - apart;
    bool is_by_one = false;  // after the other
    for (int by = 0; by < spins.levels(); ++by) {
      if (by == pair.upper || by == pair.lower) continue;
      const double first = std::abs(up(by, pair.lower)), last = std::abs(up(pair.upper, by)),
                   off = states.energy(pair.lower) + frequency - states.energy(by);
      is_by_one =
          is_by_one || (first * last != 0 && std::abs(off) <= 10 * (width + 2 * std::max(first, last)));
    }
    if (!is_by_one && !is_mixed(pair.upper) && !is_mixed(pair.lower) && rabi > 0.01 * width &&
        std::abs(detuning) <= 100 * (width + rabi))
      out.push_back(
          {pair.upper, pair.lower, apart, detuning, rabi, shifted(pair.upper) - shifted(pair.lower), 2});
  }
  std::ranges::stable_sort(out, {}, [](const Transition& t) { return std::abs(t.detuning); });
  return out;
}

bool is_pulsed(const DrivenZone& zone) { return zone.gate != Gate{}; }

double width_of(const DrivenZone& zone, double length, double speed) {
  const double passing = speed / length;
  const Gate& gate = zone.gate;
  return is_pulsed(zone) ? std::max(passing, 1 / (gate.end - gate.begin)) : passing;
}

std::string megahertz(double f) {
  return std::abs(f) < 1e5 ? pretty_quantity(f, Dimension::frequency) : fmt::format("{:.10g} MHz", f / 1e6);
}

std::string name_of(const Structure& structure, const Transition& t) {
  const std::vector<std::string> names = names_of_levels(coupled_spins(structure));
  return fmt::format("{} - {}{}", names[static_cast<std::size_t>(t.upper)],
                     names[static_cast<std::size_t>(t.lower)], t.photons == 2 ? " by two photons" : "");
}

std::string left_out(double neglected) {
  return neglected < 1 ? fmt::format("amplitudes up to {:.2g} are left out, and may add up", neglected)
                       : "what it leaves out is too strong for that";
}

std::string tesla(double b) { return pretty_quantity(b, Dimension::magnetic_field); }

}  // namespace rabiline
