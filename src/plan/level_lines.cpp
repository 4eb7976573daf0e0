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

std::vector<Transition> transitions_near(const Structure& structure, const LevelZone& zone) {
  const CoupledSpins spins = coupled_spins(structure);
  const RotatingTerm& drive = *zone.drive;
  const Levels levels = levels_at(spins, zone.field);
  const DrivenStates states = driven_states(spins, levels, drive);
  const bool swings = sense_of(drive) == 0;
  const DrivenStates* const alone[] = {&states};
  const Eigen::VectorXd shifts =  // by what does not stand still in the field's frame
      standing_coupling(rotating_frame(levels.labels, drive, alone), states).second.diagonal();
  const double negligible = 1e-14 * states.energy.cwiseAbs().maxCoeff();
  std::vector<Transition> out;
  for (int i = 0; i < spins.levels(); ++i)
    for (int k = 0; k < spins.levels(); ++k) {
      double apart = states.energy(i) - states.energy(k);
      if (std::abs(apart) < negligible) apart = 0;
      const auto upper = static_cast<std::size_t>(i), lower = static_cast<std::size_t>(k);
      const bool turns =
          swings || levels.labels[upper].twice_m - levels.labels[lower].twice_m == 2 * sense_of(drive);
      if (i == k || apart < 0 || (apart == 0 && swings && i > k) || states.coupling(i, k) == 0 || !turns)
        continue;
      out.push_back({i, k, apart, drive.oscillator.frequency - apart,
                     (swings ? 1 : 2) * std::abs(states.coupling(i, k)), shifts(i) - shifts(k)});
    }
  std::stable_sort(out.begin(), out.end(), [](const Transition& a, const Transition& b) {
    return std::abs(a.detuning) < std::abs(b.detuning);
  });
  return out;
}

std::vector<Transition> transitions_of_two_photons(const Structure& structure, const LevelZone& zone,
                                                   double width) {
  const CoupledSpins spins = coupled_spins(structure);
  const Levels levels = levels_at(spins, zone.field);
  const DrivenStates states = driven_states(spins, levels, *zone.drive);
  const int sense = sense_of(*zone.drive);
  const double frequency = zone.drive->oscillator.frequency;
  Eigen::MatrixXd up = (sense == 0 ? 0.5 : 1) * states.coupling;
  for (int to = 0; sense != 0 && to < spins.levels(); ++to)
    for (int from = 0; from < spins.levels(); ++from)
      if (levels.labels[static_cast<std::size_t>(to)].twice_m -
              levels.labels[static_cast<std::size_t>(from)].twice_m !=
          2 * sense)
        up(to, from) = 0;
  const auto shifted = [&](int i) {
    double sum = 0;
    for (int k = 0; k < spins.levels(); ++k) {
      const double apart = states.energy(i) - states.energy(k);
      if (k != i)
        sum += up(k, i) * up(k, i) / (apart + frequency) + up(i, k) * up(i, k) / (apart - frequency);
    }
    return sum;
  };
  std::vector<Transition> out;
  for (const CoupledPair& pair : pairs_of_two_photons(states.energy, std::span(&up, 1), frequency)) {
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
    if (!is_by_one && rabi > 0.01 * width && std::abs(detuning) <= 100 * (width + rabi))
      out.push_back(
          {pair.upper, pair.lower, apart, detuning, rabi, shifted(pair.upper) - shifted(pair.lower), 2});
  }
  std::ranges::stable_sort(out, {}, [](const Transition& t) { return std::abs(t.detuning); });
  return out;
}

bool is_pulsed(const LevelZone& zone) { return zone.drive->gate != Gate{}; }

double width_of(const LevelZone& zone, double length, double speed) {
  const double passing = speed / length;
  const Gate& gate = zone.drive->gate;
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
  return neglected < 1 ? fmt::format("amplitudes up to {:.2g} are left out", neglected)
                       : "what it leaves out is too strong for that";
}

std::string tesla(double b) { return pretty_quantity(b, Dimension::magnetic_field); }

}  // namespace rabiline
