#pragma once
// Files with the geometry they include, as one tree.
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "input/document.hpp"

namespace rabiline {

/// A file's tree, with the parts (and chamber) of its `geometry` put before its own.
struct LoadedFile {
  Node root;
  std::vector<InputText> inputs;                           // the file itself first
  std::vector<std::shared_ptr<const SourceText>> sources;  // the same files, for messages
  std::string folder;                                      // where paths in the file begin
  /// Texts that stand for the files; null where the files themselves are read.
  std::shared_ptr<const std::vector<InputText>> stored{};
};

/// Reads a file and what it includes. Throws InputError.
LoadedFile load_file(const std::filesystem::path&);
/// The same of a text, which messages call `text`; paths in it begin in `folder`.
LoadedFile file_of_text(const std::string& text, const std::filesystem::path& folder);
/// The same of texts that were stored, the experiment's own first; no file is read.
LoadedFile file_of_stored(std::vector<InputText>);

/// The text that stands for a file; nothing where there is none.
std::optional<std::string> stored_text(const std::vector<InputText>&, const std::string& path);

}  // namespace rabiline
