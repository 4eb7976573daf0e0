#include "input/text_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include "core/diagnostics.hpp"

#include "input/document.hpp"

namespace rabiline {

namespace {

/// Help with the file of its kind beside it whose name is nearest; empty where none is near.
std::string name_of_near_file(const std::filesystem::path& path) {
  constexpr int most = 1000;
  const auto kind = [](const std::filesystem::path& file) {
    const std::string ending = file.extension().string();
    return ending.empty() || ending == ".yml" ? ".yaml" : ending;
  };
  std::vector<std::string> known;
  std::error_code error;
  const std::filesystem::path folder = path.has_parent_path() ? path.parent_path() : ".";
  for (std::filesystem::directory_iterator file(folder, error), end;
       !error && file != end && known.size() < most; file.increment(error))
    if (kind(file->path()) == kind(path)) known.push_back(file->path().filename().string());
  std::ranges::sort(known);
  const std::string found = closest(path.filename().string(), known);
  return found.empty() ? found : fmt::format("did you mean `{}`?", (path.parent_path() / found).string());
}

}  // namespace

std::optional<FileProblem> problem_of(const std::filesystem::path& path, bool on_a_disk) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none)  // a folder that nobody may look into, a long name
    return FileProblem{"the file cannot be opened: " + error.message(), ""};
  if (!std::filesystem::exists(status)) return FileProblem{"there is no such file", name_of_near_file(path)};
  if (std::filesystem::is_directory(status))
    return FileProblem{"this is a folder, not a file", "name the file in it"};
  if (on_a_disk && !std::filesystem::is_regular_file(status))
    return FileProblem{"this is a pipe or a device, not a file on a disk", "write it to a file"};
  return std::nullopt;
}

TextFile read_text_file(const std::filesystem::path& path) {
  constexpr int patience = 5000;  // [ms]
  if (const auto problem = problem_of(path)) return {"", problem->what, problem->help};
  const int file = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return {"", std::string("the file cannot be opened: ") + std::strerror(errno), ""};
  // One byte more than allowed, so that a longer file shows; never more, since a device has no end.
  TextFile out;
  out.text.resize(max_text_bytes + 1);
  std::size_t size = 0;
  while (size < out.text.size() && out.problem.empty()) {
    pollfd waiting{file, POLLIN, 0};
    const int ready = ::poll(&waiting, 1, patience);
    const ssize_t got = ready > 0 ? ::read(file, out.text.data() + size, out.text.size() - size) : -1;
    if (got > 0) size += static_cast<std::size_t>(got);
    if (got == 0) break;
    if (ready == 0)
      out = {"", "it is a pipe or a device from which nothing came for 5 s", "write the text to a file"};
    else if (got < 0 && errno != EINTR && errno != EAGAIN)
      out = {"", "the file cannot be read", ""};
  }
  ::close(file);
  if (out.problem.empty()) out.text.resize(size);
  return out;
}

}  // namespace rabiline
