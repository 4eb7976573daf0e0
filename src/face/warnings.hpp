#pragma once
// What deserves a word before a flight and after it.
#include <string>
#include <vector>

#include "plan/plan.hpp"
#include "scan/experiment.hpp"
#include "simulation/result.hpp"

namespace rabiline {

std::vector<Diagnostic> located(const std::vector<Fault>&, const Places&);

/// Of the texts, and of what they say.
std::vector<Diagnostic> warnings_before(const LoadedExperiment&, const Experiment&, const Plan&);

std::string text_of(const Diagnostic& warning);

/// Fractions of nothing are no numbers.
void require_emission(const Result&);

/// All particles may have been too few.
void warn_unless_precise(const Beamline&, const Result&, Provenance&);

}  // namespace rabiline
