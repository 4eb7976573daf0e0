#include "face/warnings.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <stdexcept>

#include <fmt/format.h>

#include "input/beamline_reader.hpp"
#include "rules/warnings.hpp"
#include "simulation/precision.hpp"

namespace rabiline {
namespace {

/// A file that was cut short may still be read, as a different experiment.
std::vector<Diagnostic> warnings_of_texts(const std::vector<InputText>& inputs) {
  std::vector<Diagnostic> out;
  for (const InputText& input : inputs) {
    if (input.text.empty() || input.text.back() == '\n') continue;
    const auto source = make_source_text(input.path, input.text);
    const int lines = static_cast<int>(source->lines.size());
    out.push_back({{source, lines, static_cast<int>(source->lines.back().size()) + 1, 1},
                   "the last line has no end: is the file whole?",
                   "end the file with a newline",
                   Severity::warning});
  }
  return out;
}

}  // namespace

std::vector<Diagnostic> located(const std::vector<Fault>& faults, const Places& places) {
  std::vector<Diagnostic> out;
  out.reserve(faults.size());
  for (const Fault& fault : faults) out.push_back(places.locate(fault));
  return out;
}

std::vector<Diagnostic> warnings_before(const LoadedExperiment& loaded, const Experiment& experiment,
                                        const Plan& plan) {
  std::vector<Diagnostic> out = warnings_of_texts(loaded.inputs);
  std::ranges::copy(loaded.unused, std::back_inserter(out));
  std::ranges::move(located(warnings_of(experiment, plan), loaded.places), std::back_inserter(out));
  return out;
}

void require_emission(const Result& result) {
  for (std::size_t point = 0; point < result.emitted.size(); ++point)
    if (!(result.emitted[point] > 0))
      throw std::invalid_argument(fmt::format(
          "none of the {} particles has a weight at scan point {}: hardly any direction that the source "
          "draws leads along "
          "the beam\n  help: move what the source is aimed at away from it, or choose another `direction`",
          result.particles, point));
}

std::string text_of(const Diagnostic& warning) {
  return warning.suggestion.empty() ? warning.message
                                    : fmt::format("{}\n  help: {}", warning.message, warning.suggestion);
}

void warn_unless_precise(const Beamline& beamline, const Result& result, Provenance& provenance) {
  const Until& wanted = *beamline.until;
  const Reached reached = reached_by(result, wanted);
  const double over = reached.over(wanted);
  if (over <= 1) return;
  std::string missed;
  if (wanted.detected_error && reached.detected_error > *wanted.detected_error)
    missed = fmt::format("the largest error of `detected` is {:.2g}, not {:.2g}", reached.detected_error,
                         *wanted.detected_error);
  if (wanted.centre_error && reached.centre_error > wanted.centre_error->value) {
    const auto told = [&](double error) { return pretty_quantity(error, wanted.centre_error->dimension); };
    missed += missed.empty() ? "" : ", and ";
    missed += std::isfinite(over) ? fmt::format("the error of the line's centre is {}, not {}",
                                                told(reached.centre_error), told(wanted.centre_error->value))
                                  : "there is no line in `detected` that chance could not have made";
  }
  const double needed = static_cast<double>(beamline.particles) * over * over;
  const std::string help = !std::isfinite(over) ? "scan where `detected` changes, or omit `centre_error`"
                           : particle_numbers.contains(std::ceil(needed))
                               ? fmt::format("`particles` of {:.2g} may be enough", needed)
                               : fmt::format(
                                     "that cannot be reached: it needs {:.2g} particles, and {:g} are the "
                                     "most; let `until` ask for less",
                                     needed, particle_numbers.high);
  provenance.warnings.push_back(
      fmt::format("all {} particles have flown, and {}{}\n  help: {}", beamline.particles, missed,
                  std::isfinite(over) ? " as `until` wants" : ", though `until` asks for its centre", help));
}

}  // namespace rabiline
