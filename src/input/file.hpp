#pragma once
// Files with the geometry they include, as one tree.
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "input/document.hpp"
#include "simulation/result.hpp"

namespace rabiline {

/// A file's tree, with the parts (and chamber) of its `geometry` put before its own.
struct LoadedFile {
  Node root;
  std::vector<InputText> inputs;                           // the file itself first
  std::vector<std::shared_ptr<const SourceText>> sources;  // the same files, for messages
};

/// Reads a file and what it includes. Throws InputError.
LoadedFile load_file(const std::filesystem::path&);

}  // namespace rabiline
