#include "input/text_file.hpp"

#include <fcntl.h>
#include <poll.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

#include "input/document.hpp"

namespace rabiline {

TextFile read_text_file(const std::filesystem::path& path) {
  constexpr int patience = 5000;  // [ms]
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (status.type() == std::filesystem::file_type::none)  // a folder that nobody may look into, a long name
    return {"", "the file cannot be opened: " + error.message(), ""};
  if (!std::filesystem::exists(status)) return {"", "there is no such file", ""};
  if (std::filesystem::is_directory(status))
    return {"", "this is a folder, not a file", "name the file in it"};
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
