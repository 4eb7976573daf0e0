#include "input/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "core/diagnostics.hpp"
#include "core/text.hpp"

namespace rabiline {
namespace {

/// What people call things, and which words may be meant: those that a key has, with blanks between.
struct Meaning {
  std::string_view said, meant;
};
constexpr std::array meanings{
    Meaning{"analyser", "spin_filter"},
    Meaning{"analyzer", "spin_filter"},
    Meaning{"filter", "spin_filter velocity_selector"},
    Meaning{"field", "uniform_field"},
    Meaning{"b_field", "uniform_field"},
    Meaning{"static_field", "uniform_field"},
    Meaning{"constant_field", "uniform_field"},
    Meaning{"homogeneous_field", "uniform_field"},
    Meaning{"holding_field", "uniform_field guide_field"},
    Meaning{"rf", "rotating_field oscillating_field"},
    Meaning{"rf_coil", "rotating_field oscillating_field"},
    Meaning{"rf_field", "rotating_field oscillating_field"},
    Meaning{"cavity", "rotating_field oscillating_field standing_wave"},
    Meaning{"resonator", "rotating_field oscillating_field"},
    Meaning{"microwave", "rotating_field oscillating_field"},
    Meaning{"flipper", "coil rotating_field oscillating_field"},
    Meaning{"spin_flipper", "coil rotating_field oscillating_field"},
    Meaning{"pi_coil", "coil"},
    Meaning{"loop", "current_loop"},
    Meaning{"helmholtz", "coil_pair"},
    Meaning{"helmholtz_coil", "coil_pair"},
    Meaning{"helmholtz_coils", "coil_pair"},
    Meaning{"wire", "straight_wire two_wire_magnet"},
    Meaning{"quadrupole", "multipole_magnet multipole_field"},
    Meaning{"sextupole", "multipole_magnet multipole_field"},
    Meaning{"hexapole", "multipole_magnet multipole_field"},
    Meaning{"octupole", "multipole_magnet multipole_field"},
    Meaning{"lens", "multipole_magnet"},
    Meaning{"magnet", "uniform_field gradient_magnet two_wire_magnet iron_magnet multipole_magnet"},
    Meaning{"deflector", "gradient_magnet two_wire_magnet iron_magnet"},
    Meaning{"deflecting_magnet", "gradient_magnet two_wire_magnet iron_magnet"},
    Meaning{"stern_gerlach", "gradient_magnet two_wire_magnet iron_magnet"},
    Meaning{"stern_gerlach_magnet", "gradient_magnet two_wire_magnet iron_magnet"},
    Meaning{"plates", "electric_field"},
    Meaning{"electrodes", "electric_field"},
    Meaning{"capacitor", "electric_field"},
    Meaning{"condenser", "electric_field"},
    Meaning{"e_field", "electric_field"},
    Meaning{"map", "field_map"},
    Meaning{"formula", "formula_field"},
    Meaning{"aperture", "slit collimator"},
    Meaning{"pinhole", "slit collimator"},
    Meaning{"hole", "slit collimator"},
    Meaning{"diaphragm", "slit collimator"},
    Meaning{"iris", "slit collimator"},
    Meaning{"tube", "collimator"},
    Meaning{"pipe", "collimator"},
    Meaning{"stop", "beam_stop"},
    Meaning{"beam_block", "beam_stop"},
    Meaning{"beam_dump", "beam_stop"},
    Meaning{"absorber", "beam_stop"},
    Meaning{"gas", "gas_cell"},
    Meaning{"cell", "gas_cell"},
    Meaning{"shutter", "chopper"},
    Meaning{"selector", "velocity_selector"},
    Meaning{"screen", "detector"},
    Meaning{"camera", "detector"},
    Meaning{"film", "detector"},
    Meaning{"counter", "detector monitor"},
    Meaning{"hot_wire", "detector"},
    Meaning{"qm", "quantum"},
    Meaning{"quantum_mechanics", "quantum"},
    Meaning{"semiclassical", "classical"},
    Meaning{"thermal", "effusive maxwell"},
    Meaning{"oven", "effusive"},
    Meaning{"nozzle", "supersonic"},
    Meaning{"jet", "supersonic"},
    Meaning{"maxwellian", "maxwell effusive"},
    Meaning{"maxwell_boltzmann", "maxwell effusive"},
    Meaning{"boltzmann", "maxwell effusive thermal"},
    Meaning{"monochromatic", "single"},
    Meaning{"fixed", "single"},
    Meaning{"constant", "single rectangular clamp"},
    Meaning{"delta", "single"},
    Meaning{"normal", "gaussian"},
    Meaning{"flat", "uniform box rectangular"},
    Meaning{"box", "uniform rectangular rectangle"},
    Meaning{"top_hat", "uniform box rectangular rectangle"},
    Meaning{"square", "rectangular rectangle"},
    Meaning{"spectrum", "tabulated"},
    Meaning{"table", "tabulated field_map"},
    Meaning{"lambert", "cosine"},
    Meaning{"lambertian", "cosine"},
    Meaning{"collimated", "parallel"},
    Meaning{"straight", "parallel"},
    Meaning{"divergent", "gaussian box cone"},
    Meaning{"sine", "half_sine"},
    Meaning{"sin", "half_sine sine"},
    Meaning{"rwa", "rotating_wave"},
    Meaning{"full", "none"},
    Meaning{"cw", "negative"},
    Meaning{"clockwise", "negative"},
    Meaning{"ccw", "positive"},
    Meaning{"counterclockwise", "positive"},
    Meaning{"same", "co"},
    Meaning{"opposite", "counter"},
    Meaning{"tof", "time_of_flight"},
    Meaning{"time", "time_of_flight start_time"},
    Meaning{"velocity", "speed"},
    Meaning{"lambda", "wavelength"},
    Meaning{"up", "polarised populations"},
    Meaning{"down", "polarised populations"},
    Meaning{"yes", "true"},
    Meaning{"on", "true"},
    Meaning{"no", "false"},
    Meaning{"off", "false"},
    Meaning{"geometric", "logarithmic"},
};

/// The same of keys.
constexpr std::array key_meanings{
    Meaning{"type", "kind"},
    Meaning{"id", "name"},
    Meaning{"position", "at"},
    Meaning{"pos", "at"},
    Meaning{"place", "at"},
    Meaning{"begin", "at from"},
    Meaning{"start", "at from"},
    Meaning{"from", "at"},
    Meaning{"y", "at"},
    Meaning{"z", "at"},
    Meaning{"distance", "at"},
    Meaning{"min", "from"},
    Meaning{"end", "length to"},
    Meaning{"stop", "length to"},
    Meaning{"to", "length"},
    Meaning{"max", "to"},
    Meaning{"steps", "points"},
    Meaning{"log", "spacing"},
    Meaning{"number", "points particles"},
    Meaning{"n", "points particles"},
    Meaning{"events", "particles"},
    Meaning{"atoms", "particles"},
    Meaning{"neutrons", "particles"},
    Meaning{"samples", "particles"},
    Meaning{"beamline", "parts"},
    Meaning{"elements", "parts"},
    Meaning{"components", "parts"},
    Meaning{"particle", "species"},
    Meaning{"atom", "species"},
    Meaning{"beam", "source"},
    Meaning{"description", "title"},
    Meaning{"b", "field"},
    Meaning{"b0", "field"},
    Meaning{"b1", "amplitude"},
    Meaning{"magnetic_field", "field"},
    Meaning{"strength", "field amplitude"},
    Meaning{"f", "frequency"},
    Meaning{"nu", "frequency"},
    Meaning{"axis", "direction"},
    Meaning{"diameter", "radius"},
    Meaning{"aperture", "opening radius"},
    Meaning{"length", "winding"},
    Meaning{"slit", "opening"},
    Meaning{"velocity", "speed"},
    Meaning{"v", "speed value mean"},
    Meaning{"speed", "value mean"},
    Meaning{"wavelength", "value mean"},
    Meaning{"lambda", "value mean"},
    Meaning{"energy", "value mean"},
    Meaning{"t", "temperature"},
    Meaning{"spread", "sigma"},
    Meaning{"std", "sigma"},
    Meaning{"width", "sigma"},
    Meaning{"divergence", "direction"},
    Meaning{"polarisation", "spin degree"},
    Meaning{"polarization", "spin degree"},
    Meaning{"gamma", "gyromagnetic_ratio"},
    Meaning{"pixels", "bins"},
    Meaning{"omega", "frequency"},
    Meaning{"angular_frequency", "frequency"},
    Meaning{"fwhm", "sigma"},
    Meaning{"hwhm", "sigma"},
    Meaning{"step", "points"},
};

/// What such a key is of the quantity that was named.
constexpr std::array conversions{
    Meaning{"diameter", "It is half of the diameter"},
    Meaning{"omega", "It is the angular frequency over 2 pi"},
    Meaning{"angular_frequency", "It is the angular frequency over 2 pi"},
    Meaning{"fwhm", "It is the full width at half maximum over 2.355"},
    Meaning{"hwhm", "It is the half width at half maximum over 1.177"},
    Meaning{"wavelength", "Its unit says that it is a wavelength"},
    Meaning{"lambda", "Its unit says that it is a wavelength"},
    Meaning{"energy", "Its unit says that it is an energy"},
    Meaning{"step", "It is (to - from)/step + 1"},
};

/// What is no key anywhere.
constexpr std::array no_keys{
    Meaning{"larmor_frequency", "it follows from the field and the species: `rabiline check` tells it"},
    Meaning{"resonance", "it follows from the field and the species: `rabiline check` tells it"},
    Meaning{"resonance_frequency", "it follows from the field and the species: `rabiline check` tells it"},
    Meaning{"rabi_frequency", "it follows from the `amplitude` and the species: `rabiline check` tells it"},
    Meaning{"tip_angle", "it follows from `amplitude`, `length` and speed: `rabiline check` tells it"},
    Meaning{"flip_angle", "it follows from `amplitude`, `length` and speed: `rabiline check` tells it"},
    Meaning{"pulse_area", "it follows from `amplitude`, `length` and speed: `rabiline check` tells it"},
    Meaning{"detected", "it is a result: `rabiline run` counts it"},
    Meaning{"counts", "it is a result: `rabiline run` counts it"},
    Meaning{"transmission", "it is a result: `rabiline run` counts it"},
    Meaning{"populations", "they are a result: a tally with the axis `level` counts them"},
    Meaning{"output", "the command line names the result: `rabiline run FILE -o out.h5`"},
    Meaning{"threads", "the command line says how many: `rabiline run FILE --threads 2`"},
};

/// What is said of the beam and is no part of it, and where it belongs.
constexpr std::array no_parts{
    Meaning{"oven", "where particles start is not a part: it stands in `source`, beside `parts`"},
    Meaning{"nozzle", "where particles start is not a part: it stands in `source`, beside `parts`"},
    Meaning{"source", "where particles start is not a part: it stands in `source`, beside `parts`"},
    Meaning{"gravity", "it is not a part: `gravity` stands beside `parts`"},
    Meaning{"chamber", "it is not a part: `chamber` stands beside `parts`"},
    Meaning{"drift", "a free flight is not a part: leave room before the `at` of the next one"},
    Meaning{"free_flight", "a free flight is not a part: leave room before the `at` of the next one"},
};
constexpr std::string_view of_parts = "detector";  // a word that only kinds of parts have

bool has(std::span<const Word> words, std::string_view word) {
  return std::ranges::find(words, word, &Word::word) != words.end();
}

/// Those that are meant and that `is_known` knows.
std::vector<std::string> meant_by(std::string_view said, std::span<const Meaning> table,
                                  const auto& is_known) {
  std::vector<std::string> out;
  const auto found = std::ranges::find(table, said, &Meaning::said);
  if (found == table.end()) return out;
  for (std::string_view rest = found->meant; !rest.empty();) {
    const std::string_view word = rest.substr(0, rest.find(' '));
    if (is_known(word)) out.emplace_back(word);
    rest.remove_prefix(std::min(rest.size(), word.size() + 1));
  }
  return out;
}

std::string_view told_of(std::string_view said, std::span<const Meaning> table) {
  const auto found = std::ranges::find(table, said, &Meaning::said);
  return found == table.end() ? std::string_view{} : found->meant;
}

}  // namespace

std::string list_of(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i)
    out += fmt::format("{}`{}`", i == 0 ? "" : i + 1 == words.size() ? " or " : ", ", words[i]);
  return out;
}

