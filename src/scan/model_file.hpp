#pragma once
// A file with the key `model` is no beamline: it describes a small model that is solved, not flown.
#include <string>
#include <variant>
#include <vector>

#include "models/model.hpp"
#include "scan/experiment.hpp"

namespace rabiline {

/// A model's file at one point of its scan.
struct ModelFile {
  std::string title;
  Model model;
};
template <>
inline constexpr auto parameters<ModelFile> = std::tuple{
    param("title", &ModelFile::title, "one line for plots and logs", std::string_view("untitled")),
    param("model", &ModelFile::model, "the system that is solved"),
};

struct LoadedModel {
  std::vector<ScanAxis> axes;     // none or one
  std::vector<ModelFile> points;  // one where nothing is scanned
  std::vector<InputText> inputs;  // the file, for provenance
};

using Loaded = std::variant<LoadedExperiment, LoadedModel>;

/// Reads a beamline or a model, with its changes. Throws InputError with everything that is wrong.
Loaded load_any(LoadedFile, const Changes&);

}  // namespace rabiline
