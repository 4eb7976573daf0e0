#include "transport/level_way.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <complex>
#include <cstdlib>
#include <numbers>
#include <optional>
#include <span>

#include "core/portable_math.hpp"
#include "core/units.hpp"
#include "core/vector3.hpp"
#include "transport/cost.hpp"

namespace rabiline {

namespace {

/// A drive of half whose fields exp(-i omega t) belongs to a rate omega > 0.
DriveTerm against(DriveTerm drive, double omega) {
  if (drive.omega < 0) {
    for (double& component : drive.second) component = -component;
    for (double* number : {&drive.omega, &drive.phase, &drive.random_turn, &drive.twist, &drive.sweep.rate,
                           &drive.slopes.phase_x, &drive.slopes.phase_z})
      *number = -*number;
  }
  drive.omega -= omega;
  return drive;
}

int place_of(const LevelManifold& all, int level) {
  return static_cast<int>(std::find(all.number, all.number + all.levels, level) - all.number);
}

/// What couples `one` to another level as it takes up a photon, or gives one off; places in the manifold.
std::optional<PhotonLeg> leg_between(const LevelManifold& all, int one, int other, int taken_up) {
  const int side = taken_up > 0 ? 0 : 1;
  if (one == other) return PhotonLeg{all.pairs + one, side};
  for (int p = 0; p < all.pairs; ++p) {
    if (all.low[p] == one && all.high[p] == other) return PhotonLeg{p, side};
    if (all.low[p] == other && all.high[p] == one) return PhotonLeg{p, 1 - side, true};
  }
  return std::nullopt;
}

/// By way of all levels but those that stand still between the two.
std::vector<TwoPhotonPath> paths_of(const TwoPhotons& pair, int coupling, const LevelManifold& all,
                                    const WaveFrame& frame) {
  const int upper = place_of(all, pair.upper), lower = place_of(all, pair.lower);
  std::vector<TwoPhotonPath> out;
  for (const int last : {-1, 1})
    for (int by = 0; by < all.levels; ++by) {
      const int first = pair.ahead - last;
      if (std::abs(first) != 1 || frame.stand_still(pair.upper, all.number[by], last)) continue;
      const auto to = leg_between(all, upper, by, last), from = leg_between(all, by, lower, first);
      if (to && from) out.push_back({coupling, by, *to, *from, 1.0 * last, 1.0 * first});
    }
  return out;
}

/// The fields of a section that has a period, and the axes of its levels.
PeriodicField periodic_field(const SpinZone& zone, LevelPeriodForm& axes) {
  const Vector3 uniform = zone.spin_rate * (zone.turned ? Vector3{zone.frame[6], zone.frame[7], zone.frame[8]}
                                                        : Vector3{0, 0, 1});
  PeriodicField out{length_of(uniform), zone.drive[0].omega};
  const Vector3 third = out.field > 0 ? (1 / out.field) * uniform : Vector3{0, 0, 1},
                first = some_normal(third), axis[3] = {first, cross(third, first), third};
  for (int i = 0; i < 3; ++i) {
    axes.third[i] = (&third.x)[i];
    axes.first[i] = (&first.x)[i];
  }
  for (const DriveTerm& drive : std::span(zone.drive, static_cast<std::size_t>(zone.drives))) {
    const double ahead = drive.phase - zone.drive[0].phase;
    const std::complex<double> phase(portable::cos(ahead), portable::sin(ahead));
    for (std::size_t i = 0; i < 3; ++i) {
      const auto along = [&](const double* v) { return dot(axis[i], {v[0], v[1], v[2]}); };
      out.c[i] += drive.spin_rate * phase * std::complex<double>(along(drive.first), -along(drive.second));
    }
  }
  return out;
}

}  // namespace

LevelWave LevelWay::Wave::view() const {
  LevelWave out;
  out.drives = static_cast<int>(drives.size());
  out.drive = drives.data();
  out.standing.levels = static_cast<int>(rate.size());
  out.standing.couplings = static_cast<int>(to.size());
  out.standing.to = to.data();
  out.standing.from = from.data();
  for (int k = 0; k < out.standing.levels; ++k)
    out.standing.most_of_one = std::max(
        out.standing.most_of_one, static_cast<int>(std::ranges::count(to, k) + std::ranges::count(from, k)));
  out.of_first = static_cast<int>(photons.size());
  out.photons = photons.data();
  out.number = number.data();
  out.moves = static_cast<int>(move.size());
  out.move = move.data();
  out.left_out = left_out.data();
  out.rate = rate.data();
  out.paths = static_cast<int>(paths.size());
  out.path = paths.data();
  return out;
}

LevelWay::LevelWay(LevelFields fields, std::shared_ptr<const LevelTable> table)
    : fields_(std::move(fields)), table_(std::move(table)) {
  for (const WaveFields& fields_there : fields_.waves) {
    const LevelManifold& all = table_->manifolds().front();
    const WaveFrame& frame = fields_there.frame;
    const double omega = 2 * std::numbers::pi * fields_there.frequency;
    Wave wave;
    for (const DriveTerm& drive : fields_there.drives) wave.drives.push_back(against(drive, omega));
    const auto ahead = [&](int to, int from) -> std::optional<int> {
      const auto a = static_cast<std::size_t>(all.number[to]), b = static_cast<std::size_t>(all.number[from]);
      return frame.set[a] == frame.set[b] ? std::optional(frame.photons[a] - frame.photons[b]) : std::nullopt;
    };
    const auto couple = [&](int to, int from, int photons, int number) {
      wave.to.push_back(to);
      wave.from.push_back(from);
      wave.photons.push_back(photons);
      wave.number.push_back(number);
    };
    for (int j = 0; j < all.couplings; ++j) {
      if (ahead(all.to[j], all.from[j]) == 0)
        couple(all.to[j], all.from[j], 0, j);
      else
        wave.move.push_back(j);
    }
    for (int p = 0; p < all.pairs; ++p) {
      const std::optional<int> photons = ahead(all.low[p], all.high[p]);
      wave.left_out.push_back(photons == 1 ? 2 : photons == -1 ? 1 : 3);
      if (wave.left_out.back() != 3) couple(all.low[p], all.high[p], *photons, p);
    }
    for (const TwoPhotons& pair : frame.two) {
      const auto paths = paths_of(pair, static_cast<int>(wave.to.size()), all, frame);
      if (paths.empty() || wave.to.size() == most_couplings) continue;
      wave.to.push_back(place_of(all, pair.upper));
      wave.from.push_back(place_of(all, pair.lower));
      wave.paths.insert(wave.paths.end(), paths.begin(), paths.end());
    }
    for (int k = 0; k < all.levels; ++k)
      wave.rate.push_back(frame.rate[static_cast<std::size_t>(all.number[k])]);
    waves_.push_back(std::move(wave));
    wave_views_.push_back(waves_.back().view());
    wave_views_.back().omega = omega;
  }
  work_out_periods();
  course_.manifolds = table_->manifolds().data();
  course_.manifold_of = table_->manifold_of().data();
  course_.place_of = table_->place_of().data();
  course_.sections = fields_.sections.data();
  course_.count = static_cast<int>(fields_.sections.size());
  course_.shaped = fields_.shaped.data();
  course_.waves = wave_views_.data();
  course_.periods = period_views_.data();
  course_.begins_in_field = fields_.begins_in_field;
  course_.ends_in_field = fields_.ends_in_field;
  course_.behind = fields_.behind;
  course_.tolerance = 0.1 * fields_.tolerance;  // errors of steps add up
}

/// Zones that are alike have the same one.
void LevelWay::work_out_periods() {
  std::vector<PeriodicField> known;
  std::vector<std::size_t> number;
  for (const CourseSection& section : fields_.sections) {
    if (section.period < 0) continue;
    const PeriodicField field = periodic_field(section.field, period_views_.emplace_back());
    const auto same = std::ranges::find_if(known, [&](const PeriodicField& other) {
      return other.field == field.field && other.omega == field.omega && other.c == field.c;
    });
    number.push_back(static_cast<std::size_t>(same - known.begin()));
    if (same != known.end()) continue;
    known.push_back(field);
    periods_.emplace_back(table_->manifolds().front(), field);
  }
  for (std::size_t i = 0; i < number.size(); ++i) {
    const LevelPeriod& period = periods_[number[i]];
    LevelPeriodForm& form = period_views_[i];
    form.first_harmonic = period.first();
    form.harmonics = static_cast<int>(period.ends().size());
    form.end = period.ends().data();
    form.term = period.terms().data();
    form.photons = period.photons().data();
    form.rate = period.rate().data();
    form.quasi = period.quasi().data();
  }
}

std::uint64_t LevelWay::reachable_from(int level) const {
  const std::vector<int>& manifold = table_->manifold_of();
  std::uint64_t bits = 0;
  for (std::size_t to = 0; to < manifold.size(); ++to)
    if (manifold[to] == manifold[static_cast<std::size_t>(level)]) bits |= std::uint64_t{1} << to;
  return bits;
}

double LevelWay::cost() const {
  constexpr double steps = 100;  // in a field that turns
  double sum = 0;
  for (const LevelManifold& manifold : table_->manifolds())
    sum += static_cast<double>(manifold.levels * manifold.levels) /
           static_cast<double>(table_->manifold_of().size());
  return static_cast<double>(fields_.sections.size()) * steps *
         (8 * cost::shaped_field * static_cast<double>(fields_.shaped.size()) +
          60 * cost::operation * 40 * sum);
}

std::string describe(const LevelWay& way) {
  const LevelFields& fields = way.fields();
  std::string waves;
  double neglected = 0;
  std::vector<double> told;
  for (const WaveFields& wave : fields.waves) {
    neglected = std::max(neglected, wave.frame.neglected);
    if (std::ranges::find(told, wave.frequency) != told.end()) continue;
    told.push_back(wave.frequency);
    waves += fmt::format("{}{}", waves.empty() ? "" : " and ",
                         pretty_quantity(wave.frequency, Dimension::frequency));
  }
  if (!waves.empty())
    waves = fmt::format(
        "; {} in the rotating-wave approximation, whose rest shifts levels and would have amplitudes "
        "up to {:.2g}",
        waves, neglected);
  const bool has_periods =
      std::ranges::any_of(fields.sections, [](const CourseSection& s) { return s.period >= 0; });
  std::string_view along_z;
  if (fields.begins_too_weak)
    along_z = fields.ends_too_weak ? "where it begins and where it ends" : "where it begins";
  else if (fields.ends_too_weak)
    along_z = "where it ends";
  return fmt::format(
      "coherent through {}fields of any direction from {:.4g} to {:.4g} m, by their amplitudes in "
      "steps to {:.2g}{}{}{}{}",
      waves.empty() ? "whole " : "", fields.sections.front().field.begin, fields.sections.back().field.end,
      fields.tolerance, has_periods ? ", and by the modes of one period where what drives has one" : "",
      way.table().are_parted() ? "; F far apart exchange nothing" : "", waves,
      along_z.empty()
          ? ""
          : fmt::format("; {} the field is too weak to turn spins, and levels are those along z", along_z));
}

}  // namespace rabiline
