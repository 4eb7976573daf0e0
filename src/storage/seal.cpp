#include "storage/seal.hpp"

#include <fmt/format.h>
#include <openssl/evp.h>

#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <memory>
#include <string_view>
#include <vector>

namespace rabiline {
namespace {

using Path = std::filesystem::path;

constexpr std::string_view seal_begin = "\nrabiline: SHA-256 of all before this line: ";
constexpr std::size_t digits = 64, seal_size = seal_begin.size() + digits + 1;

class Sha256 {
 public:
  Sha256() : context_(EVP_MD_CTX_new(), &EVP_MD_CTX_free) {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) throw std::bad_alloc();
  }
  void add(std::span<const std::byte> bytes) { EVP_DigestUpdate(context_.get(), bytes.data(), bytes.size()); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> bytes{};
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), bytes.data(), &size);
    std::string out;
    for (unsigned i = 0; i < size; ++i) out += fmt::format("{:02x}", bytes[i]);
    return out;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

[[noreturn]] void reject(const Path& path, std::string_view why) {
  throw StorageError(fmt::format("{}: cannot be read ({})", path.string(), why));
}

/// The next bytes of a file, block by block.
void add(std::istream& file, std::uintmax_t size, const Path& path, Sha256& digest) {
  std::vector<char> block(1 << 20);
  for (std::uintmax_t left = size; left > 0;) {
    const auto step = static_cast<std::streamsize>(std::min<std::uintmax_t>(left, block.size()));
    if (!file.read(block.data(), step)) reject(path, "it ends early");
    digest.add(std::as_bytes(std::span(block).first(static_cast<std::size_t>(step))));
    left -= static_cast<std::uintmax_t>(step);
  }
}

std::string seal_with(Sha256& digest) { return fmt::format("{}{}\n", seal_begin, digest.hex()); }

}  // namespace

std::string seal_of(std::span<const std::byte> content) {
  Sha256 digest;
  digest.add(content);
  return seal_with(digest);
}

std::string seal_of(const Path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) reject(path, std::strerror(errno));
  Sha256 digest;
  add(file, std::filesystem::file_size(path), path, digest);
  return seal_with(digest);
}

std::string require_seal(const Path& path) {
  std::error_code error;
  if (!std::filesystem::exists(path, error)) reject(path, "there is no such file");
  if (!std::filesystem::is_regular_file(path, error)) reject(path, "it is not a regular file");
  std::ifstream file(path, std::ios::binary);
  if (!file) reject(path, std::strerror(errno));
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  constexpr std::string_view hdf5 = "\x89HDF\r\n\x1a\n";
  std::string begin(hdf5.size(), '\0');
  if (file.read(begin.data(), static_cast<std::streamsize>(begin.size())) && begin != hdf5)
    reject(path, "it is no HDF5 file, such as `rabiline run` writes");
  file.clear();
  file.seekg(0);
  Sha256 digest;
  add(file, size < seal_size ? 0 : size - seal_size, path, digest);
  std::string seal(std::min<std::uintmax_t>(size, seal_size), '\0');
  if (!file.read(seal.data(), static_cast<std::streamsize>(seal.size())) && !seal.empty())
    reject(path, "it ends early");
  if (!seal.starts_with(seal_begin))
    reject(path,
           "no seal of rabiline is at its end: it was cut short, or changed, or written by another program");
  std::string hex = digest.hex();
  if (seal != fmt::format("{}{}\n", seal_begin, hex))
    reject(path, "it is damaged, or was changed since rabiline wrote it");
  return hex;
}

}  // namespace rabiline
