// How particles start, as the emitting kernel sees it.
#include <algorithm>
#include <cmath>

#include "particle/law_tables.hpp"
#include "plan/geometry.hpp"
#include "plan/plan.hpp"
#include "plan/stretches.hpp"
#include "spin/levels.hpp"

namespace rabiline {
namespace {

const PlacedPart* find_part(const Beamline& beamline, const std::string& name) {
  for (const PlacedPart& part : beamline.parts)
    if (part.placement.name == name) return &part;
  return nullptr;
}

/// The opening that an aimed source is aimed at: a slit's hole or a detector's face.
Aperture target_of(const Beamline& beamline, const std::string& name) {
  const PlacedPart& target = *find_part(beamline, name);
  const Across across = across_of(target.part).value();
  return aperture_of(target.placement.at, across.opening, across.offset, across.tilt);
}

/// Fills the Emission of one species; each group of overloads one thing that is drawn.
class Emitter {
 public:
  Emitter(const Beamline& beamline, const Species& species, LawTables& tables, Emission& e)
      : beamline_(beamline),
        species_(species),
        tables_(tables),
        quantum_(law_traits(beamline.law).has_levels),
        e_(e) {}

  void fill() {
    const Source& source = beamline_.source;
    e_.speed = std::visit([&](const auto& law) { return law.draw(species_.mass, tables_); }, source.speed);
    std::visit([&](const auto& hole) { place(hole, source.offset); }, source.opening);
    e_.direction = std::visit([&](const auto& law) { return law.draw(tables_); }, source.direction);
    if (const auto* aimed = std::get_if<AimedDirection>(&source.direction))
      e_.target = target_of(beamline_, aimed->target);
    tilt(source.tilt);
    if (quantum_) e_.spin.levels = species_.levels();
    std::visit([&](const auto& spin) { polarise(spin); }, source.spin);
    e_.pulse = draw_of(source.pulse);
    if (const auto& gravity = beamline_.gravity)
      e_.fall = {gravity->acceleration * gravity->direction.x, gravity->acceleration * gravity->direction.z};
  }

 private:
  // ---- places ----

  void place(const GaussianSpot& spot, const Offset& offset) {
    e_.gaussian_spot = true;
    e_.spot_x = spot.sigma_x;
    e_.spot_z = spot.sigma_z;
    e_.opening.x0 = offset.x;
    e_.opening.z0 = offset.z;
  }
  template <class Hole>
  void place(const Hole& hole, const Offset& offset) {
    e_.opening = aperture_of(0, hole, offset);
  }

  void tilt(const SourceTilt& tilt) {
    if (tilt.x == 0 && tilt.z == 0) return;
    e_.tilted = true;
    e_.tilt_cos_x = portable::cos(tilt.x);
    e_.tilt_sin_x = portable::sin(tilt.x);
    e_.tilt_cos_z = portable::cos(tilt.z);
    e_.tilt_sin_z = portable::sin(tilt.z);
  }

  // ---- spins ----

  void polarise(const UnpolarisedSpin&) {}
  void polarise(const PolarisedSpin& spin) {
    std::vector<double> shares(static_cast<std::size_t>(species_.spin.twice) + 1, 0.0);
    shares.front() = (1 + spin.degree) / 2;
    shares.back() = 1 - shares.front();
    populate(spin.axis, shares);
  }
  void polarise(const PopulatedSpin& spin) { populate(spin.axis, spin.values); }
  void polarise(const ThermalSpin& spin) {
    const CoupledSpins spins = coupled_spins(species_.structure.value());
    populate({}, thermal_populations(levels_at(spins, spin.field), spin.temperature));
  }
  void polarise(const LevelsSpin& spin) {
    const std::vector<LevelLabel> labels = level_labels(coupled_spins(species_.structure.value()));
    std::vector<double> shares(labels.size(), 0.0);
    for (std::size_t i = 0; i < spin.levels.size(); ++i)
      shares[static_cast<std::size_t>(find_level(labels, spin.levels[i]).value())] +=
          spin.shares ? (*spin.shares)[i] : 1 / static_cast<double>(spin.levels.size());
    populate({}, shares);
  }
  /// `shares`: of the levels along the axis, m = I first.
  void populate(UnitVector axis, std::vector<double> shares) {
    e_.spin.kind = quantum_ ? SpinKind::levels : SpinKind::along_axis;
    if (quantum_ && is_downwards(axis)) {
      axis = upwards(axis);
      std::ranges::reverse(shares);
    }
    e_.spin.axis[0] = axis.x;
    e_.spin.axis[1] = axis.y;
    e_.spin.axis[2] = axis.z;
    e_.spin.steps = static_cast<int>(shares.size());
    double sum = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      sum += shares[i];
      e_.spin.cumulative[i] = sum;
      // m/I of m = I - i.
      if (!quantum_) e_.spin.along[i] = 1 - 2 * static_cast<double>(i) / species_.spin.twice;
    }
    e_.spin.cumulative[shares.size() - 1] = 1;
  }

  const Beamline& beamline_;
  const Species& species_;
  LawTables& tables_;
  const bool quantum_;
  Emission& e_;
};

}  // namespace

Emission emission_of(const Beamline& beamline, const Component& component, RandomKey key,
                     SampledTables& tables) {
  Emission e;
  e.key = key;
  e.watches_turning = asks_for_adiabaticity(beamline);
  Emitter(beamline, component.species, tables.laws, e).fill();
  return e;
}

double aimed_fraction(const Beamline& beamline, Transmissions& known) {
  const auto* aimed = std::get_if<AimedDirection>(&beamline.source.direction);
  if (aimed == nullptr) return 1;
  const Aperture target = target_of(beamline, aimed->target);
  const double density =
      std::visit([&](const auto& law) { return law.density_on_axis(known); }, aimed->emission);
  return density * area_of(target) / (target.y * target.y);
}

}  // namespace rabiline
