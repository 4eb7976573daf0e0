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

std::string describe(const Law& law) {
  if (const auto* dorado = std::get_if<DoradoLaw>(&law))
    return fmt::format("{} ({}, kappa = {})", DoradoLaw::kind, word_of(dorado->closure), dorado->kappa);
  const auto* quantum = std::get_if<QuantumLaw>(&law);
  if (quantum != nullptr && quantum->outcomes == Outcomes::sample)
    return fmt::format("{} (sample)", QuantumLaw::kind);
  return std::string(std::visit([](const auto& any) { return any.kind; }, law));
}

}  // namespace rabiline
