// How particles start, as the emitting kernel sees it.
#include <cmath>
#include <numbers>

#include "core/constants.hpp"
#include "core/portable_math.hpp"
#include "plan/geometry.hpp"
#include "plan/plan.hpp"
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
  if (const auto* slit = std::get_if<Slit>(&target.part))
    return aperture_of(target.placement.at, slit->opening, slit->offset, slit->tilt);
  const auto& detector = std::get<Detector>(target.part);
  return aperture_of(target.placement.at, opening_of(detector.face), detector.offset, detector.tilt);
}

/// Fills the Emission of one species; each group of overloads one thing that is drawn.
class Emitter {
 public:
  Emitter(const Beamline& beamline, const Species& species, SampledTables& tables, Emission& e)
      : beamline_(beamline),
        species_(species),
        tables_(tables),
        quantum_(std::holds_alternative<QuantumLaw>(beamline.law)),
        e_(e) {}

  void fill() {
    const Source& source = beamline_.source;
    e_.speed = mean_speed(source.speed, species_.mass);
    std::visit([&](const auto& law) { speeds(law); }, source.speed);
    std::visit([&](const auto& hole) { place(hole, source.offset); }, source.opening);
    std::visit([&](const auto& law) { direct(law); }, source.direction);
    tilt(source.tilt);
    if (quantum_) e_.levels = species_.levels();
    std::visit([&](const auto& spin) { polarise(spin); }, source.spin);
    if (source.pulse) std::visit([&](const auto& pulse) { time(pulse); }, *source.pulse);
  }

 private:
  // ---- speeds ----

  void speeds(const SingleSpeed&) {}
  void speeds(const GaussianSpeed& law) {
    if (law.mean.dimension == Dimension::speed) {
      e_.speed_kind = SpeedKind::gaussian;
      e_.speed_sigma = law.sigma.value;
      return;
    }
    e_.speed_kind = SpeedKind::converted_gaussian;
    e_.normal_mean = law.mean.value;
    e_.normal_sigma = law.sigma.value;
    scale(law.mean.dimension);
    // Waves so short that the program without relativity ends are drawn again, like those below zero.
    if (e_.speed_scale == SpeedScale::inverse) e_.normal_least = e_.speed_factor / fastest_speed;
  }
  void speeds(const EffusiveSpeed& law) {
    e_.speed_kind = SpeedKind::effusive;
    e_.speed_factor = thermal_speed(law.temperature, species_.mass);
  }
  void speeds(const MaxwellSpeed& law) {
    e_.speed_kind = SpeedKind::maxwell;
    e_.speed_factor = thermal_speed(law.temperature, species_.mass);
  }
  void speeds(const SupersonicSpeed& law) {
    e_.speed_kind = SpeedKind::sampled;
    e_.speed_law = tables_.supersonic(law.speed_ratio).law();
    e_.speed_factor = terminal_speed(law, species_.mass);
  }
  void speeds(const TabulatedSpeed& law) {
    e_.speed_kind = SpeedKind::sampled;
    e_.speed_law = tables_.spectrum(law.file.spectrum).law();
    scale(law.file.spectrum->dimension);
  }
  void speeds(const LineSpeeds& law) {
    std::vector<double> values, weights;
    for (const SpeedLine& line : law.lines) {
      values.push_back(speed_of(line.value, species_.mass));
      weights.push_back(line.weight);
    }
    e_.speed_kind = SpeedKind::sampled;
    e_.speed_law = tables_.lines(values, weights).law();
  }
  /// v = h/(m lambda), v = sqrt(2E/m).
  void scale(Dimension d) {
    if (d == Dimension::length) {
      e_.speed_scale = SpeedScale::inverse;
      e_.speed_factor = constants::planck / species_.mass;
    } else if (d == Dimension::energy) {
      e_.speed_scale = SpeedScale::root;
      e_.speed_factor = 2 / species_.mass;
    }
  }

  // ---- places and directions ----

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

