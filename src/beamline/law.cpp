#include "beamline/law.hpp"

#include <fmt/format.h>

namespace rabiline {
namespace {

std::string_view word_of(Closure closure) {
  for (const Choice<Closure>& choice : choices<Closure>)
    if (choice.value == closure) return choice.word;
  return {};
}

}  // namespace

LawTraits law_traits(const Law& law) {
  struct Of {
    LawTraits operator()(const QuantumLaw& quantum) const {
      const Outcomes outcomes = quantum.outcomes;
      return {.tolerance = quantum.tolerance,
              .has_levels = true,
              .splits = outcomes == Outcomes::split || outcomes == Outcomes::coherent,
              .stays_coherent = outcomes == Outcomes::coherent || outcomes == Outcomes::coherent_drawn};
    }
    LawTraits operator()(const ClassicalLaw& classical) const { return {.tolerance = classical.tolerance}; }
    LawTraits operator()(const DoradoLaw& dorado) const {
      return {.tolerance = dorado.path_error,
              .has_forces = false,
              .kappa = dorado.kappa,
              .closure = dorado.closure};
    }
  };
  return std::visit(Of{}, law);
}

Law without_splitting(Law law) {
  if (auto* quantum = std::get_if<QuantumLaw>(&law)) {
    if (quantum->outcomes == Outcomes::split) quantum->outcomes = Outcomes::sample;
    if (quantum->outcomes == Outcomes::coherent) quantum->outcomes = Outcomes::coherent_drawn;
  }
  return law;
}

std::string describe(const Law& law) {
  if (const auto* dorado = std::get_if<DoradoLaw>(&law))
    return fmt::format("{} ({}, kappa = {})", DoradoLaw::kind, word_of(dorado->closure), dorado->kappa);
  const auto* quantum = std::get_if<QuantumLaw>(&law);
  if (quantum != nullptr && quantum->outcomes == Outcomes::sample)
    return fmt::format("{} (sample)", QuantumLaw::kind);
  return std::string(std::visit([](const auto& any) { return any.kind; }, law));
}

}  // namespace rabiline
