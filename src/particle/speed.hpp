#pragma once
// How fast particles start. A speed may be written as itself, as a wavelength or as an energy.
#include <concepts>
#include <memory>
#include <string>
#include <variant>
#include <vector>

#include "core/constants.hpp"
#include "parameter/parameter.hpp"
#include "particle/draw.hpp"

namespace rabiline {

/// A speed as it was written: [m/s] itself, [m] the de Broglie wavelength h/(m v) or [J] the kinetic energy
/// m v^2/2. Which speed that is depends on the species.
struct SpeedQuantity {
  double value = 0;  // [SI of `dimension`]
  Dimension dimension = Dimension::speed;
  SpeedQuantity() = default;
  SpeedQuantity(double metres_per_second) : value(metres_per_second) {}
  SpeedQuantity(double quantity, Dimension d) : value(quantity), dimension(d) {}
  bool operator==(const SpeedQuantity&) const = default;
};

/// Where a program without relativity ends [m/s]: 0.05 c, where its energies are off by 0.2 %.
inline constexpr double fastest_speed = 0.05 * constants::speed_of_light;

class LawTables;

struct SpeedRange {
  double slowest = 0, fastest = 0;  // [m/s]
};
/// A speed that a file states, or a mean that follows from what it states: nothing may fly too fast.
struct StatedSpeed {
  std::string key;  // of the law's mapping: "value", "lines[0].value"
  SpeedQuantity value;
  bool is_mean = false;  // of a thermal distribution
};

/// What the program asks of a distribution of speeds, for particles of a mass [kg]. The kernel that draws
/// from it is transport/emission_kernels.cpp; most distributions are a table there.
template <class L>
concept SpeedDistribution = requires(const L& law, double mass, LawTables& tables) {
  // The word for it in a file, and the line of help that explains it.
  { L::kind } -> std::convertible_to<std::string_view>;
  { L::meaning } -> std::convertible_to<std::string_view>;
  // [m/s] What steps, costs and derived numbers are calculated with.
  { law.mean_speed(mass) } -> std::same_as<double>;
  // All but 1e-4 of the particles: what tables of transitions cover.
  { law.speed_range(mass) } -> std::same_as<SpeedRange>;
  // What kernels draw with; tables that they read are made in, and belong to, `tables`.
  { law.draw(mass, tables) } -> std::same_as<SpeedDraw>;
  // What a rule compares with the fastest speed.
  { law.stated_speeds(mass) } -> std::same_as<std::vector<StatedSpeed>>;
};

struct SingleSpeed {
  static constexpr std::string_view kind = "single", meaning = "every particle has the same speed";
  SpeedQuantity value;
  bool operator==(const SingleSpeed&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<SingleSpeed>);
template <>
inline constexpr auto parameters<SingleSpeed> = std::tuple{
    param("value", &SingleSpeed::value, Dimension::speed, range::positive,
          "the speed, or its wavelength or energy"),
};

/// A normal law cut at zero: what is not positive is drawn again. In m/s its mean is taken as if it were not
/// cut.
struct GaussianSpeed {
  static constexpr std::string_view kind = "gaussian",
                                    meaning =
                                        "normal, cut at zero, in the quantity that `mean` is written in";
  SpeedQuantity mean;
  SpeedQuantity sigma;  // standard deviation, of the same kind as the mean
  bool operator==(const GaussianSpeed&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<GaussianSpeed>);
template <>
inline constexpr auto parameters<GaussianSpeed> = std::tuple{
    param("mean", &GaussianSpeed::mean, Dimension::speed, range::positive,
          "mean speed, wavelength or energy"),
    param("sigma", &GaussianSpeed::sigma, Dimension::speed, range::not_negative,
          "standard deviation, of the same kind"),
};

/// What leaves a thin hole of an oven: flux f ~ v^3 exp(-v^2/alpha^2), alpha = sqrt(2kT/m).
struct EffusiveSpeed {
  static constexpr std::string_view kind = "effusive",
                                    meaning = "what leaves a hole of an oven: flux ~ v^3 exp(-m v^2/2kT)";
  double temperature = 0;  // [K]
  bool operator==(const EffusiveSpeed&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<EffusiveSpeed>);
template <>
inline constexpr auto parameters<EffusiveSpeed> = std::tuple{
    param("temperature", &EffusiveSpeed::temperature, Dimension::temperature, range::positive,
          "temperature of the oven"),
};

/// Speeds in a box: density f ~ v^2 exp(-v^2/alpha^2).
struct MaxwellSpeed {
  static constexpr std::string_view kind = "maxwell",
                                    meaning = "speeds of a gas in a box: density ~ v^2 exp(-m v^2/2kT)";
  double temperature = 0;  // [K]
  bool operator==(const MaxwellSpeed&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<MaxwellSpeed>);
template <>
inline constexpr auto parameters<MaxwellSpeed> = std::tuple{
    param("temperature", &MaxwellSpeed::temperature, Dimension::temperature, range::positive,
          "temperature of the gas"),
};

/// A nozzle beam: flux f ~ v^3 exp(-S^2 (v/u - 1)^2), u = sqrt(2g/(g-1) kT0/m).
struct SupersonicSpeed {
  static constexpr std::string_view kind = "supersonic",
                                    meaning = "a nozzle beam: flux ~ v^3 exp(-S^2 (v/u - 1)^2)";
  double temperature = 0;         // [K] T0
  double adiabatic_exponent = 0;  // g
  double speed_ratio = 0;         // S
  bool operator==(const SupersonicSpeed&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<SupersonicSpeed>);
template <>
inline constexpr auto parameters<SupersonicSpeed> = std::tuple{
    param("temperature", &SupersonicSpeed::temperature, Dimension::temperature, range::positive,
          "temperature T0 of the gas before the nozzle"),
    param("adiabatic_exponent", &SupersonicSpeed::adiabatic_exponent, Dimension::number,
          Range{1, 3, false, true, "greater than 1 and at most 3"},
          "g in u = sqrt(2g/(g-1) kT0/m); 5/3 = 1.66667 for a gas of atoms"),
    param("speed_ratio", &SupersonicSpeed::speed_ratio, Dimension::number,
          Range{1, 1000, true, true, "from 1 to 1000"}, "S, the speed u of the flow over the thermal one"),
};

/// The same number of particles in equal intervals, as what a velocity selector lets through is taken for.
struct UniformSpeed {
  static constexpr std::string_view
      kind = "uniform",
      meaning = "spread evenly between two limits, in the quantity that `mean` is written in",
      example = "mean: 4.5 angstrom, spread: 0.1";
  SpeedQuantity mean;
  double spread = 0;  // half the width over the mean
  bool operator==(const UniformSpeed&) const = default;

  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<UniformSpeed>);
template <>
inline constexpr auto parameters<UniformSpeed> = std::tuple{
    param("mean", &UniformSpeed::mean, Dimension::speed, range::positive, "mean speed, wavelength or energy"),
    param("spread", &UniformSpeed::spread, Dimension::number,
          Range{0, 1, false, false, "greater than 0 and less than 1"},
          "half the width over the mean: from mean (1 - spread) to mean (1 + spread)"),
};

/// A measured spectrum: flux per unit of the quantity, linear between rows.
struct Spectrum {
  std::string path;
  Dimension dimension = Dimension::speed;  // what `at` is
  std::vector<double> at;                  // [SI] rising, positive
  std::vector<double> flux;                // any unit, not negative, not all zero
  bool operator==(const Spectrum&) const = default;
};
struct SpectrumFile {
  std::shared_ptr<const Spectrum> spectrum;
  bool operator==(const SpectrumFile& o) const {
    return spectrum == o.spectrum || (spectrum && o.spectrum && *spectrum == *o.spectrum);
  }
};
struct TabulatedSpeed {
  static constexpr std::string_view kind = "tabulated",
                                    meaning = "a spectrum from a CSV file, linear between its rows";
  SpectrumFile file;
  bool operator==(const TabulatedSpeed&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<TabulatedSpeed>);
template <>
inline constexpr auto parameters<TabulatedSpeed> = std::tuple{
    param("file", &TabulatedSpeed::file,
          "path from this file; first line `speed [m/s],flux`, `wavelength [angstrom],flux` or "
          "`energy [meV],flux`, flux per unit of that quantity; # begins a comment"),
};

struct SpeedLine {
  SpeedQuantity value;
  double weight = 0;
  bool operator==(const SpeedLine&) const = default;
};
template <>
inline constexpr auto parameters<SpeedLine> = std::tuple{
    param("value", &SpeedLine::value, Dimension::speed, range::positive,
          "the speed, or its wavelength or energy"),
    param("weight", &SpeedLine::weight, Dimension::number, range::positive,
          "share of the particles, relative to the other lines"),
};
struct LineSpeeds {
  static constexpr std::string_view kind = "lines", meaning = "a few sharp speeds, each with its weight";
  std::vector<SpeedLine> lines;
  bool operator==(const LineSpeeds&) const = default;
  double mean_speed(double mass) const;
  SpeedRange speed_range(double mass) const;
  SpeedDraw draw(double mass, LawTables&) const;
  std::vector<StatedSpeed> stated_speeds(double mass) const;
};
static_assert(SpeedDistribution<LineSpeeds>);
template <>
inline constexpr auto parameters<LineSpeeds> = std::tuple{
    param("lines", &LineSpeeds::lines, "the speeds and their weights"),
};

using SpeedLaw = std::variant<SingleSpeed, GaussianSpeed, EffusiveSpeed, MaxwellSpeed, SupersonicSpeed,
                              UniformSpeed, TabulatedSpeed, LineSpeeds>;

/// The speed [m/s] of a particle of that mass [kg]: v = h/(m lambda), v = sqrt(2E/m).
double speed_of(const SpeedQuantity&, double mass);
/// Most probable speed in a box, alpha = sqrt(2kT/m) [m/s].
double thermal_speed(double temperature, double mass);
/// The speed that all heat of a nozzle's gas would give, u = sqrt(2g/(g-1) kT0/m) [m/s].
double terminal_speed(const SupersonicSpeed&, double mass);
double mean_speed(const SpeedLaw&, double mass);
SpeedRange speed_range(const SpeedLaw&, double mass);

}  // namespace rabiline
