#pragma once
// What solving a model hands to storage.
#include <optional>
#include <string>
#include <vector>

#include "models/motion.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// A model solved at each point of its scan; one point where nothing is scanned.
struct SolvedModel {
  std::string title, kind;
  std::optional<ScanAxis> axis{};
  std::vector<ModelResult> points{};
  std::vector<ResolvedParameter> parameters{};
  Provenance provenance{};
};

}  // namespace rabiline
