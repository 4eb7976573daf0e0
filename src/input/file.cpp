#include "input/file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <system_error>
#include <utility>

#include "input/text_file.hpp"
#include "storage/storage_error.hpp"

namespace rabiline {
namespace {

namespace fs = std::filesystem;
constexpr std::size_t max_files = 16;

/// Whom to blame where a file cannot be read: the line that names it, or the file itself.
[[noreturn]] void refuse(const Place& named_at, const fs::path& path, std::string message,
                         std::string help = {}) {
  if (named_at.text)
    throw InputError({{named_at, fmt::format("`{}`: {}", path.string(), message), std::move(help)}});
  throw StorageError(
      fmt::format("{}: {}{}{}", path.string(), message, help.empty() ? "" : "\n  help: ", help));
}

std::string read_text(const fs::path& path, const Place& named_at) {
  TextFile file = read_text_file(path);
  if (!file.problem.empty()) refuse(named_at, path, file.problem, file.help);
  return std::move(file.text);
}

class Loader {
 public:
  explicit Loader(LoadedFile& out) : out_(out) {}

  Node load(const fs::path& path, const Place& named_at) {
    if (out_.inputs.size() >= max_files)
      refuse(named_at, path, fmt::format("more than {} files are included", max_files));
    return parse(path, path.string(), text_at(path, named_at));
  }

  /// A text that stands at `path`, or would.
  Node parse(const fs::path& path, const std::string& name, std::string text) {
    if (text.starts_with("\xef\xbb\xbf")) text.erase(0, 3);
    const auto source = make_source_text(name, text);
    out_.inputs.push_back({name, text});
    out_.sources.push_back(source);
    if (text.find('\r') != text.npos && text.find('\n') == text.npos)
      throw InputError({{Place{source, 0, 0, 1},
                         "its lines end with carriage returns alone, so that all of it is one line",
                         "save it with line feeds"}});
    Node root = parse_document(source, text);
    if (root.is_null())
      throw InputError(
          {{Place{source, 0, 0, 1}, "the file is empty",
            "`rabiline new ramsey` writes a file to start from, and `rabiline new --help` names others"}});
    include_geometry(root, path);
    return root;
  }

 private:
  std::string text_at(const fs::path& path, const Place& named_at) const {
    if (!out_.stored) return read_text(path, named_at);
    const auto text = stored_text(*out_.stored, path.string());
    if (!text) refuse(named_at, path, "this file was not read when the experiment was flown");
    return *text;
  }
  /// Puts the included parts before the file's own, and takes the chamber over.
  void include_geometry(Node& root, const fs::path& path) {
    Entry* geometry = root.find("geometry");
    if (!geometry) return;
    const Node named = geometry->value;
    if (!named.is_scalar() || named.scalar.empty())
      throw InputError({{named.place, "`geometry` is the path of a file with shared parts",
                         "write `geometry: bench.yaml`"}});
    const fs::path target = (path.parent_path() / named.scalar).lexically_normal();
    std::error_code error;
    const fs::path real = fs::weakly_canonical(target, error);
    const fs::path own = fs::weakly_canonical(path, error);
    open_.push_back(own);
    if (std::find(open_.begin(), open_.end(), real) != open_.end())
      throw InputError({{named.place, fmt::format("`{}` includes itself", named.scalar),
                         "a geometry file holds shared parts and is included by experiments"}});
    Node shared = load(target, named.place);
    open_.pop_back();
    check_geometry(shared);
    merge(root, std::move(shared));
  }

  /// A geometry file says where things stand, nothing about what flies.
  static void check_geometry(const Node& shared) {
    static constexpr std::string_view known[] = {"rabiline", "title", "geometry", "parts", "chamber"};
    std::vector<Diagnostic> errors;
    for (const Entry& entry : shared.entries)
      if (std::find(std::begin(known), std::end(known), entry.key) == std::end(known))
        errors.push_back(
            {entry.key_place,
             fmt::format("`{}` has no place in a geometry file, which holds `parts` and `chamber`",
                         entry.key),
             "move it to the experiment's file"});
    if (!shared.is_mapping() || !shared.find("parts"))
      errors.push_back({shared.place, "a geometry file needs a list of `parts`", {}});
    else if (!shared.find("parts")->value.is_sequence())
      errors.push_back(
          {shared.find("parts")->value.place, "`parts` is a list of parts", "begin each part with `- `"});
    const Entry* version = shared.find("rabiline");
    if (shared.is_mapping() && !version)
      errors.push_back(
          {shared.place, "a geometry file needs the version of its format", "begin it with `rabiline: 1`"});
    else if (version && to_text(version->value) != "1")
      errors.push_back(
          {version->value.place,
           fmt::format("this program reads version 1 of the format, not {}", to_text(version->value)),
           {}});
    if (!errors.empty()) throw InputError(std::move(errors));
  }

  static void merge(Node& root, Node shared) {
    Node& parts = shared.find("parts")->value;
    if (Entry* own = root.find("parts"); !own)
      root.entries.push_back(*shared.find("parts"));
    else if (own->value.is_sequence())
      own->value.items.insert(own->value.items.begin(), parts.items.begin(), parts.items.end());
    const Entry* chamber = shared.find("chamber");
    if (!chamber) return;
    if (const Entry* own = root.find("chamber"))
      throw InputError({{own->key_place,
                         fmt::format("the geometry gives a `chamber` already, in {}:{}",
                                     chamber->key_place.text->name, chamber->key_place.line),
                         "keep one of them"}});
    root.entries.push_back(*chamber);
  }

  LoadedFile& out_;
  std::vector<fs::path> open_;  // the files that are being included
};

}  // namespace

LoadedFile load_file(const fs::path& path) {
  LoadedFile out;
  out.folder = path.parent_path().string();
  out.root = Loader(out).load(path, {});
  return out;
}

LoadedFile file_of_text(const std::string& text, const fs::path& folder) {
  LoadedFile out;
  out.folder = folder.string();
  out.root = Loader(out).parse(folder / "text", "text", text);
  return out;
}

LoadedFile file_of_stored(std::vector<InputText> texts) {
  LoadedFile out;
  const fs::path path = texts.at(0).path;
  out.folder = path.parent_path().string();
  out.stored = std::make_shared<const std::vector<InputText>>(std::move(texts));
  out.root = Loader(out).load(path, {});
  return out;
}

std::optional<std::string> stored_text(const std::vector<InputText>& texts, const std::string& path) {
  for (const InputText& text : texts)
    if (text.path == path) return text.text;
  return {};
}

}  // namespace rabiline