std::string list_of(std::span<const Word> words) {
  std::vector<std::string> all;
  for (const Word& word : words) all.emplace_back(word.word);
  return list_of(all);
}

std::string suggest(std::string_view word, std::span<const Word> words) {
  std::string said = lower(word);
  std::ranges::replace_if(
      said, [](char c) { return c == ' ' || c == '-'; }, '_');
  if (has(words, said)) return fmt::format("did you mean `{}`?", said);
  const auto is_word = [&](std::string_view meant) { return has(words, meant); };
  if (const std::vector<std::string> meant = meant_by(said, meanings, is_word); !meant.empty())
    return fmt::format("did you mean {}?", list_of(meant));
  const std::string_view elsewhere = told_of(said, no_parts);
  if (has(words, of_parts) && !elsewhere.empty()) return std::string(elsewhere);
  std::vector<std::string> known;
  for (const Word& w : words) known.emplace_back(w.word);
  const std::string near = closest(word, known);
  return near.empty() ? std::string{} : fmt::format("did you mean `{}`?", near);
}

std::string_view conversion_of(std::string_view said) { return told_of(lower(said), conversions); }

std::string_view origin_of(std::string_view said) { return told_of(lower(said), no_keys); }

std::string key_meant_by(std::string_view said, std::span<const std::string_view> keys) {
  const auto is_key = [&](std::string_view meant) { return std::ranges::find(keys, meant) != keys.end(); };
  const std::vector<std::string> meant = meant_by(lower(said), key_meanings, is_key);
  return meant.empty() ? std::string{} : meant.front();
}

}  // namespace rabiline