  void direct(const ParallelDirection&) {}
  void direct(const GaussianDirection& law) { slopes(DirectionKind::gaussian, law.x, law.z); }
  void direct(const BoxDirection& law) { slopes(DirectionKind::box, law.x, law.z); }
  void direct(const ConeDirection& law) {
    const double half = portable::sin(law.half_angle / 2);
    slopes(DirectionKind::cone, 2 * half * half, 0);
  }
  void direct(const CosineDirection& law) {
    const double sine = portable::sin(law.half_angle);
    slopes(DirectionKind::cosine, sine * sine, 0);
  }
  void direct(const ChannelDirection& law) {
    e_.direction = DirectionKind::channel;
    e_.angle_law = tables_.channel(law.length / law.radius).angles.law();
  }
  void direct(const AimedDirection& law) {
    e_.direction = DirectionKind::aimed;
    e_.target = target_of(beamline_, law.target);
    if (std::holds_alternative<CosineEmission>(law.emission)) e_.aimed_law = AimedLaw::cosine;
    if (const auto* channel = std::get_if<ChannelDirection>(&law.emission)) {
      e_.aimed_law = AimedLaw::channel;
      e_.channel_shape = tables_.channel(channel->length / channel->radius).shape();
    }
  }
  void slopes(DirectionKind kind, double x, double z) {
    e_.direction = kind;
    e_.spread_x = x;
    e_.spread_z = z;
  }
  void tilt(const SourceTilt& tilt) {
    if (tilt.x == 0 && tilt.z == 0) return;
    e_.tilted = true;
    e_.tilt_cos_x = portable::cos(tilt.x);
    e_.tilt_sin_x = portable::sin(tilt.x);
    e_.tilt_cos_z = portable::cos(tilt.z);
    e_.tilt_sin_z = portable::sin(tilt.z);
  }

  // ---- spins and times ----

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
  void populate(const UnitVector& axis, const std::vector<double>& shares) {
    e_.spin_kind = quantum_ ? SpinKind::levels : SpinKind::along_axis;
    e_.axis_x = axis.x;
    e_.axis_y = axis.y;
    e_.axis_z = axis.z;
    e_.spin_steps = static_cast<int>(shares.size());
    double sum = 0;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      sum += shares[i];
      e_.spin_cumulative[i] = sum;
      // m/I of m = I - i.
      if (!quantum_) e_.spin_along[i] = 1 - 2 * static_cast<double>(i) / species_.spin.twice;
    }
    e_.spin_cumulative[shares.size() - 1] = 1;
  }

  void time(const RectanglePulse& pulse) {
    e_.pulse = PulseKind::rectangle;
    e_.pulse_width = pulse.length;
  }
  void time(const GaussianPulse& pulse) {
    e_.pulse = PulseKind::gaussian;
    e_.pulse_width = pulse.sigma;
  }

  const Beamline& beamline_;
  const Species& species_;
  SampledTables& tables_;
  const bool quantum_;
  Emission& e_;
};

/// Density per solid angle [1/sr] on the axis, of all that leaves the source into the forward hemisphere.
double density_on_axis(const IsotropicEmission&, Transmissions&) { return 1 / (2 * std::numbers::pi); }
double density_on_axis(const CosineEmission&, Transmissions&) { return 1 / std::numbers::pi; }
/// j = 1 there, and W of what enters the channel leaves it: Clausing 1932.
double density_on_axis(const ChannelDirection& law, Transmissions& known) {
  const double length = law.length / law.radius;
  auto found = known.find(length);
  if (found == known.end()) found = known.emplace(length, ChannelFlow(length).transmission()).first;
  return 1 / (std::numbers::pi * found->second);
}

}  // namespace

Emission emission_of(const Beamline& beamline, const Component& component, RandomKey key,
                     SampledTables& tables) {
  Emission e;
  e.key = key;
  Emitter(beamline, component.species, tables, e).fill();
  return e;
}

double aimed_fraction(const Beamline& beamline, Transmissions& known) {
  const auto* aimed = std::get_if<AimedDirection>(&beamline.source.direction);
  if (aimed == nullptr) return 1;
  const Aperture target = target_of(beamline, aimed->target);
  const double density =
      std::visit([&](const auto& law) { return density_on_axis(law, known); }, aimed->emission);
  return density * area_of(target) / (target.y * target.y);
}

}  // namespace rabiline
